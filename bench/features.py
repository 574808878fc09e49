"""Section `features` of bench/run: sharp edges, corners, thin parts.

Four tables: solids with creases at two sizes, smooth models, plates and shells and gaps, and the tray. Meshes are made by `laves mesh`
and judged from their files by `laves check --features`, on one thread.
"""

import json
import math
import os
import tempfile

import parts
from common import Run, figure, last_sentence, mesh_facts, table

MODELS = ["fandisk.obj", "joint.obj", "block.obj", "plate_holes.STL", "20mm-xyz-cube.stl", "fixed_top.ply", "featuretype.ply",
          "cube.off", "decimated-knight.off"]
SHAPES = ["bracket", "flange", "gear", "drilled_cube", "wedge", "crossed_cylinders"]
TETS = (50000, 500000)
SMOOTH = ["bunny.obj", "spot.obj", "horse.ply", "hand_closed.obj", "homer.obj", "fertility.off", "dragon.obj", "rocker-arm.obj",
          "torus_far.ply", "penguin_micro.off", "sphere", "torus", "thin_torus", "ellipsoid", "metaballs", "gyroid"]

# Shares of the diagonal.
CREASE_DISTANCE, SURFACE_DISTANCE, SMOOTH_DISTANCE = 1e-3, 1.5e-3, 6e-3
# Degrees: where nothing is in the way; everywhere; and the input's angle from which on it is in the way.
WINDOW, WIDE_WINDOW, BLUNT = (35, 130), (25, 140), 70
# What improvement may cost with features, of that without, per boundary vertex.
COST = 2

THICKNESSES = (0.5, 0.75, 1, 1.5, 2, 3)  # sizes
WINDOW_FROM = 0.75  # sizes: the thinnest plate that shall keep the window
GAPS = (0.75, 1, 1.5, 2)
SHELL_RADIUS = 8  # sizes
# Axis and angle: along the lattice, and eleven turns that no symmetry of it brings back to that.
TURNS = [None] + [f"{x},{y},{z},{angle}" for x, y, z, angle in (
    (0, 0, 1, 45), (1, 0, 0, 30), (1, 1, 0, 20), (1, 1, 1, 40), (1, 2, 3, 17), (3, 1, 2, 53), (2, -1, 1, 71), (-1, 3, 1, 89),
    (1, -2, 2, 107), (2, 3, -1, 131), (-3, 1, 4, 163))]

TRAY, TRAY_GENUS, TRAY_THICKNESS = "1002_tray_bottom.STL", 23, 3.0  # its median thickness, 0.6 % of the diagonal


# ---- making and judging ----


def can_choose(bench):
    """Whether the program can be told to keep no features."""
    return "--features " in Run([bench.program, "mesh", "--help"]).out


def make(bench, folder, solid, options, certificate="none"):
    """Facts of `laves mesh --json`, or None; the mesh is mesh.vtu in the folder."""
    json_path = os.path.join(folder, "mesh.json")
    run = Run([bench.program, "mesh", solid, *map(str, options), "--threads", "1", "--certificate", certificate, "-q",
               "--compress", "0", "-o", os.path.join(folder, "mesh.vtu"), "--json", json_path])
    facts = mesh_facts(run, json_path)
    if not facts:
        bench.say(f"  {os.path.basename(solid)} {' '.join(map(str, options))}: laves mesh ended with {run.code}: "
                  f"{last_sentence(run.err)}")
    return facts


def judge(bench, folder, solid, features=True):
    """Facts of `laves check --json` for mesh.vtu, or None."""
    json_path = os.path.join(folder, "check.json")
    run = Run([bench.program, "check", os.path.join(folder, "mesh.vtu"), "--surface", solid, "--threads", "1", "-q",
               "--list", "0", "--json", json_path, *(["--features"] if features else [])])
    facts = mesh_facts(run, json_path)
    if not facts:
        bench.say(f"  {os.path.basename(solid)}: laves check ended with {run.code}: {last_sentence(run.err)}")
    return facts


def boundary_vertices(facts):
    """By Euler's formula, for a closed boundary."""
    return facts["faces"] / 2 + 2 * (facts["boundary_components"] - facts["genus"])


def two_sided(facts):
    return max(facts["distance"]["to_surface_max"], facts["distance"]["from_surface_max"])


def within(low, high, window):
    return low is None or (low >= window[0] and high <= window[1])


def angles_text(low, high):
    return "-" if low is None else f"{low:.1f} .. {high:.1f}"


def percent(share, digits=3):
    return "-" if share is None or not math.isfinite(share) else f"{100 * share:.{digits}f}"


def verdict(met):
    return {True: "met", False: "missed", None: "-"}[met]


# ---- solids with creases ----


def improve_cost(facts):
    """CPU microseconds of improvement a boundary vertex; None of a mesh that is not there."""
    return 1e6 * facts["cpu_seconds"].get("improve", 0) / boundary_vertices(facts) if facts else None


def is_free(row):
    """Whether no angle and no detail of the input stands in the way of the narrower window."""
    return row["short"] == 0 and (row["sharpest"] is None or row["sharpest"] >= BLUNT)


def crease_row(name, tets, facts, cost, plain_cost):
    f = facts["features"]
    diagonal = f["diagonal"]
    row = {"part": "creases", "name": name, "wished": tets, "tets": facts["tets"], "valid": facts["valid"],
           "low": facts["min_dihedral"], "high": facts["max_dihedral"],
           "away_low": f["away_dihedral"][0], "away_high": f["away_dihedral"][1],
           "free_low": f["free_dihedral"][0], "free_high": f["free_dihedral"][1], "sharpest": f["sharpest"],
           "creases": f["creases"], "short": f["short_creases"], "creases_kept": f["creases_kept"],
           "to_mesh": f["to_mesh_max"] / diagonal if f["creases"] else None,
           "from_mesh": None if f["from_mesh_max"] is None else f["from_mesh_max"] / diagonal,
           "kept": f["kept_share"], "corners": f["corners"] - f["short_corners"], "corners_kept": f["corners_kept"], "spurious": f["spurious"],
           "straddling": f["straddling"], "distance": two_sided(facts) / diagonal, "cost": cost, "plain_cost": plain_cost}
    # All of these solids have creases: to find none is to keep none.
    row["creases_met"] = (f["creases"] > 0 and f["creases_kept"] + f["short_creases"] == f["creases"]
                          and row["to_mesh"] <= CREASE_DISTANCE
                          and row["from_mesh"] is not None and row["from_mesh"] <= CREASE_DISTANCE)
    row["corners_met"] = f["corners_kept"] == row["corners"] if row["corners"] else None if f["creases"] else False
    row["distance_met"] = row["distance"] <= SURFACE_DISTANCE
    row["window_met"] = within(row["low"], row["high"], WINDOW) if is_free(row) else None
    allowed = min(WIDE_WINDOW[0], row["sharpest"] or 180), WIDE_WINDOW[1]
    row["wide_met"] = within(row["low"], row["high"], allowed)
    row["cost_met"] = cost <= COST * plain_cost if cost and plain_cost else None
    return row


CREASE_HEADER = ["solid", "tets", "valid", "dihedral angles", "away from features", "creases to mesh, % diagonal", "mesh to creases",
                 "creases kept", "length kept, %", "corners kept", "spurious edges", "faces across", "distance, % diagonal",
                 "improvement, times", "creases, corners", "distance", "35 .. 130", "25 .. 140", "cost"]


def crease_cells(r):
    times = f"{r['cost'] / r['plain_cost']:.2f}" if r["cost"] and r["plain_cost"] else "-"
    return [r["name"], f"{r['tets']:,}", "yes" if r["valid"] else "NO", angles_text(r["low"], r["high"]),
            angles_text(r["away_low"], r["away_high"]), percent(r["to_mesh"]), percent(r["from_mesh"]),
            f"{r['creases_kept']} of {r['creases'] - r['short']}", percent(r["kept"], 1), f"{r['corners_kept']} of {r['corners']}",
            str(r["spurious"]), str(r["straddling"]), percent(r["distance"]), times,
            f"{verdict(r['creases_met'])}, {verdict(r['corners_met'])}", verdict(r["distance_met"]), verdict(r["window_met"]),
            verdict(r["wide_met"]), verdict(r["cost_met"])]


def crease_solids(bench, folder):
    """Name and path of each solid of the table; what is not there is named."""
    own = ["wedge_30", "drilled_plate"] if bench.options.quick else parts.PARTS
    for name in MODELS[:2] if bench.options.quick else MODELS:
        path = bench.model(name)
        if path:
            yield name, path
        else:
            bench.say(f"  {name}: NOT THERE, left out")
    for name in own:
        path = os.path.join(folder, name + ".obj")
        parts.PARTS[name]().write(path)
        yield name, path
    for name in SHAPES[:2] if bench.options.quick else SHAPES:
        yield name, os.path.join(os.path.dirname(os.path.abspath(__file__)), "shapes", name + ".lua")


def measure_creases(bench, folder, rows, notes):
    choice = can_choose(bench)
    if not choice:
        notes.append("`laves mesh` has no option --features here, so what features cost improvement was NOT measured.")
        bench.say("  " + notes[-1])
    bench.say(f"  {'solid':22} {'tets':>9} {'dihedral':>14} {'away':>14} {'to mesh %':>9} {'from %':>7} {'creases':>9} {'kept %':>6} "
              f"{'corners':>9} {'spur':>5} {'across':>6} {'dist %':>7} {'cost':>5}")
    for tets in TETS[:1] if bench.options.quick else TETS:
        for name, path in crease_solids(bench, folder):
            whole = os.path.join(folder, "made.json")
            plain = improve_cost(make(bench, folder, path, ["--tets", tets, "--features", "none"], whole)) if choice else None
            made = make(bench, folder, path, ["--tets", tets], whole)
            cost = improve_cost(made) if choice else None
            facts = judge(bench, folder, path) if made else None
            if not facts:
                rows.append({"part": "failed", "name": f"{name} at {tets:,} tets"})
                continue
            rows.append(crease_row(name, tets, facts, cost, plain))
            c = crease_cells(rows[-1])
            bench.say(f"  {c[0]:22} {c[1]:>9} {c[3]:>14} {c[4]:>14} {c[5]:>9} {c[6]:>7} {c[7]:>9} {c[8]:>6} {c[9]:>9} {c[10]:>5} "
                      f"{c[11]:>6} {c[12]:>7} {c[13]:>5}" + ("" if rows[-1]["valid"] else "  NOT VALID"))


# ---- smooth models ----


def measure_smooth(bench, folder, rows):
    for name in SMOOTH[-3:] if bench.options.quick else SMOOTH:
        path = bench.model(name)
        if not path:
            bench.say(f"  {name}: NOT THERE, left out")
            continue
        made = make(bench, folder, path, ["--tets", TETS[0]])
        facts = judge(bench, folder, path) if made else None
        if not facts:
            rows.append({"part": "failed", "name": f"{name} at {TETS[0]:,} tets"})
            continue
        distance = two_sided(facts) / facts["features"]["diagonal"]
        rows.append({"part": "smooth", "name": name, "tets": facts["tets"], "valid": facts["valid"], "distance": distance,
                     "low": facts["min_dihedral"], "high": facts["max_dihedral"], "outside": facts["outside_window"],
                     "met": distance <= SMOOTH_DISTANCE})
        r = rows[-1]
        bench.say(f"  {name:22} {r['tets']:9,} {angles_text(r['low'], r['high']):>14} distance {percent(distance)} % of the "
                  f"diagonal, {verdict(r['met'])}")


# ---- thin parts and gaps ----


def thin_solids(folder):
    """What, how thin, the solid, and its components, pieces of boundary and genus; sizes are 1."""
    for t in THICKNESSES:
        path = os.path.join(folder, f"plate_{t}.obj")
        parts.plate(t).write(path)
        yield "plate", t, path, (1, 1, 0)
    for t in THICKNESSES:
        yield "shell", t, f"sphere({SHELL_RADIUS}) - sphere({SHELL_RADIUS - t})", (1, 2, 0)
    for gap in GAPS:
        path = os.path.join(folder, f"gap_{gap}.obj")
        parts.plates_with_gap(gap).write(path)
        yield "gap", gap, path, (2, 2, 0)


def measure_thin(bench, folder, rows):
    turns = TURNS[:2] if bench.options.quick else TURNS
    certificate = os.path.join(folder, "thin.json")
    for what, sizes, solid, right in thin_solids(folder):
        made = [make(bench, folder, solid, ["--size", 1, *(["--align", turn] if turn else [])], certificate) for turn in turns]
        there = [m for m in made if m]
        good = sum((m["components"], m["boundary_components"], m["genus"]) == right and m["valid"] for m in there)
        low = min((m["min_dihedral"] for m in there), default=None)
        high = max((m["max_dihedral"] for m in there), default=None)
        windowed = len(there) == len(made) and within(low, high, WINDOW)
        rows.append({"part": "thin", "what": what, "sizes": sizes, "good": good, "of": len(made), "low": low, "high": high,
                     "tets": max((m["tets"] for m in there), default=0), "topology_met": good == len(made),
                     "window_met": windowed if sizes >= WINDOW_FROM and what != "gap" else None})
        r = rows[-1]
        bench.say(f"  {what:6} of {sizes:4g} sizes: {r['good']:2} of {r['of']} orientations with the right topology, worst angles "
                  f"{angles_text(low, high)}, {verdict(r['topology_met'])} {verdict(r['window_met'])}")


def measure_tray(bench, folder, rows):
    path = bench.model(TRAY)
    if not path:
        bench.say(f"  {TRAY}: NOT THERE, left out")
        return
    for times in (1.5,) if bench.options.quick else (1, 1.5):
        facts = make(bench, folder, path, ["--size", times * TRAY_THICKNESS], os.path.join(folder, "tray.json"))
        if not facts:
            rows.append({"part": "failed", "name": f"{TRAY} at {times:g} times its thickness"})
            continue
        met = facts["valid"] and facts["genus"] == TRAY_GENUS and facts["components"] == 1
        rows.append({"part": "tray", "times": times, "tets": facts["tets"], "genus": facts["genus"],
                     "components": facts["components"], "pieces": facts["boundary_components"], "low": facts["min_dihedral"],
                     "high": facts["max_dihedral"], "warnings": len(facts.get("warnings", [])), "met": met})
        r = rows[-1]
        bench.say(f"  {TRAY} at {times:g} times its thickness: {r['tets']:,} tets, genus {r['genus']} of {TRAY_GENUS}, "
                  f"{r['components']} parts, {angles_text(r['low'], r['high'])}, {verdict(met)}")


# ---- the section ----


def part_of(rows, part):
    return [r for r in rows if r["part"] == part]


def count_figure(name, rows, key, target="all"):
    """How many of the rows that say anything about a target meet it."""
    told = [r for r in rows if r[key] is not None]
    met = sum(r[key] for r in told)
    return figure(name, f"{met} of {len(told)}", target, met == len(told)) if told else None


def worst_figure(name, rows, key, target, scale=100, unit=" %"):
    worst = max((r for r in rows if r[key] is not None), key=lambda r: r[key], default=None)
    if worst is None:
        return None
    return figure(name, f"{scale * worst[key]:.3f}{unit} ({worst['name']}, {worst['tets']:,} tets)", f"<= {scale * target:g}{unit}",
                  worst[key] <= target)


def section_figures(rows):
    creases, smooth, thin, tray = (part_of(rows, p) for p in ("creases", "smooth", "thin", "tray"))
    free = [r for r in creases if is_free(r)]
    plates, gaps = [r for r in thin if r["what"] != "gap"], [r for r in thin if r["what"] == "gap"]
    failed = part_of(rows, "failed")
    figures = [
        count_figure("solids with all creases kept, within 0.1 % of the diagonal both ways", creases, "creases_met"),
        worst_figure("worst crease to the mesh's edges, share of the diagonal", creases, "to_mesh", CREASE_DISTANCE),
        worst_figure("worst sharp edge of the mesh to the creases", creases, "from_mesh", CREASE_DISTANCE),
        count_figure("solids with all corners kept", creases, "corners_met"),
        count_figure("solids with creases within 0.15 % of the diagonal of their surface, both ways", creases, "distance_met"),
        count_figure(f"those with every dihedral angle in {WINDOW[0]} .. {WINDOW[1]}, where no crease is below {BLUNT} degrees or "
                     "shorter than the edges", free, "window_met"),
        count_figure(f"those in {WIDE_WINDOW[0]} .. {WIDE_WINDOW[1]}, but for the input's own angles", creases, "wide_met"),
        count_figure(f"those where improvement costs at most {COST} times as much a boundary vertex as without features", creases,
                     "cost_met"),
        worst_figure(f"smooth models at {TETS[0]:,} tets, worst distance both ways", smooth, "distance", SMOOTH_DISTANCE),
        count_figure("smooth models that keep it", smooth, "met"),
        count_figure("thicknesses of plates and shells with the right topology in every orientation", plates, "topology_met"),
        count_figure(f"those from {WINDOW_FROM} sizes on with every angle in {WINDOW[0]} .. {WINDOW[1]}", plates, "window_met"),
        count_figure("gaps kept open in every orientation", gaps, "topology_met"),
        count_figure("tray at its thickness and at 1.5 times that: the input's topology", tray, "met"),
        count_figure("meshes valid", [{**r, "valid": bool(r["valid"])} for r in creases + smooth], "valid"),
        figure("meshes that failed", ", ".join(r["name"] for r in failed) or "none", "none", not failed),
    ]
    return [f for f in figures if f]


def measure_features(bench):
    rows, notes = [], []
    with tempfile.TemporaryDirectory() as folder:
        measure_creases(bench, folder, rows, notes)
        measure_smooth(bench, folder, rows)
        measure_thin(bench, folder, rows)
        measure_tray(bench, folder, rows)
    bench.keep("features", rows, section_figures(rows), notes)


# ---- drawing ----


def smooth_table(rows):
    return "### Smooth models\n\n" + table(
        ["input", "tets", "valid", "dihedral angles", "outside 40 .. 125", "distance, % diagonal", "<= 0.6 %"],
        [[r["name"], f"{r['tets']:,}", "yes" if r["valid"] else "NO", angles_text(r["low"], r["high"]), str(r["outside"]),
          percent(r["distance"]), verdict(r["met"])] for r in rows])


def thin_table(rows):
    return "### Thin parts and gaps\n\n" + table(
        ["solid", "sizes", "right topology, orientations", "worst angles", "most tets", "topology", "35 .. 130"],
        [[r["what"], f"{r['sizes']:g}", f"{r['good']} of {r['of']}", angles_text(r["low"], r["high"]), f"{r['tets']:,}",
          verdict(r["topology_met"]), verdict(r["window_met"])] for r in rows])


def tray_table(rows):
    return f"### {TRAY}, {TRAY_GENUS} handles\n\n" + table(
        ["size, thicknesses", "tets", "genus", "parts", "dihedral angles", "warnings", ""],
        [[f"{r['times']:g}", f"{r['tets']:,}", str(r["genus"]), str(r["components"]), angles_text(r["low"], r["high"]),
          str(r["warnings"]), verdict(r["met"])] for r in rows])


def features_tables(rows):
    """All tables of the section, from its rows."""
    drawn = [("creases", lambda r: "### Creases and corners\n\n" + table(CREASE_HEADER, [crease_cells(x) for x in r])),
             ("smooth", smooth_table), ("thin", thin_table), ("tray", tray_table)]
    return "\n\n".join(draw(part_of(rows, part)) for part, draw in drawn if part_of(rows, part))
