"""Section `improve` of bench/run: `laves improve` on meshes that TetGen and Gmsh make of models.

Each mesher fills the models with about 50 thousand tets: TetGen refines the surface's triangles as well, Gmsh keeps them. Both meshes are
improved by laves, with all defaults on one thread, and by Netgen's volume optimiser where that is there. Mmg3d is not in Debian:
its figures are those of the issue that asked for this comparison.
"""

import json
import math
import os
import re
import shutil
import tempfile

from common import Run, figure, table
from peers import Gmsh, Netgen, make_subject, read_off, write_msh

HERE = os.path.dirname(os.path.abspath(__file__))
MODELS = ["bunny.obj", "spot.obj", "fandisk.obj"]
TETS, WITHIN, TURNS = 50000, 0.1, 6
# Mmg3d -optim on such meshes: worst dihedral angles, degrees, and tets per CPU second.
MMG_WINDOW, MMG_RATE = (20, 146), 28e3
AIM = (30, 140)


class TetGenMaker:
    name = "TetGen"

    def missing(self):
        return None if shutil.which("tetgen") else "package tetgen"

    def make(self, folder, size):
        """The mesh's path."""
        Run(["tetgen", f"-pq2a{size ** 3 / (6 * math.sqrt(2)):.6e}Q", "surface.off"], folder)
        return os.path.join(folder, "surface.1.ele")


class GmshMaker:
    name = "Gmsh"

    def missing(self):
        return None if shutil.which("gmsh") else "package gmsh"

    def make(self, folder, size):
        write_msh(*read_off(os.path.join(folder, "surface.off")), os.path.join(folder, "surface.msh"))
        with open(os.path.join(folder, "surface.geo"), "w") as file:
            file.write(Gmsh.SCRIPT % size)
        Run(["gmsh", "-3", "surface.geo", "-o", "gmsh.msh", "-format", "msh41", "-bin", "-nt", "1", "-v", "1"], folder)
        return os.path.join(folder, "gmsh.msh")


def check(bench, mesh):
    run = Run([bench.program, "check", mesh, "-q", "--json", "-"])
    return json.loads(run.out) if run.code in (0, 3) and run.out else None


def make_mesh(bench, maker, folder, volume):
    """A mesh of about so many tets, and what is known of it."""
    size, best = (volume * 6 * math.sqrt(2) / TETS) ** (1 / 3), None
    for _ in range(TURNS):
        mesh = maker.make(folder, size)
        facts = check(bench, mesh) if os.path.exists(mesh) else None
        if not facts:
            break
        off = math.log(facts["tets"] / TETS)
        if best is None or abs(off) < best[0]:
            best = (abs(off), size)
        if abs(off) < WITHIN:
            break
        size *= math.exp(min(max(off / 2, -1), 1))
    if best is None:
        return None
    return maker.make(folder, best[1])


def triangle_angles(bench, mesh, folder):
    """The smallest and the largest angle of the boundary's triangles."""
    path = os.path.join(folder, "skin.off")
    Run([bench.program, "improve", mesh, "--window", "0,180", "-o", os.path.join(folder, "same.vtu"), "--boundary", path,
         "--certificate", "none", "-q"])
    points, faces = read_off(path)
    points = [[float(x) for x in p] for p in points]
    least, most = 180, 0
    for f in faces:
        for k in range(3):
            a, b, c = (points[int(f[(k + i) % 3])] for i in range(3))
            u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
            cosine = sum(x * y for x, y in zip(u, v)) / math.sqrt(sum(x * x for x in u) * sum(x * x for x in v))
            angle = math.degrees(math.acos(max(-1, min(1, cosine))))
            least, most = min(least, angle), max(most, angle)
    return least, most


def improve(bench, mesh, folder):
    """The facts of `laves improve`: the best of three times."""
    best = None
    for _ in range(1 if bench.options.quick else 3):
        path = os.path.join(folder, "improved.json")
        Run([bench.program, "improve", mesh, "-o", os.path.join(folder, "improved.vtu"), "--certificate", "none", "--threads", "1",
             "-q", "--json", path])
        with open(path) as file:
            facts = json.load(file)
        if best is None or facts["cpu_seconds"]["improve"] < best["cpu_seconds"]["improve"]:
            best = facts
    return best


def improve_by_netgen(bench, netgen, mesh, folder):
    """CPU seconds and facts, or None."""
    medit, out = os.path.join(folder, "input.mesh"), os.path.join(folder, "netgen.msh")
    # Nothing is outside this window, so the mesh is written as it is.
    Run([bench.program, "improve", mesh, "--window", "0,180", "-o", medit, "--certificate", "none", "-q"])
    run = Run([netgen.python, os.path.join(HERE, "peers", "netgen_improve.py"), medit, out], timeout=300)
    found = re.search(r"^([\d.e-]+)\s*$", run.out, re.M)
    return (float(found[1]), check(bench, out)) if run.code == 0 and found else None


def measure_improve(bench):
    rows, notes = [], []
    netgen = Netgen()
    missing = netgen.missing(bench)
    if missing:
        notes.append(f"Netgen is left out: {missing}")
    for name in MODELS[:1] if bench.options.quick else MODELS:
        for maker in (TetGenMaker(), GmshMaker()):
            if maker.missing():
                notes.append(f"{maker.name} is left out: {maker.missing()}")
                continue
            with tempfile.TemporaryDirectory() as folder:
                path = make_subject(bench, folder, name)
                if not path:
                    bench.say(f"  {name}: not there, left out")
                    continue
                os.rename(path, os.path.join(folder, "surface.off"))
                volume = json.loads(Run([bench.program, "info", os.path.join(folder, "surface.off"), "-q", "--json", "-"]).out)
                volume = volume["input"]["volume"]
                mesh = make_mesh(bench, maker, folder, volume)
                if not mesh:
                    bench.say(f"  {name}: {maker.name} made no mesh")
                    continue
                rows.append(row_of(bench, name, maker, mesh, folder, None if missing else netgen))
                bench.say(f"  {name} by {maker.name}: {rows[-1]['min_before']:.1f} .. {rows[-1]['max_before']:.1f} -> "
                          f"{rows[-1]['min']:.1f} .. {rows[-1]['max']:.1f}, {rows[-1]['rate']:.0f} tets/s")
    bench.keep("improve", rows, figures_of(rows), notes)


def row_of(bench, name, maker, mesh, folder, netgen):
    facts = improve(bench, mesh, folder)
    before, cpu = facts["before"], facts["cpu_seconds"]["improve"]
    least, most = triangle_angles(bench, mesh, folder)
    row = {"model": name, "mesher": maker.name, "tets": before["tets"], "min_before": before["min_dihedral"],
           "max_before": before["max_dihedral"], "outside_before": before["outside_window"], "tets_after": facts["tets"],
           "min": facts["min_dihedral"], "max": facts["max_dihedral"], "outside": facts["outside_window"], "valid": facts["valid"],
           "cpu": cpu, "rate": before["tets"] / cpu, "volume_change": facts["volume"] / before["volume"] - 1,
           "sharpest": facts["boundary"]["sharpest"], "triangle_min": least, "triangle_max": most}
    other = improve_by_netgen(bench, netgen, mesh, folder) if netgen else None
    if other and other[1]:
        row.update(netgen_min=other[1]["min_dihedral"], netgen_max=other[1]["max_dihedral"], netgen_cpu=other[0],
                   netgen_valid=other[1]["valid"])
    return row


def figures_of(rows):
    if not rows:
        return []
    least, most, rate = min(r["min"] for r in rows), max(r["max"] for r in rows), min(r["rate"] for r in rows)
    change = max(abs(r["volume_change"]) for r in rows)
    return [figure("improved meshes: smallest dihedral angle", f"{least:.1f}", f"{MMG_WINDOW[0]}, as Mmg3d", least >= MMG_WINDOW[0]),
            figure("improved meshes: largest dihedral angle", f"{most:.1f}", f"{MMG_WINDOW[1]}, as Mmg3d", most <= MMG_WINDOW[1]),
            figure("improvement: tets per CPU second", f"{rate:.0f}", f"{MMG_RATE:.0f}, as Mmg3d", rate > MMG_RATE),
            figure("improvement: change of volume", f"{change:.1e}", "1e-12", change < 1e-12)]


def improve_tables(rows):
    def angles(row, low, high):
        return f"{row[low]:.1f} .. {row[high]:.1f}" if low in row else ""

    header = ["mesh", "tets", "angles before", "outside", "angles after", "outside", "CPU s", "tets/s", "Netgen's optimiser", "CPU s",
              "boundary triangles"]
    return table(header, [[f"{r['model']} by {r['mesher']}", f"{r['tets']}", angles(r, "min_before", "max_before"),
                           f"{r['outside_before']}", angles(r, "min", "max"), f"{r['outside']}", f"{r['cpu']:.2f}", f"{r['rate']:.0f}",
                           angles(r, "netgen_min", "netgen_max") + ("" if r.get("netgen_valid", True) else ", not valid"),
                           f"{r['netgen_cpu']:.1f}" if "netgen_cpu" in r else "", angles(r, "triangle_min", "triangle_max")]
                          for r in rows])
