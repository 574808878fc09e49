"""Section `python` of bench/run: what the Python package costs beside the C library, in CPU seconds of one process."""

import json
import os
import statistics
import subprocess
import sys

from common import Run, figure, table

HERE = os.path.dirname(os.path.abspath(__file__))
OVERHEAD_MAX = 1.05
CALLABLE_MAX = 2


def python_with_numpy():
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([python, "-c", "import numpy"], capture_output=True, check=False).returncode == 0:
            return python
    return None


def median_ratio(rows, ours, theirs):
    """Runs stand in turn: each of ours is compared with the one before it."""
    pairs = zip([r for r in rows if r["what"] == ours], [r for r in rows if r["what"] == theirs])
    return statistics.median(a["cpu"] / b["cpu"] for a, b in pairs)


def measure_python(bench):
    python = python_with_numpy()
    if not python:
        bench.say("  there is no Python with NumPy (Debian: python3-numpy): left out")
        return
    library, module = bench.beside("liblaves-shared.so"), bench.beside("liblaves-callback.so")
    if not (os.path.exists(library) and os.path.exists(module)):
        bench.say("  to be built first: cmake --build build --target laves-shared laves-callback")
        return
    environment = {**os.environ, "PYTHONPATH": os.path.join(HERE, "..", "python"), "LAVES_LIBRARY": library}
    os.environ.update(environment)
    run = Run([python, os.path.join(HERE, "python_calls.py"), "3" if bench.options.quick else "9", module])
    if run.code != 0:
        bench.say(f"  python_calls.py ended with {run.code}: {run.err.strip()[-500:]}")
        return
    rows = [json.loads(line) for line in run.out.splitlines()]
    overhead = median_ratio(rows, "arrays, Python", "arrays, C library")
    one, two = (median_ratio(rows, f"callable, Python, {n}", f"callable, C callback, {n}") for n in (1, 2))
    tets = rows[0]["tets"]
    same = all(len({r["hash"] for r in rows if r["what"].startswith(kind)}) == 1 for kind in ("arrays", "callable"))
    calls, points = rows[-1]["calls"], rows[-1]["points"]
    bench.keep("python", rows, [
        figure(f"laves.mesh(points, faces) of Python over the C library, {tets:,} tets, CPU seconds, one thread", f"{overhead:.3f} times",
               f"<= {OVERHEAD_MAX}", overhead <= OVERHEAD_MAX),
        figure(f"a callable of Python over the same in C, {rows[-1]['tets']:,} tets, CPU seconds, one thread", f"{one:.2f} times",
               f"<= {CALLABLE_MAX}", one <= CALLABLE_MAX),
        figure("the same with two threads, which take turns in Python (the default is one)", f"{two:.2f} times", "", None),
        figure("calls of that callable, and points in each", f"{calls:,}, {points / calls:.0f} in the mean", "", None),
        figure("meshes are the same", "yes" if same else "NO", "yes", same)])


def python_table(rows):
    lines = []
    for kind in sorted({r["what"] for r in rows}):
        of_kind = [r for r in rows if r["what"] == kind]
        lines.append([kind, f"{of_kind[0]['tets']:,}", f"{statistics.median(r['cpu'] for r in of_kind):.3f}",
                     f"{statistics.median(r['wall'] for r in of_kind):.3f}"])
    return table(["what, threads", "tets", "CPU seconds", "wall seconds"], lines)
