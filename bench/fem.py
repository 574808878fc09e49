"""Section `fem` of bench/run: what a finite element program makes of meshes of the same solid with as many tetrahedra, by laves and by
the meshers that Debian has. bench/fem_solve.py solves; this makes the meshes, as section `peers` does, and tells.
"""

import json
import os
import sys
import tempfile

from common import Run, figure, table
from peers import Gmsh, Job, TetGen, find_size, make_bumps
from plot import write_plot

HERE = os.path.dirname(os.path.abspath(__file__))
TRIANGLES = 20000  # of the solid
TETS, QUICK_TETS = (10000, 50000, 200000), (10000, 30000)
PROBLEMS = {"poisson": "Poisson", "elastic": "elasticity"}
SOLVE_RUNS = 2  # the least CPU time counts


def find_python():
    """An interpreter with the packages that the solver needs, or None."""
    for python in (sys.executable, "/usr/bin/python3"):
        if os.path.exists(python) and Run([python, "-c", "import meshio, scipy.sparse"]).code == 0:
            return python
    return None


def readable(mesh):
    """The mesh in a form that meshio reads: of Gmsh's 4.1 it refuses files in which not all entities are physical."""
    if not mesh.endswith(".msh"):
        return mesh
    old = mesh[:-4] + "22.msh"
    run = Run(["gmsh", mesh, "-0", "-format", "msh22", "-save_all", "-v", "1", "-o", old])
    return old if run.code == 0 else mesh


def solve(bench, python, mesh):
    """The facts of the solver, with the least CPU time of several runs; None when it failed."""
    best = None
    for _ in range(1 if bench.options.quick else SOLVE_RUNS):
        run = Run(["env", "OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1", python, os.path.join(HERE, "fem_solve.py"), mesh])
        if run.code != 0:
            bench.say(f"  the solver ended with {run.code}: {run.err.strip()[-300:]}")
            return None
        facts = json.loads(run.out)
        for problem in PROBLEMS:
            for way in ("plain", "scaled"):
                if best:
                    facts[problem][way]["cpu"] = min(facts[problem][way]["cpu"], best[problem][way]["cpu"])
        best = facts
    return best


def add_rows(bench, rows, name, wished, judged, facts):
    for problem in PROBLEMS:
        found = facts[problem]
        rows.append({"problem": problem, "program": name, "wished": wished, "tets": facts["tets"], "vertices": facts["vertices"],
                     "low": judged["all"]["min"], "high": judged["all"]["max"], "unknowns": found["unknowns"],
                     "value_error": found["value_error"], "energy_error": found["energy_error"],
                     **{f"{way}_{key}": found[way][key] for way in ("plain", "scaled") for key in ("condition", "iterations", "cpu")}})
        r = rows[-1]
        bench.say(f"  {PROBLEMS[problem]:10} {name:14} {r['tets']:8,} tets {r['low']:5.1f} .. {r['high']:5.1f}  error {r['value_error']:.5f}, "
                  f"in energy {r['energy_error']:.4f}  condition {r['plain_condition']:9.1f}  iterations {r['plain_iterations']:5}, "
                  f"scaled {r['scaled_iterations']:4}, {r['scaled_cpu']:.3f} s")


def judge_and_solve(bench, python, job, name, mesh, rows, notes):
    judged, facts = job.judge(mesh), solve(bench, python, readable(mesh))
    if judged and facts:
        add_rows(bench, rows, name, job.tets, judged, facts)
    else:
        notes.append(f"The mesh of {name} with {job.tets:,} tetrahedra could not be solved on.")


def compare(bench, python, job, peers, rows, notes):
    judge_and_solve(bench, python, job, "laves", os.path.join(job.folder, "laves.vtu"), rows, notes)
    for peer in peers:
        peer.prepare(job)
        size = find_size(job, peer, job.facts["size"])
        mesh = peer.run(job, size)[1] if size else None
        if mesh:
            judge_and_solve(bench, python, job, peer.name, mesh, rows, notes)
        else:
            notes.append(f"{peer.name} makes no mesh with {job.tets:,} tetrahedra.")


def lead(rows, problem, key):
    """The figure of the best peer over that of laves, at the largest number of tets; None without both."""
    last = [r for r in rows if r["problem"] == problem and r["wished"] == max(r["wished"] for r in rows)]
    ours = [r[key] for r in last if r["program"] == "laves"]
    theirs = [r[key] for r in last if r["program"] != "laves"]
    return min(theirs) / ours[0] if ours and theirs and ours[0] else None


def measure_fem(bench):
    python, rows, notes = find_python(), [], []
    if not python:
        bench.say("  SciPy and meshio are not installed (packages python3-scipy, meshio-tools): left out")
        return
    peers = [peer for peer in (TetGen(), Gmsh("Gmsh Delaunay", 1), Gmsh("Gmsh HXT", 10)) if not peer.missing(bench)]
    for tets in QUICK_TETS if bench.options.quick else TETS:
        with tempfile.TemporaryDirectory() as folder:
            path = make_bumps(bench, os.path.join(folder, "bumps.off"), TRIANGLES)
            job = Job(bench, folder, f"bumps for fem {TRIANGLES}", None, path, tets) if path else None
            if job and job.facts:
                compare(bench, python, job, peers, rows, notes)
    if not rows:
        return
    figures = []
    for problem, what in PROBLEMS.items():
        for key, name in (("energy_error", "error in energy"), ("plain_condition", "condition number"),
                          ("scaled_iterations", "iterations, scaled")):
            value = lead(rows, problem, key)
            if value:
                figures.append(figure(f"{what}, {name}: the best peer over laves", f"{value:.2f}", "", None))
    bench.keep("fem", rows, figures, notes)


def draw_fem(sections, path):
    """What a given error costs: errors in energy against the seconds of conjugate gradients, of elasticity."""
    lines = {}
    for r in sections["fem"]["rows"]:
        if r["problem"] == "elastic":
            lines.setdefault(r["program"], []).append((r["scaled_cpu"], r["energy_error"]))
    lines = {name: sorted(points) for name, points in lines.items()}
    write_plot(lines, path, "Elasticity: error in energy against CPU seconds of conjugate gradients", "CPU seconds")


def fem_tables(rows):
    parts = []
    for problem, what in PROBLEMS.items():
        body = [[r["program"], f"{r['tets']:,}", f"{r['unknowns']:,}", f"{r['low']:.1f} .. {r['high']:.1f}", f"{100 * r['value_error']:.3f} %",
                 f"{100 * r['energy_error']:.2f} %", f"{r['plain_condition']:,.0f}", f"{r['scaled_condition']:,.0f}",
                 str(r["plain_iterations"]), str(r["scaled_iterations"]), f"{1000 * r['scaled_cpu']:.1f} ms"]
                for r in rows if r["problem"] == problem]
        parts.append(f"### {what.capitalize()}\n\n" + table(["mesh", "tets", "unknowns", "dihedral angles", "error", "error in energy", "condition", "scaled",
                                                         "iterations", "scaled", "CPU, scaled"], body))
    return "\n\n".join(parts)
