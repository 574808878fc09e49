"""Section `oracle` of bench/run: what the number of input triangles costs.

One shape, the bumps of bench/bumps.c, as surfaces of ever more triangles, read, indexed, and meshed with as many tets.
"""

import os
import tempfile

from common import Run, figure, table

TRIANGLES = (100000, 1000000, 10000000)
TETS, QUICK_TETS = 5000000, 500000


def surface_row(bench, folder, triangles, tets):
    path = os.path.join(folder, "bumps.ply")
    made = Run([bench.beside("laves-bumps"), str(triangles), path])
    if made.code != 0:
        bench.say(f"  laves-bumps ended with {made.code}: {made.err.strip()}")
        return None
    facts = bench.measure(path, tets, "--threads", "1")
    os.remove(path)
    if not facts or "failed" in facts:
        return None
    return {"triangles": triangles, "read_cpu": facts["read_cpu"][0], "bytes": facts["domain_bytes"] / triangles,
            "tets": int(facts["tets"]), "mesh_cpu": facts["mesh_cpu"][0], "peak_bytes": facts["peak_bytes"],
            "stages": facts["stages_cpu"]}


def measure_surfaces(bench):
    rows, quick = [], bench.options.quick
    with tempfile.TemporaryDirectory(dir=bench.folder) as folder:
        for triangles in TRIANGLES[:2] if quick else TRIANGLES:
            row = surface_row(bench, folder, triangles, QUICK_TETS if quick else TETS)
            if not row:
                continue
            rows.append(row)
            bench.say(f"  {triangles:11,} triangles: read and indexed in {row['read_cpu']:.2f} CPU s, {row['bytes']:.0f} bytes a "
                      f"triangle; {row['tets']:,} tets in {row['mesh_cpu']:.2f} CPU s")
    if not rows:
        return
    first, last = rows[0], rows[-1]
    bench.keep("oracle", rows, [
        figure(f"reading and indexing {last['triangles']:,} triangles, CPU microseconds and bytes a triangle",
               f"{1e6 * last['read_cpu'] / last['triangles']:.2f} and {last['bytes']:.0f}", "", None),
        figure(f"meshing {last['tets']:,} tets with {last['triangles']:,} triangles over {first['triangles']:,}, CPU seconds",
               f"{last['mesh_cpu'] / first['mesh_cpu']:.2f} times", "", None)])


def surfaces_table(rows):
    return table(["triangles", "reading and indexing, microseconds a triangle", "bytes a triangle", "CPU s", "tets",
                  "meshing them, CPU s", "peak, GiB"],
                 [[f"{r['triangles']:,}", f"{1e6 * r['read_cpu'] / r['triangles']:.2f}", f"{r['bytes']:.0f}", f"{r['read_cpu']:.2f}",
                   f"{r['tets']:,}", f"{r['mesh_cpu']:.2f}", f"{r['peak_bytes'] / 2**30:.2f}"] for r in rows])
