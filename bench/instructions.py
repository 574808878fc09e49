"""Section `instructions` of bench/run: instructions per tetrahedron of two small jobs on one thread, counted by valgrind.

A count does not depend on what else the machine does, so a change of some per cent is seen where no clock would show it. It does depend on
the compiler: what is kept in bench/results/instructions.json is kept for each, and a compiler without a figure is told and left out.
"""

import json
import os
import platform
import re
import shutil

from common import Run, figure, table

HERE = os.path.dirname(os.path.abspath(__file__))
KEPT = os.path.join(HERE, "results", "instructions.json")
TETS = 20000
JOBS = {"sphere(1)": "sphere(1)", "knot.ply": os.path.join(HERE, "..", "demo", "knot.ply")}
TOLERANCE = 0.05


def compiler_key(bench):
    """Compiler and version, processor, flags: what the count depends on."""
    text = bench.compiler()
    name = "clang" if "clang" in text else "gcc"
    version = re.search(r"\b\d+\.\d+\.\d+", re.sub(r"\([^)]*\)", "", text))
    flags = text.rsplit(", ", 1)[-1] if ", " in text else ""
    return f"{name} {version[0] if version else '?'}, {platform.machine()}, {flags}".rstrip(", ")


def count_instructions(bench, name, solid):
    """Tets and instructions of one job, the whole process; None when it failed."""
    run = Run(["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null", bench.measure_program, solid,
               str(TETS), "--threads", "1"])
    counted = re.search(r"I\s+refs:\s+([\d,]+)", run.err)
    if run.code != 0 or not counted:
        bench.say(f"  {name}: valgrind ended with {run.code}: {run.err.strip()[-300:]}")
        return None
    return {"tets": int(json.loads(run.out)["tets"]), "instructions": int(counted[1].replace(",", ""))}


def read_kept():
    if not os.path.exists(KEPT):
        return {}
    with open(KEPT) as file:
        return json.load(file)


def record(key, rows):
    kept = read_kept()
    kept[key] = {r["job"]: round(r["per_tet"]) for r in rows}
    with open(KEPT, "w") as file:
        json.dump(kept, file, indent=2, sort_keys=True)
        file.write("\n")


def job_figure(row, kept):
    name = f"instructions per tet, {row['job']}, {row['tets']:,} tets"
    if kept is None:
        return figure(name, f"{row['per_tet']:,.0f}", "", None)
    change = row["per_tet"] / kept - 1
    fell = "; fell, so keep it: --record" if change < -TOLERANCE else ""
    return figure(name, f"{row['per_tet']:,.0f} ({100 * change:+.1f} %{fell})", f"{kept:,} + {100 * TOLERANCE:.0f} %", change <= TOLERANCE)


def measure_instructions(bench):
    if not shutil.which("valgrind"):
        bench.say("  SKIPPED: valgrind is not installed")
        return
    key, notes, rows, failed = compiler_key(bench), [], [], []
    kept = read_kept().get(key)
    if kept is None and bench.options.check:
        bench.say(f"  SKIPPED: bench/results/instructions.json has no figures for {key}; to keep some: --record")
        return
    for name, solid in JOBS.items():
        counted = count_instructions(bench, name, solid)
        if not counted:
            failed.append(name)
            continue
        rows.append({"job": name, **counted, "per_tet": counted["instructions"] / counted["tets"], "compiler": key})
    if bench.options.record and rows and not failed:
        record(key, rows)
        kept = None
    notes.append(f"Compiler: {key}.")
    figures = [job_figure(r, kept.get(r["job"]) if kept else None) for r in rows]
    if failed:
        figures.append(figure("jobs that failed", ", ".join(failed), "none", False))
    bench.keep("instructions", rows, figures, notes)


def instructions_table(rows):
    return table(["job", "tets", "instructions per tet", "million instructions"],
                 [[r["job"], f"{r['tets']:,}", f"{r['per_tet']:,.0f}", f"{r['instructions'] / 1e6:,.0f}"] for r in rows])
