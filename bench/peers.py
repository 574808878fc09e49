"""Section `peers` of bench/run: laves beside the tetrahedral meshers that Debian has, on the same solids with as many tetrahedra.

Peers are whole programs that are run, one thread each, and judged from their files by laves-judge like laves itself. TetGen, Gmsh
and Netgen fill a surface whose triangles they keep: they are given the boundary of the mesh that laves makes, triangles that fit
the wished size, and the time of making it is not theirs. CGAL makes a surface of its own, from the input, as laves does.
"""

import hashlib
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile

from common import STUFFER_RATE, Run, figure, last_sentence, mesh_facts, table

HERE = os.path.dirname(os.path.abspath(__file__))
CREASE_DEG = 40  # what laves takes for sharp by default
# Solids; the last one is made here, so that it is always there.
SUBJECTS = [("dragon.obj", None), ("hand_closed.obj", None), ("fandisk.obj", CREASE_DEG), ("bumps", None)]
QUICK_SUBJECTS = SUBJECTS[2:]
BUMPS_TRIANGLES = 100000
CURVE_TRIANGLES = 20000  # of the same shape for the plot, so that small meshes are not all about reading
TETS, QUICK_TETS = 500000, 50000
# Tets of the runs that the plot shows, on the bumps.
CURVE, QUICK_CURVE = (10000, 50000, 200000, 1000000), (10000, 20000, 50000)
LAVES_CURVE = (4000000, 10000000)  # further, laves alone
SHORT_RUNS, SHORT_SECONDS = 5, 2  # of the plot: runs, until they took so many CPU seconds together
MATCHED, QUICK_MATCHED = 0.05, 0.15  # how near the number of tets shall come
MATCH_RUNS, QUICK_MATCH_RUNS = 12, 6
MATCH_SECONDS = 300  # then the nearest so far has to do
TIMEOUT = 1800  # seconds for a run
# Tets per CPU second, laves over peer.
TARGETS = {"TetGen": 15, "Gmsh HXT": 40, "CGAL": 30, "CGAL, slivers removed": 200}
STUFFER_TARGET = 200


# ---- surfaces ----


def read_obj(path):
    """Points and faces of an OBJ file, as words; triangles only."""
    points, faces = [], []
    with open(path) as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                points.append(words[1:4])
            elif words[:1] == ["f"]:
                faces.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
    return points, faces


def read_off(path):
    with open(path) as file:
        words = file.read().split()
    count, faces, at = int(words[1]), int(words[2]), 4
    points = [words[at + 3 * i:at + 3 * i + 3] for i in range(count)]
    at += 3 * count
    return points, [[int(w) for w in words[at + 4 * i + 1:at + 4 * i + 4]] for i in range(faces)]


def write_off(points, faces, path):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        file.writelines(" ".join(p) + "\n" for p in points)
        file.writelines("3 {} {} {}\n".format(*f) for f in faces)


def write_msh(points, faces, path):
    """Gmsh's format 2.2, all triangles on surface 1."""
    with open(path, "w") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(points)}\n")
        file.writelines(f"{i} {' '.join(p)}\n" for i, p in enumerate(points, 1))
        file.write(f"$EndNodes\n$Elements\n{len(faces)}\n")
        file.writelines("{} 2 2 1 1 {} {} {}\n".format(i, *(v + 1 for v in f)) for i, f in enumerate(faces, 1))
        file.write("$EndElements\n")


def make_bumps(bench, path, triangles):
    return path if Run([bench.beside("laves-bumps"), str(triangles), path]).code == 0 else None


def make_subject(bench, folder, name):
    """The solid as an OFF file in the folder, or None when it is not there."""
    path = os.path.join(folder, os.path.splitext(name)[0] + ".off")
    if name == "bumps":
        return make_bumps(bench, path, BUMPS_TRIANGLES)
    source = bench.model(name)
    if source:
        write_off(*read_obj(source), path)
    return path if source else None


# ---- peers ----


class Peer:
    """A mesher that is run. Keeps: whether it keeps the triangles of its surface."""

    name, keeps, output = "", True, ""

    def missing(self, bench):
        """Why it cannot be run here, or None."""

    def version(self):
        return ""

    def prepare(self, job):
        """What is done once for a surface, outside any time."""

    def command(self, job, size):
        raise NotImplementedError

    def run(self, job, size):
        """The run and its mesh, None when it made none."""
        mesh = os.path.join(job.folder, self.output)
        if os.path.exists(mesh):
            os.remove(mesh)
        run = Run(self.command(job, size), job.folder, TIMEOUT)
        return run, mesh if run.code == 0 and os.path.exists(mesh) else None


def package_version(package):
    """The version of upstream that a Debian package holds, empty when it came another way."""
    if not shutil.which("dpkg-query"):
        return ""
    said = Run(["dpkg-query", "-W", "-f", "${Version}", package])
    found = re.search(r"^(?:.*really)?(\d[\d.]*)", said.out) if said.code == 0 else None
    return found[1].rstrip(".") if found else ""


class TetGen(Peer):
    """Bounds the volume of tets; the least ratio of radius to edge is asked for that does not make too many by itself."""

    name, output = "TetGen", "surface.1.ele"
    QUALITIES = ("1.2", "1.4", "1.8")

    def missing(self, bench):
        return None if shutil.which("tetgen") else "package tetgen"

    def version(self):
        return package_version("tetgen")

    def prepare(self, job):
        for self.quality in self.QUALITIES:
            _, mesh = self.run(job, None)
            if not mesh or job.count(mesh) <= (1 + MATCHED) * job.tets:
                return

    def command(self, job, size):
        bound = f"a{size ** 3 / (6 * math.sqrt(2)):.6e}" if size else ""
        return ["tetgen", f"-pq{self.quality}{bound}", "surface.off"]

    def setting(self, size):
        return self.command(None, size)[1]


class Gmsh(Peer):
    """A constant field; sizes at the surface are those of its triangles."""

    output = "gmsh.msh"
    SCRIPT = """Merge "surface.msh";
Surface Loop(1) = {1};
Volume(1) = {1};
Field[1] = MathEval;
Field[1].F = "%.9g";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.SaveAll = 1;
"""

    def __init__(self, name, algorithm):
        self.name, self.algorithm = name, algorithm

    def missing(self, bench):
        return None if shutil.which("gmsh") else "package gmsh"

    def version(self):
        return package_version("gmsh")

    def prepare(self, job):
        write_msh(*read_off(os.path.join(job.folder, "surface.off")), os.path.join(job.folder, "surface.msh"))

    def command(self, job, size):
        script = os.path.join(job.folder, "surface.geo")
        with open(script, "w") as file:
            file.write(self.SCRIPT % size)
        return ["gmsh", "-3", script, "-o", self.output, "-format", "msh41", "-bin", "-nt", "1", "-v", "1",
                "-setnumber", "Mesh.Algorithm3D", str(self.algorithm)]

    def setting(self, size):
        return f"field {size:.4g}"


class Netgen(Peer):
    name, output = "Netgen", "netgen.msh"

    def missing(self, bench):
        for self.python in (sys.executable, "/usr/bin/python3"):
            if os.path.exists(self.python) and Run([self.python, "-c", "import netgen.meshing"]).code == 0:
                return None
        return "package python3-netgen"

    def version(self):
        return package_version("python3-netgen")

    def command(self, job, size):
        return [self.python, os.path.join(HERE, "peers", "netgen_mesh.py"), "surface.off", f"{size:.9g}", self.output]

    def setting(self, size):
        return f"maxh {size:.4g}"


class Cgal(Peer):
    """Our driver of Mesh_3 (bench/peers/cgal_mesh.cpp), built into the output folder when it is older than its source."""

    keeps, output = False, "cgal.mesh"

    def __init__(self, name, slivers):
        self.name, self.slivers = name, slivers

    def missing(self, bench):
        source, self.program = os.path.join(HERE, "peers", "cgal_mesh.cpp"), os.path.join(bench.folder, "cgal_mesh")
        if os.path.exists(self.program) and os.path.getmtime(self.program) >= os.path.getmtime(source):
            return None
        if not shutil.which("c++"):
            return "a C++ compiler"
        there = subprocess.run(["c++", "-E", "-x", "c++", "-"], input="#include <CGAL/make_mesh_3.h>\n", text=True, capture_output=True)
        if there.returncode != 0:
            return "package libcgal-dev"
        bench.say("  building the driver of CGAL, a minute or two")
        built = Run(["c++", "-std=c++17", "-O3", "-DNDEBUG", source, "-o", self.program, "-lgmp", "-lmpfr"])
        if built.code != 0:
            bench.say("  " + "\n  ".join(built.err.splitlines()[:3]))
            return "a CGAL with which bench/peers/cgal_mesh.cpp compiles"
        return None

    def version(self):
        text = subprocess.run(["c++", "-dM", "-E", "-x", "c++", "-"], input="#include <CGAL/version.h>\n", text=True, capture_output=True)
        found = re.search(r"#define CGAL_VERSION (\S+)", text.stdout)
        return found.group(1) if found else ""

    def command(self, job, size):
        return [self.program, job.input, f"{size:.9g}", self.output, *(["--slivers"] if self.slivers else []),
                *(["--features", str(job.crease)] if job.crease else [])]

    def setting(self, size):
        return f"size {size:.4g}"


PEERS = [TetGen(), Gmsh("Gmsh Delaunay", 1), Gmsh("Gmsh HXT", 10), Netgen(), Cgal("CGAL", False), Cgal("CGAL, slivers removed", True)]


# ---- one solid at one number of tets ----


class Job:
    """A folder with a solid (input, an OFF file), the boundary of laves's mesh of it (surface.off), and how many tets are wished."""

    def __init__(self, bench, folder, name, crease, path, tets):
        self.bench, self.folder, self.name, self.crease, self.input, self.tets = bench, folder, name, crease, path, tets
        self.facts = self.laves(["--boundary", os.path.join(folder, "surface.off")])[1]

    def laves(self, more=()):
        """The run of laves and its facts, None when it failed."""
        json_path = os.path.join(self.folder, "laves.json")
        run = Run([self.bench.program, "mesh", self.input, "--tets", str(self.tets), "--threads", "1", "--certificate", "none", "-q",
                   "--compress", "0", "-o", os.path.join(self.folder, "laves.vtu"), "--json", json_path, *more], timeout=TIMEOUT)
        facts = mesh_facts(run, json_path)
        if not facts:
            self.bench.say(f"  {self.name}: laves ended with {run.code}: {last_sentence(run.err)}")
        return run, facts

    def judge(self, mesh, *more):
        run = Run([self.bench.judge_program, mesh, *more], timeout=TIMEOUT)
        return json.loads(run.out) if run.code == 0 else None

    def count(self, mesh):
        judged = self.judge(mesh)
        return judged["tets"] if judged else 0


def next_size(size, off, few, many, turn):
    """From what is known of logarithms of (size, tets made over wished): by the cube law until the wish lies between two sizes, then
    by halving and by the line between them in turn."""
    if few is None or many is None:
        return size * math.exp(min(max(off / 3, -1), 1))
    share = 0.5 if turn % 2 else many[1] / (many[1] - few[1])
    return math.exp(many[0] + share * (few[0] - many[0]))


def match_size(job, peer, first):
    """The size with which the peer makes about as many tets, or None when it makes none."""
    quick = job.bench.options.quick
    size, best, few, many, spent = first, None, None, None, 0
    for turn in range(QUICK_MATCH_RUNS if quick else MATCH_RUNS):
        run, mesh = peer.run(job, size)
        spent += run.wall
        made = job.count(mesh) if mesh else 0
        if not made:
            break
        off = math.log(made / job.tets)
        if best is None or abs(off) < best[0]:
            best = (abs(off), size)
        if best[0] <= (QUICK_MATCHED if quick else MATCHED) or spent > MATCH_SECONDS:
            break
        if off < 0:
            few = (math.log(size), off)
        else:
            many = (math.log(size), off)
        size = next_size(size, off, few, many, turn)
    return best[1] if best else None


def known_sizes(bench):
    """What earlier runs found, kept in the output folder so that it is found once."""
    path = os.path.join(bench.folder, "peer_sizes.json")
    sizes = {}
    if os.path.exists(path):
        with open(path) as file:
            sizes = json.load(file)
    return path, sizes


def find_size(job, peer, first):
    path, sizes = known_sizes(job.bench)
    key = f"{job.name} {job.tets} {job.facts['tets']} {peer.name} {peer.version()}"
    if key not in sizes:
        sizes[key] = match_size(job, peer, first)
        with open(path, "w") as file:
            json.dump(sizes, file, indent=1)
    return sizes[key]


def judged_row(job, name, run, facts, setting, version):
    diagonal = math.dist(*bounds(job))
    worst = {kind: max(facts[f"to_surface_{kind}"] or math.nan, facts[f"from_surface_{kind}"] or math.nan) for kind in ("mean", "max")}
    return {"part": "peers", "solid": job.name, "program": name, "version": version, "setting": setting, "tets": facts["tets"],
            "wall": run.wall, "cpu": run.cpu, "peak_bytes": run.peak, "rate": facts["tets"] / run.cpu, "valid": facts["valid"],
            "low": facts["all"]["min"], "high": facts["all"]["max"], "ratio_mean": facts["radius_ratio_mean"],
            "mean": worst["mean"] / diagonal, "max": worst["max"] / diagonal}


def bounds(job):
    points = [[float(x) for x in p] for p in read_off(job.input)[0]]
    return [min(p[i] for p in points) for i in range(3)], [max(p[i] for p in points) for i in range(3)]


def told_if_far(row, job, notes):
    """Says it where no size was found that makes about as many tets: some peers jump."""
    if abs(math.log(row["tets"] / job.tets)) > (QUICK_MATCHED if job.bench.options.quick else MATCHED):
        notes.append(f"{row['program']} on {job.name}: no size was found with which it makes about {job.tets:,} tets; the nearest makes "
                     f"{row['tets']:,}.")
        job.bench.say("  " + notes[-1])


def timed(job, peer, size, rows, notes):
    """One run of the peer with laves before and after."""
    before, _ = job.laves()
    run, mesh = peer.run(job, size)
    after, _ = job.laves()
    facts = job.judge(mesh, "--surface", job.input) if mesh else None
    if not facts:
        notes.append(f"{peer.name} failed on {job.name}.")
        return
    row = judged_row(job, peer.name, run, facts, peer.setting(size), peer.version())
    ours = job.facts["tets"] / ((before.cpu + after.cpu) / 2)
    rows.append({**row, "setting_size": size, "laves_rate": ours, "times": ours / row["rate"], "before": before.cpu, "after": after.cpu})
    say_row(job.bench, rows[-1])
    told_if_far(rows[-1], job, notes)


def say_row(bench, r):
    times = f"{r['times']:7.1f} x" if "times" in r else "         "
    bench.say(f"  {r['solid']:16} {r['program']:22} {times} {r['tets']:9,} tets {r['cpu']:8.2f} s {r['rate'] / 1e3:8.1f} k/s "
              f"{r['peak_bytes'] / 2**20:7.0f} MiB  {r['low']:5.1f} .. {r['high']:5.1f}  ratio {r['ratio_mean']:.3f}  "
              f"distance {100 * r['mean']:.4f} {100 * r['max']:.3f} %" + ("" if r["valid"] else "  NOT VALID"))


def compare(job, peers, rows, notes):
    run, facts = job.laves()
    judged = job.judge(os.path.join(job.folder, "laves.vtu"), "--surface", job.input) if facts else None
    if not judged:
        notes.append(f"laves failed on {job.name}: no comparison there.")
        return
    rows.append(judged_row(job, "laves", run, judged, f"--tets {job.tets}", ""))
    say_row(job.bench, rows[-1])
    first = {}  # the size from which a second way of the same program sets out
    for peer in peers:
        peer.prepare(job)
        size = first[type(peer)] = find_size(job, peer, first.get(type(peer)) or facts["size"])
        if size is None:
            what = "the boundary of laves's mesh of" if peer.keeps else ""
            notes.append(f"{peer.name} makes no mesh of {what} {job.name}.".replace("  ", " "))
            job.bench.say("  " + notes[-1])
            continue
        timed(job, peer, size, rows, notes)


# ---- time against tets ----


def again(start):
    """The run of median CPU time: of several where one is short."""
    runs = [start()]
    while len(runs) < SHORT_RUNS and sum(r.cpu for r in runs) < SHORT_SECONDS:
        runs.append(start())
    return sorted(runs, key=lambda r: r.cpu)[len(runs) // 2]


def measure_curve(bench, folder, peers, rows):
    """On the bumps, with the sizes of the comparison scaled by the cube law; the tets are those that were made."""
    path = make_bumps(bench, os.path.join(folder, "curve.off"), CURVE_TRIANGLES)
    if not path:
        return
    whole = QUICK_TETS if bench.options.quick else TETS
    found = {r["program"]: r["setting_size"] for r in rows if r.get("solid") == "bumps" and r.get("setting_size")}
    for tets in QUICK_CURVE if bench.options.quick else (*CURVE, *LAVES_CURVE):
        job = Job(bench, folder, "bumps", None, path, tets)
        if not job.facts:
            continue
        curve_row(bench, rows, "laves", job.facts["tets"], again(lambda job=job: job.laves()[0]))
        for peer in peers if tets not in LAVES_CURVE else []:
            if peer.name not in found:
                continue
            peer.prepare(job)
            size = found[peer.name] * (whole / tets) ** (1 / 3)
            _, mesh = peer.run(job, size)
            if mesh:
                made = job.count(mesh)
                curve_row(bench, rows, peer.name, made, again(lambda job=job, peer=peer, size=size: peer.run(job, size)[0]))


def curve_row(bench, rows, program, tets, run):
    rows.append({"part": "curve", "program": program, "tets": tets, "cpu": run.cpu, "wall": run.wall, "peak_bytes": run.peak})
    bench.say(f"  time against tets: {program:22} {tets:10,} tets {run.cpu:8.2f} s")


# ---- the section ----


def present_peers(bench, notes):
    there = []
    for peer in PEERS:
        lacks = peer.missing(bench)
        if lacks:
            notes.append(f"{peer.name} was LEFT OUT: missing here is {lacks}.")
            bench.say("  " + notes[-1])
        else:
            there.append(peer)
    return there


def section_figures(rows):
    figures = []
    for peer in PEERS:
        mine = [r for r in rows if r["part"] == "peers" and r["program"] == peer.name]
        if not mine:
            continue
        least = min(r["times"] for r in mine)
        target = TARGETS.get(peer.name)
        each = ", ".join(f"{r['solid']} {r['times']:.1f}" for r in mine)
        figures.append(figure(f"tets per CPU second, laves over {peer.name} {mine[0]['version']}".rstrip(), each,
                              f">= {target}" if target else "", least >= target if target else None))
    ours = [r for r in rows if r["part"] == "peers" and r["program"] == "laves"]
    if ours:
        each = ", ".join(f"{r['solid']} {r['rate'] / STUFFER_RATE:.0f}" for r in ours)
        figures.append(figure("the same over a lattice stuffer with optimisation (quoted: 1e4 tets per CPU second)", each,
                              f">= {STUFFER_TARGET}", min(r["rate"] for r in ours) >= STUFFER_TARGET * STUFFER_RATE))
    return figures


class Done:
    """What was measured for each solid, kept in the output folder until all is: a run that was cut off goes on where it was, when it
    is started again with the same program."""

    def __init__(self, bench):
        with open(bench.program, "rb") as file:
            self.run = {"program": hashlib.sha256(file.read()).hexdigest(), "quick": bench.options.quick}
        self.path = os.path.join(bench.folder, "peers_unfinished.json")
        self.parts = {}
        if os.path.exists(self.path):
            with open(self.path) as file:
                kept = json.load(file)
            if kept["run"] == self.run:
                self.parts = kept["parts"]

    def part(self, bench, name, measure, rows, notes):
        """Adds the rows and notes that measure(rows, notes) makes, or made earlier."""
        if name in self.parts:
            bench.say(f"  {name}: measured earlier")
        else:
            part = {"rows": list(rows), "notes": []}
            measure(part["rows"], part["notes"])
            part["rows"] = part["rows"][len(rows):]
            self.parts[name] = part
            with open(self.path, "w") as file:
                json.dump({"run": self.run, "parts": self.parts}, file)
        rows += self.parts[name]["rows"]
        notes += self.parts[name]["notes"]

    def end(self):
        if os.path.exists(self.path):
            os.remove(self.path)


def measure_solid(bench, folder, peers, name, crease, rows, notes):
    path = make_subject(bench, folder, name)
    if not path:
        notes.append(f"{name} is not there: left out.")
        bench.say("  " + notes[-1])
        return
    job = Job(bench, folder, name, crease, path, QUICK_TETS if bench.options.quick else TETS)
    if job.facts:
        compare(job, peers, rows, notes)


def measure_peers(bench):
    rows, notes = [], []
    peers, done = present_peers(bench, notes), Done(bench)
    with tempfile.TemporaryDirectory() as folder:
        for name, crease in QUICK_SUBJECTS if bench.options.quick else SUBJECTS:
            done.part(bench, name, lambda own, told, name=name, crease=crease: measure_solid(bench, folder, peers, name, crease, own, told),
                      rows, notes)
        done.part(bench, "time against tets", lambda own, told: measure_curve(bench, folder, peers, own), rows, notes)
    if rows:
        bench.keep("peers", rows, section_figures(rows), notes)
        done.end()


# ---- drawing ----


def solid_table(rows):
    return table(["program", "tets per CPU s, laves over it", "tets", "thousand tets per CPU s", "CPU s", "wall s", "peak, bytes per tet",
                  "dihedral angles", "mean radius ratio", "mean distance, % diagonal", "largest", "valid", "setting"],
                 [[f"{r['program']} {r['version']}".rstrip(), f"{r['times']:.1f}" if "times" in r else "1", f"{r['tets']:,}",
                   f"{r['rate'] / 1e3:,.1f}", f"{r['cpu']:.2f}", f"{r['wall']:.2f}", f"{r['peak_bytes'] / r['tets']:,.0f}",
                   f"{r['low']:.1f} .. {r['high']:.1f}", f"{r['ratio_mean']:.3f}", f"{100 * r['mean']:.4f}", f"{100 * r['max']:.3f}",
                   "yes" if r["valid"] else "NO", f"`{r['setting']}`"] for r in rows])


def curve_table(rows):
    return "### Time against tets, on the bumps\n\n" + table(
        ["program", "tets", "CPU s", "wall s", "peak, bytes per tet"],
        [[r["program"], f"{r['tets']:,}", f"{r['cpu']:.2f}", f"{r['wall']:.2f}", f"{r['peak_bytes'] / r['tets']:,.0f}"]
         for r in sorted(rows, key=lambda r: r["program"])])


def peers_tables(rows):
    compared = [r for r in rows if r["part"] == "peers"]
    parts = [f"### {solid}\n\n" + solid_table([r for r in compared if r["solid"] == solid])
             for solid in dict.fromkeys(r["solid"] for r in compared)]
    curve = [r for r in rows if r["part"] == "curve"]
    return "\n\n".join(parts + ([curve_table(curve)] if curve else []))
