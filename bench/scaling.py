"""Section `scaling` of bench/run: how time and memory grow with threads and with tetrahedra, beside what the machine can do at best.

A sphere is meshed from ten thousand tets up, on one thread for the CPU time of each stage and on all for wall time; laves-floor fills
as much memory and writes as many bytes in the same run.
"""

import concurrent.futures
import json
import math
import os
import shutil
import statistics
import tempfile

from common import Run, figure, last_sentence, mesh_facts, table

SOLID = "sphere"
SIZES = (10000, 30000, 100000, 300000, 1000000, 3000000, 10000000, 30000000, 100000000)
QUICK_SIZES = (10000, 30000, 100000, 300000, 1000000)
STREAMED, QUICK_STREAMED, HUGE = 10000000, 1000000, 1000000000
HUGE_MEMORY = 22  # GiB of address space
HUGE_ROOM = 50  # bytes of disk for each tet, about what a VTU file takes
MESHED_AT_ONCE = 3000000  # small meshes are made again and again, until about as many tets were made
RUNS_MOST = 20
THREADS_TARGET = 1.8
STREAMED_TARGET = 1.3  # of a billion tets: wall seconds of all, over those of writing as many bytes
# All but these handle the boundary only, so they shall grow like its triangles, tets^(2/3); what they may reach at most.
FILLING = {"stamp", "mesh", "write"}
EXPONENT_TARGET = 0.75
CLOCK = 1e-3  # seconds: shorter times are not fitted
FITTED = 5  # the largest sizes that are


# ---- threads ----


# How meshing is run: label, jobs at once, threads of each. Two jobs that share nothing show what the second core is worth here: often
# less than one, where two cores share caches and memory.
THREADED = {"one": (1, 1), "two": (1, 2), "both": (2, 1)}


def meshing_wall(bench, name, tets, jobs, threads):
    """Wall seconds of meshing, the mean of jobs that run at once; None when one fails."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        runs = [pool.submit(bench.measure, name, tets, "--threads", str(threads)) for _ in range(jobs)]
        told = [run.result() for run in runs]
    if any(not facts or "failed" in facts for facts in told):
        return None
    return statistics.fmean(facts["mesh_wall"][0] for facts in told)


def measure_threads(bench, rows):
    """Wall seconds of meshing on one thread, on two, and of two jobs of one thread at once, in turn."""
    quick = bench.options.quick
    for name, tets in (("dragon.obj", 50000 if quick else 500000), (SOLID, 200000 if quick else 5000000)):
        walls = {label: [] for label in THREADED}
        for _ in range(2 if quick else 5):
            for label, (jobs, threads) in THREADED.items():
                walls[label].append(meshing_wall(bench, name, tets, jobs, threads))
        if any(None in seen for seen in walls.values()):
            continue
        row = {label: statistics.median(seen) for label, seen in walls.items()}
        row |= {"part": "threads", "name": name, "tets": tets, "times": row["one"] / row["two"], "most": 2 * row["one"] / row["both"]}
        rows.append(row)
        bench.say(f"  {name} {tets:,}: {row['one']:.3f} s on one thread, {row['two']:.3f} s on two, {row['times']:.2f} times; two jobs "
                  f"of one thread at once {row['both']:.3f} s, {row['most']:.2f} times the work of one")


# ---- sizes ----


def floor(bench, *words):
    run = Run([bench.beside("laves-floor"), *map(str, words)])
    if run.code != 0:
        bench.say(f"  laves-floor ended with {run.code}: {run.err.strip()}")
        return None
    return json.loads(run.out)


def size_row(bench, folder, tets):
    """Medians of meshing and writing at one number of tets, and the floor below them; None when something failed."""
    mesh, repeat = os.path.join(folder, "mesh.vtu"), str(max(1, min(RUNS_MOST, MESHED_AT_ONCE // tets)))
    one = bench.measure(SOLID, tets, "--threads", "1", "--repeat", repeat, "--write", mesh)
    every = bench.measure(SOLID, tets, "--repeat", repeat)
    if not one or not every or "failed" in one or "failed" in every:
        return None
    written = os.path.getsize(mesh)
    os.remove(mesh)
    filled, plain = floor(bench, int(one["result_bytes"])), floor(bench, written, mesh)
    if not filled or not plain:
        return None
    made, middle = one["tets"], statistics.median
    stages = {**one["stages_cpu"], "else": max(min(one["mesh_cpu"]) - sum(one["stages_cpu"].values()), 0)}
    return {"part": "sizes", "tets": int(made), "cpu": middle(one["mesh_cpu"]), "wall": middle(every["mesh_wall"]),
            "write_cpu": middle(one["write_cpu"]), "write_wall": middle(one["write_wall"]), "stages": stages,
            "result_bytes": one["result_bytes"] / made, "peak_bytes": every["peak_bytes"] / made, "file_bytes": written / made,
            "fill_wall": filled["fill_wall"], "refill_wall": filled["refill_wall"], "plain_wall": plain["write_wall"]}


def measure_sizes(bench, folder, rows):
    for tets in QUICK_SIZES if bench.options.quick else SIZES:
        row = size_row(bench, folder, tets)
        if not row:
            return
        rows.append(row)
        stages = ", ".join(f"{name} {seconds:.4f}" for name, seconds in row["stages"].items())
        bench.say(f"  {row['tets']:11,} tets: {row['cpu']:.3f} CPU s ({stages}), {row['wall']:.3f} s on all cores, "
                  f"{row['wall'] / row['fill_wall']:.1f} times filling; writing {row['write_wall']:.3f} s, "
                  f"{row['write_wall'] / row['plain_wall']:.1f} times write(2); {row['result_bytes']:.1f} bytes a tet, at most "
                  f"{row['peak_bytes']:.1f}")


def stage_points(rows):
    """For each stage its (tets, CPU seconds) in the fastest run; what is between stages, and writing, are told like stages."""
    points = {}
    for row in rows:
        for name, seconds in {**row["stages"], "write": row["write_cpu"]}.items():
            points.setdefault(name, []).append((row["tets"], seconds))
    return points


def exponent(points):
    """The slope of seconds against tets on log axes, by least squares over the largest sizes; None where fewer than three of
    them can be told from nothing."""
    told = [(math.log(tets), math.log(seconds)) for tets, seconds in points[-FITTED:] if seconds >= CLOCK]
    if len(told) < 3:
        return None
    x, y = (statistics.fmean(p[i] for p in told) for i in (0, 1))
    return sum((p[0] - x) * (p[1] - y) for p in told) / sum((p[0] - x) ** 2 for p in told)


# ---- streaming ----


def can_stream(bench):
    return "--stream" in Run([bench.program, "mesh", "--help"]).out


def stream_row(bench, tets):
    """One streamed mesh into a file of the output folder, within the address space that a billion tets shall fit in."""
    mesh, json_path = os.path.join(bench.folder, "streamed.vtu"), os.path.join(bench.folder, "streamed.json")
    run = Run(["sh", "-c", f"ulimit -v {HUGE_MEMORY << 20} && exec \"$@\"", "sh", bench.program, "mesh", "sphere(1)", "--tets", str(tets),
               "--stream", "--certificate", "none", "--compress", "0", "-q", "-o", mesh, "--json", json_path], timeout=7200)
    facts = mesh_facts(run, json_path)
    written = os.path.getsize(mesh) if os.path.exists(mesh) else 0
    if written:
        os.remove(mesh)
    plain = floor(bench, written, mesh) if written and facts else None
    if not facts:
        bench.say(f"  streaming {tets:,} tets: laves ended with {run.code}: {last_sentence(run.err)}")
        return {"part": "stream", "wished": tets, "failed": last_sentence(run.err) or f"exit code {run.code}"}
    row = {"part": "stream", "wished": tets, "tets": facts["tets"], "wall": run.wall, "cpu": run.cpu, "peak_bytes": run.peak,
           "file_bytes": written, "plain_wall": plain["write_wall"] if plain else None}
    beside = f", {run.wall / row['plain_wall']:.2f} times write(2) of as much" if plain else ""
    bench.say(f"  streaming {row['tets']:,} tets: {run.wall:.1f} s, {run.cpu:.1f} CPU s, {run.peak / 2**30:.2f} GiB, file "
              f"{written / 2**30:.1f} GiB{beside}")
    return row


def measure_stream(bench, rows, notes):
    if not can_stream(bench):
        notes.append("`laves mesh` has no option --stream here: streamed meshes were LEFT OUT" + (
            ", --huge too." if bench.options.huge else "."))
        bench.say("  " + notes[-1])
        return
    rows.append(stream_row(bench, QUICK_STREAMED if bench.options.quick else STREAMED))
    if not bench.options.huge:
        notes.append("A billion tets: left out without --huge.")
        return
    free = shutil.disk_usage(bench.folder).free
    if free < HUGE * HUGE_ROOM:
        notes.append(f"A billion tets: LEFT OUT, {free / 2**30:.0f} GiB are free where the output goes and "
                     f"{HUGE * HUGE_ROOM / 2**30:.0f} are needed.")
        bench.say("  " + notes[-1])
        return
    rows.append(stream_row(bench, HUGE))


# ---- the section ----


def part_of(rows, part):
    return [r for r in rows if r["part"] == part]


def stage_figures(rows):
    figures = []
    for name, points in stage_points(rows).items():
        slope = exponent(points)
        if slope is None:
            continue
        bounded = name not in FILLING
        figures.append(figure(f"CPU time of stage {name} grows like tets to the power of", f"{slope:.2f}",
                              f"<= {EXPONENT_TARGET}" if bounded else "", slope <= EXPONENT_TARGET if bounded else None))
    return figures


def stream_figures(rows):
    figures = []
    for r in rows:
        if "failed" in r:
            figures.append(figure(f"streamed mesh of {r['wished']:,} tets", r["failed"], "a mesh", False))
            continue
        minute = r["wished"] == HUGE
        figures.append(figure(f"streamed mesh of {r['tets']:,} tets into a file, wall seconds, and GiB resident",
                              f"{r['wall']:.1f}, {r['peak_bytes'] / 2**30:.2f}", "<= 60 s" if minute else "",
                              r["wall"] <= 60 if minute else None))
        if r.get("plain_wall"):
            times = r["wall"] / r["plain_wall"]
            figures.append(figure(f"streamed mesh of {r['tets']:,} tets over a plain write(2) of as many bytes, wall seconds",
                                  f"{times:.2f} times", f"<= {STREAMED_TARGET}" if minute else "",
                                  times <= STREAMED_TARGET if minute else None))
    return figures


def thread_figures(rows):
    figures = []
    for r in rows:
        figures.append(figure(f"speed-up of meshing {r['name']}, {r['tets']:,} tets, by a second thread", f"{r['times']:.2f} times",
                              f">= {THREADS_TARGET}", r["times"] >= THREADS_TARGET))
        if "most" in r:
            figures.append(figure("work of two such jobs at once, of one thread each, over that of one: what the second core is worth",
                                  f"{r['most']:.2f} times", "", None))
    return figures


def section_figures(rows):
    figures = thread_figures(part_of(rows, "threads"))
    sizes = part_of(rows, "sizes")
    figures += stage_figures(sizes)
    if sizes:
        r = sizes[-1]
        figures += [
            figure(f"meshing {r['tets']:,} tets on all cores over filling its bytes once, fresh and again, wall seconds",
                   f"{r['wall'] / r['fill_wall']:.1f} and {r['wall'] / r['refill_wall']:.1f} times", "", None),
            figure("writing its file over a plain write(2) of as many bytes, wall seconds",
                   f"{r['write_wall'] / r['plain_wall']:.2f} times", "", None),
            figure("bytes a tet there, of the mesh and at most", f"{r['result_bytes']:.1f} and {r['peak_bytes']:.1f}", "", None)]
    return figures + stream_figures(part_of(rows, "stream"))


def measure_scaling(bench):
    rows, notes = [], []
    if (os.cpu_count() or 1) > 1:
        measure_threads(bench, rows)
    else:
        notes.append("One core only: what a second thread gains was LEFT OUT.")
    with tempfile.TemporaryDirectory(dir=bench.folder) as folder:
        measure_sizes(bench, folder, rows)
    measure_stream(bench, rows, notes)
    if rows:
        bench.keep("scaling", rows, section_figures(rows), notes)


# ---- drawing ----


def sizes_table(rows):
    return "### A sphere, from small to large\n\n" + table(
        ["tets", "meshing over filling memory, wall", "writing over write(2), wall", "million tets per wall s, all cores",
         "per CPU s, one thread", "bytes per tet, mesh", "peak", "file"],
        [[f"{r['tets']:,}", f"{r['wall'] / r['fill_wall']:.1f}", f"{r['write_wall'] / r['plain_wall']:.2f}",
          f"{r['tets'] / r['wall'] / 1e6:.2f}", f"{r['tets'] / r['cpu'] / 1e6:.2f}", f"{r['result_bytes']:.1f}",
          f"{r['peak_bytes']:.1f}", f"{r['file_bytes']:.1f}"] for r in rows])


def stages_table(rows):
    points = stage_points(rows)
    slopes = {name: exponent(p) for name, p in points.items()}
    return "### CPU seconds of each stage\n\n" + table(
        ["tets", *points],
        [*([f"{r['tets']:,}", *(f"{p[i][1]:.4f}" for p in points.values())] for i, r in enumerate(rows)),
         ["exponent", *("-" if slopes[name] is None else f"{slopes[name]:.2f}" for name in points)]])


def scaling_tables(rows):
    sizes = part_of(rows, "sizes")
    return "\n\n".join([sizes_table(sizes), stages_table(sizes)]) if sizes else ""
