"""Section `graded` of bench/run: meshes whose size varies.

Five tables: the graded sphere of the paper's figure 12, interiors, whole models, thin parts, and peers with the same field.
Meshes are made by whole programs and judged from their files by laves-judge (bench/judge.c), all by the same code.
"""

import itertools
import json
import math
import os
import shutil
import tempfile

from common import Run, figure, last_sentence, mesh_facts, table

WINDOW = (35, 132)
FIT = (0.6, 1.5)
CUBE = "translate(box(1, 1, 1), 0.5, 0.5, 0.5)"  # from 0 to 1 along each axis

# Table 2 of the paper: what its graded sphere has.
PAPER_SPHERE = {"tets": 40178, "vertices": 8095, "seconds": 22}
PAPER_FIELD = "0.02 + 0.25*d"

# name, size field, its largest gradient, its smallest and largest value in the cube
INTERIORS = [
    ("ramp, gradient 0.1", "0.016 + 0.1*x", 0.1, 0.016, 0.116),
    ("ramp, gradient 0.2", "0.012 + 0.2*x", 0.2, 0.012, 0.212),
    ("ramp, gradient 0.5", "0.008 + 0.5*x", 0.5, 0.008, 0.508),
    ("distance to a sphere, 0.2", "0.016 + 0.2*abs(field(translate(sphere(0.3), 0.5, 0.5, 0.5)))", 0.2, 0.016, 0.13),
    ("distance to a sphere, 0.5", "0.012 + 0.5*abs(field(translate(sphere(0.3), 0.5, 0.5, 0.5)))", 0.5, 0.012, 0.3),
    ("point 1:64, 0.2", "min(0.064, 0.001 + 0.2*sqrt((x - 0.5)^2 + (y - 0.5)^2 + (z - 0.5)^2))", 0.2, 0.001, 0.064),
    ("point 1:64, 0.5", "min(0.064, 0.001 + 0.5*sqrt((x - 0.5)^2 + (y - 0.5)^2 + (z - 0.5)^2))", 0.5, 0.001, 0.064),
]

# Whole models, and what was found by hand to need the fewest tets at the distances of the uniform mesh: the size at the surface
# in sizes of that mesh, elements round a circle of the surface's curvature, and the growth inside.
WHOLE = {
    "sphere": (0.94, None, 0.6), "ellipsoid": (0.98, None, 0.9), "torus": (0.93, None, 0.5), "hand_closed.obj": (1.0, None, 0.9),
    "homer.obj": (1.0, None, 1.0), "spot.obj": (1.0, None, 0.9), "rocker-arm.obj": (1.0, None, 1.0),
    "fertility.off": (1.0, None, 1.0)}
SAME = 1.05  # a distance is the same when it is at most so many times the uniform mesh's

# file, its genus as MODELS.md of the models folder has it
THIN = [("1002_tray_bottom.STL", 23), ("plate_holes.STL", 5)]
THIN_TETS = 2000000

# Fields that all programs can be given: solid for laves, for Gmsh; field for both, and here; gradient; box of the solid.
PEERS = [
    {"name": "ramp in a cube", "solid": CUBE, "gmsh_solid": "Box(1) = {0, 0, 0, 1, 1, 1};", "field": "0.015 + 0.2*x",
     "size": lambda x, y, z: 0.015 + 0.2 * x, "grading": 0.2, "least": 0.015, "most": 0.215,
     "lower": 0, "upper": 1},
    {"name": "sphere, finer outwards", "solid": "sphere(1)", "gmsh_solid": "Sphere(1) = {0, 0, 0, 1};",
     "field": "0.035 + 0.25*(1 - sqrt(x*x + y*y + z*z))",
     "size": lambda x, y, z: max(0.02, 0.035 + 0.25 * (1 - math.sqrt(x * x + y * y + z * z))), "grading": 0.25, "least": 0.035,
     "most": 0.285, "lower": -1, "upper": 1},
]
TETGEN = "-pqm"  # its own default of quality, sizes from a background mesh
BACKGROUND_CELLS = 20  # along each side of that mesh


# ---- making and judging ----


def judge(bench, mesh, *more):
    """What laves-judge says of a mesh, or None."""
    run = Run([bench.judge_program, mesh, *more])
    if run.code != 0:
        bench.say(f"  laves-judge ended with {run.code}: {run.err.strip()}")
        return None
    return json.loads(run.out)


def made_by_laves(bench, folder, name, solid, options, *judging):
    """Facts of `laves mesh --json` and of laves-judge in one dictionary, and the process's times; None when it failed."""
    mesh, json_path = os.path.join(folder, "mesh.vtu"), os.path.join(folder, "mesh.json")
    run = Run([bench.program, "mesh", solid, *map(str, options), "--threads", "1", "--certificate", "none", "-q",
               "--compress", "0", "-o", mesh, "--json", json_path])
    facts = mesh_facts(run, json_path)
    judged = judge(bench, mesh, *judging) if facts else None
    if not judged:
        bench.say(f"  {name}: laves ended with {run.code}: {last_sentence(run.err)}")
        return None
    return {**facts, **judged, "wall": run.wall, "cpu": run.cpu}


def angles_of(part):
    return "-" if part["min"] is None else f"{part['min']:.1f} .. {part['max']:.1f}"


def worst_distance(facts, kind):
    return max(facts[f"to_surface_{kind}"], facts[f"from_surface_{kind}"])


def inside_window(part):
    return part["min"] is not None and part["min"] >= WINDOW[0] and part["max"] <= WINDOW[1]


def levels_text(levels):
    return " ".join(f"{v:.2f}" for v in levels)


# ---- the paper's sphere ----


def measure_sphere(bench, folder, rows):
    options = ["--size-field", PAPER_FIELD, "--tets", PAPER_SPHERE["tets"]]
    facts = made_by_laves(bench, folder, "sphere", "sphere(1)", options)
    if not facts:
        return
    rows.append({"part": "sphere", "name": "sphere(1), " + PAPER_FIELD + ", scaled", "tets": facts["tets"],
                 "vertices": facts["vertices"], "seconds": facts["cpu"], "valid": facts["valid"],
                 "angles": angles_of(facts["all"]), "outside": facts["all"]["outside"], "ratio_min": facts["radius_ratio_min"],
                 "ratio_mean": facts["radius_ratio_mean"], "histogram": facts["radius_ratio_histogram"]})
    for line in sphere_lines(rows[-1]):
        bench.say("  " + line)


def histogram_lines(counts):
    """A line of text for each bin from the first that holds anything; bars in proportion."""
    most, step = max(counts), 1 / len(counts)
    first = next(i for i, c in enumerate(counts) if c)
    return [f"{i * step:.2f} .. {(i + 1) * step:.2f} {c:7,} " + "#" * max(round(50 * c / most), 1 if c else 0)
            for i, c in enumerate(counts) if i >= first]


def sphere_lines(row):
    return [f"{row['name']}: {row['tets']:,} tets, {row['vertices']:,} vertices, {row['seconds']:.1f} CPU s",
            f"dihedral angles {row['angles']}, radius ratio min {row['ratio_min']:.3f} mean {row['ratio_mean']:.3f}",
            *histogram_lines(row["histogram"])]


# ---- interiors ----


def measure_interiors(bench, folder, rows):
    for name, field, gradient, least, most in INTERIORS[1:3] if bench.options.quick else INTERIORS:
        options = ["--size", most, "--min-size", least / 2, "--grading", gradient, "--size-field", field]
        facts = made_by_laves(bench, folder, name, CUBE, options, "--size", field)
        if not facts:
            continue
        inner, sizes = facts["inner"], facts["inner_edges"]
        rows.append({"part": "interior", "name": name, "tets": facts["tets"], "inner_tets": inner["tets"],
                     "valid": facts["valid"], "rate": facts["tets"] / facts["cpu_seconds"]["background"],
                     "angles": angles_of(inner), "kept": inside_window(inner), "exact": facts["exact_tets"] / facts["tets"],
                     "bcc": facts["bcc_tets"] / facts["tets"], "levels": sizes["levels"], "cpu": facts["cpu"]})
        r = rows[-1]
        bench.say(f"  {name:28} {r['tets']:9,} {r['rate'] / 1e3:7.0f} k/s {r['angles']:>16}  C15 {100 * r['exact']:4.1f} % BCC "
                  f"{100 * r['bcc']:4.1f} %  {levels_text(r['levels'])}")


# ---- whole models ----


def whole_row(name, what, facts, uniform):
    return {"part": "whole", "name": name, "what": what, "tets": facts["tets"], "faces": facts["faces"],
            "share": facts["tets"] / uniform["tets"], "valid": facts["valid"], "angles": angles_of(facts["all"]),
            "outside": facts["all"]["outside"], "smooth": facts["outside_smooth"],
            "mean": worst_distance(facts, "mean"), "max": worst_distance(facts, "max"),
            "mean_times": worst_distance(facts, "mean") / worst_distance(uniform, "mean"),
            "max_times": worst_distance(facts, "max") / worst_distance(uniform, "max"), "cpu": facts["cpu"]}


def whole_recipes(name, size):
    """What a graded mesh is called, and its options."""
    times, circle, growth = WHOLE[name]
    yield "growth 0.5", ["--size", size, "--interior-growth", 0.5, "--grading", 0.5]
    around = ["--curvature-elements", circle] if circle else []
    words = f"{times:g} sizes" + (f", {circle:g} round a circle" if circle else "") + f", growth {growth:g}"
    yield words, ["--size", times * size, *around, "--interior-growth", growth, "--grading", growth]


def measure_whole(bench, folder, rows):
    bench.say(f"  {'input':16} {'':43} {'tets':>8} {'share':>6} {'angles':>15} {'out':>4} {'mean':>9} {'times':>5} {'max':>9} "
              f"{'times':>5}")
    for name in ["sphere", "spot.obj"] if bench.options.quick else WHOLE:
        path = bench.model(name)
        if not path:
            bench.say(f"  {name}: not there, left out")
            continue
        uniform = made_by_laves(bench, folder, name, path, ["--tets", 500000], "--surface", path)
        if not uniform:
            continue
        made = [whole_row(name, "uniform", uniform, uniform)]
        for what, options in whole_recipes(name, uniform["size"]):
            facts = made_by_laves(bench, folder, name, path, options, "--surface", path)
            if facts:
                made.append(whole_row(name, what, facts, uniform))
        for r in made:
            bench.say(f"  {name:16} {r['what']:43} {r['tets']:8,} {100 * r['share']:4.0f} % {r['angles']:>15} {r['outside']:4} "
                      f"{r['mean']:9.2e} {r['mean_times']:5.2f} {r['max']:9.2e} {r['max_times']:5.2f}  {r['cpu']:.1f} s")
        rows += made


# ---- thin parts ----


def measure_thin(bench, folder, rows):
    for name, genus in THIN:
        path = bench.model(name)
        if not path:
            bench.say(f"  {name}: not there, left out")
            continue
        facts = made_by_laves(bench, folder, name, path, ["--thickness-elements", 2], "--surface", path)
        if not facts:
            continue
        rows.append({"part": "thin", "name": name, "tets": facts["tets"], "genus": facts["genus"], "right_genus": genus,
                     "components": facts["components"], "valid": facts["valid"], "angles": angles_of(facts["all"]),
                     "outside": facts["all"]["outside"], "mean": worst_distance(facts, "mean"),
                     "max": worst_distance(facts, "max"), "volume": facts["volume"] / facts["domain_volume"],
                     "cpu": facts["cpu"]})
        r = rows[-1]
        bench.say(f"  {name:22} {r['tets']:9,} genus {r['genus']} of {genus}, {r['components']} part, {r['angles']}, "
                  f"{r['outside']} outside, distance {r['mean']:.2e} mean {r['max']:.2e} max, {100 * r['volume']:.2f} % of the "
                  f"volume, {r['cpu']:.1f} s")


# ---- peers ----

GMSH_SCRIPT = """SetFactory("OpenCASCADE");
%s
Field[1] = MathEval;
Field[1].F = "%s";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
"""


def write_background(stem, peer):
    """A background mesh for TetGen: a grid of cubes, each in six tets, with a size at each corner, larger than the solid."""
    count, room = BACKGROUND_CELLS, 0.05
    low, step = peer["lower"] - room, (peer["upper"] - peer["lower"] + 2 * room) / BACKGROUND_CELLS
    side = count + 1
    points = [tuple(low + step * i for i in at) for at in itertools.product(range(side), repeat=3)]
    tets = []
    for corner in itertools.product(range(count), repeat=3):
        for order in itertools.permutations(range(3)):
            at, tet = list(corner), []
            for axis in (None, *order):
                if axis is not None:
                    at[axis] += 1
                tet.append((at[0] * side + at[1]) * side + at[2])
            tets.append(tet)
    texts = {".b.node": (f"{len(points)} 3 0 0", [(i, *p) for i, p in enumerate(points)]),
             ".b.ele": (f"{len(tets)} 4 0", [(i, *t) for i, t in enumerate(tets)]),
             ".b.mtr": (f"{len(points)} 1", [(peer["size"](*p),) for p in points])}
    for ending, (head, lines) in texts.items():
        with open(stem + ending, "w") as file:
            file.write(head + "\n" + "".join(" ".join(map(repr, line)) + "\n" for line in lines))


def write_smesh(source, target):
    """The triangles of a Medit file as TetGen's .smesh, the one form beside which it looks for a background mesh."""
    with open(source) as file:
        words = file.read().split()
    def block(name):
        first = words.index(name) + 1
        return [words[first + 1 + 4 * i:first + 4 + 4 * i] for i in range(int(words[first]))]
    points, triangles = block("Vertices"), block("Triangles")
    with open(target, "w") as file:
        file.write(f"{len(points)} 3 0 0\n" + "".join(f"{i + 1} {' '.join(p)}\n" for i, p in enumerate(points)))
        file.write(f"{len(triangles)} 0\n" + "".join(f"3 {' '.join(t)}\n" for t in triangles) + "0\n0\n")


def run_gmsh(folder, peer):
    """Its run and mesh."""
    script, mesh = os.path.join(folder, "peer.geo"), os.path.join(folder, "gmsh.msh")
    with open(script, "w") as file:
        file.write(GMSH_SCRIPT % (peer["gmsh_solid"], peer["field"]))
    return Run(["gmsh", "-3", script, "-o", mesh, "-format", "msh41", "-bin", "-nt", "1", "-v", "1"], folder), mesh


def run_tetgen(folder, peer):
    """Its run and mesh; the surface is triangulated by Gmsh for the same field, which is not in its time."""
    surface, mesh = os.path.join(folder, "surface.mesh"), os.path.join(folder, "peer.1.ele")
    Run(["gmsh", "-2", os.path.join(folder, "peer.geo"), "-o", surface, "-nt", "1", "-v", "1"], folder)
    write_smesh(surface, os.path.join(folder, "peer.smesh"))
    write_background(os.path.join(folder, "peer"), peer)
    return Run(["tetgen", TETGEN, "peer.smesh"], folder), mesh


def peer_row(peer, program, facts, cpu):
    edges = facts["edges"]
    return {"part": "peers", "name": peer["name"], "program": program, "tets": facts["tets"], "cpu": cpu,
            "valid": facts["valid"], "angles": angles_of(facts["all"]), "outside": facts["all"]["outside"],
            "ratio_mean": facts["radius_ratio_mean"], "levels": edges["levels"], "fit": edges["fit"]}


def compare_peers(bench, folder, rows, notes):
    missing = [program for program in ("gmsh", "tetgen") if not shutil.which(program)]
    if missing:
        notes.append(f"Not installed, so left out: {', '.join(missing)}" + (
            " (TetGen needs Gmsh for its surface)." if "gmsh" in missing else "."))
        bench.say("  " + notes[-1])
    for peer in PEERS[:1] if bench.options.quick else PEERS:
        judging, made = ["--size", peer["field"]], []
        facts = made_by_laves(bench, folder, peer["name"], peer["solid"], [
            "--size", peer["most"], "--min-size", peer["least"] / 2, "--grading", peer["grading"], "--size-field", peer["field"]],
            *judging)
        if facts:
            made.append(peer_row(peer, "laves", facts, facts["cpu"]))
        for program, call in (("Gmsh", run_gmsh), ("TetGen", run_tetgen)):
            if "gmsh" in missing or program.lower() in missing:
                continue
            run, mesh = call(folder, peer)
            facts = judge(bench, mesh, *judging) if run.code == 0 else None
            if facts:
                made.append(peer_row(peer, program, facts, run.cpu))
            else:
                notes.append(f"{program} failed on {peer['name']}.")
        for r in made:
            bench.say(f"  {r['name']:24} {r['program']:8} {r['tets']:9,} {r['cpu']:6.2f} s {r['angles']:>16} {r['outside']:7,} "
                      f"outside  {levels_text(r['levels'])}  {100 * r['fit']:.1f} % fit")
        rows += made


# ---- the section ----


def part_of(rows, part):
    return [r for r in rows if r["part"] == part]


def interior_figures(rows):
    if not rows:
        return []
    slowest = min(r["rate"] for r in rows)
    widest = (min(r["levels"][1] for r in rows), max(r["levels"][3] for r in rows))
    fit = [r for r in rows if r["levels"][1] >= FIT[0] and r["levels"][3] <= FIT[1]]
    kept = [r for r in rows if r["kept"]]
    return [
        figure(f"interiors with every dihedral angle in {WINDOW[0]} .. {WINDOW[1]} degrees", f"{len(kept)} of {len(rows)}", "all",
               len(kept) == len(rows)),
        figure("slowest graded background, tets per CPU second", f"{slowest / 1e3:,.0f} thousand", ">= 200 thousand",
               slowest >= 2e5),
        figure("edge length over wished size there, 5 to 95 %, of all interiors", f"{widest[0]:.2f} .. {widest[1]:.2f}",
               f"{FIT[0]} .. {FIT[1]}", len(fit) == len(rows))]


def least_shares(rows, kinds):
    """For each input the least share of tets among the graded meshes whose distances are those of the uniform one."""
    names = list(dict.fromkeys(r["name"] for r in rows))
    same = [r for r in rows if all(r[kind] <= SAME for kind in kinds)]
    return {name: min((r["share"] for r in same if r["name"] == name), default=None) for name in names}


def shares_text(shares):
    return ", ".join(f"{name} {'none' if share is None else f'{100 * share:.0f} %'}" for name, share in shares.items())


def whole_figures(rows):
    graded = [r for r in rows if r["what"] != "uniform"]
    if not graded:
        return []
    both, mean = least_shares(graded, ["mean_times", "max_times"]), least_shares(graded, ["mean_times"])
    outside, smooth = sum(r["outside"] for r in graded), int(sum(r["smooth"] for r in graded))
    return [
        figure(f"whole models, tets outside {WINDOW[0]} .. {WINDOW[1]} degrees where the surface is smooth", str(smooth), "0",
               smooth == 0),
        figure("the same anywhere", f"{outside:,} of {sum(r['tets'] for r in graded):,}", "", None),
        figure(f"least share of the uniform mesh's tets at its mean and largest distance (to {100 * (SAME - 1):.0f} %)",
               shares_text(both), "<= 33 %", all(share is not None and share <= 1 / 3 for share in both.values())),
        figure("the same at its mean distance", shares_text(mean), "", None)]


def thin_figures(rows):
    if not rows:
        return []
    right = [r for r in rows if r["valid"] and r["genus"] == r["right_genus"] and r["components"] == 1 and r["tets"] <= THIN_TETS]
    return [figure("thin parts with two elements across: valid, of the right genus, at most 2 million tets",
                   f"{len(right)} of {len(rows)}", "all", len(right) == len(rows))]


def measure_graded(bench):
    rows, notes = [], []
    with tempfile.TemporaryDirectory() as folder:
        measure_sphere(bench, folder, rows)
        measure_interiors(bench, folder, rows)
        measure_whole(bench, folder, rows)
        measure_thin(bench, folder, rows)
        compare_peers(bench, folder, rows, notes)
    ours = [r for r in rows if r.get("program", "laves") == "laves"]
    if not ours:
        return
    valid = sum(r["valid"] for r in ours)
    bench.keep("graded", rows, [
        *interior_figures(part_of(rows, "interior")), *whole_figures(part_of(rows, "whole")),
        *thin_figures(part_of(rows, "thin")),
        figure("graded meshes valid", f"{valid} of {len(ours)}", "all", valid == len(ours))], notes)


# ---- drawing ----


def sphere_table(rows):
    row = rows[0]
    return "\n\n".join([
        "### The paper's graded sphere",
        f"The paper shows a graded sphere, finer towards its boundary, in figure 12, and the histogram of its normalised radius "
        f"ratios, of which the text gives no numbers; table 2 gives {PAPER_SPHERE['tets']:,} tets, {PAPER_SPHERE['vertices']:,} "
        f"vertices and {PAPER_SPHERE['seconds']} s on a Pentium IV. Here, `{row['name'].replace(', scaled', '')}` scaled to as "
        "many tets:",
        table(["tets", "vertices", "CPU s", "dihedral angles", "radius ratio, min", "mean"],
              [[f"{row['tets']:,}", f"{row['vertices']:,}", f"{row['seconds']:.1f}", row["angles"], f"{row['ratio_min']:.3f}",
                f"{row['ratio_mean']:.3f}"]]),
        "```\n" + "\n".join(histogram_lines(row["histogram"])) + "\n```"])


def interior_table(rows):
    return "### Interiors\n\n" + table(
        ["field in a cube", "tets", "background, thousand tets per CPU s", "dihedral angles, interior", "exact C15", "exact BCC",
         "edge over size, 1 5 50 95 99 %"],
        [[r["name"], f"{r['tets']:,}", f"{r['rate'] / 1e3:,.0f}", r["angles"], f"{100 * r['exact']:.1f} %",
          f"{100 * r['bcc']:.1f} %", levels_text(r["levels"])] for r in rows])


def whole_table(rows):
    return "### Whole models\n\n" + table(
        ["input", "mesh", "tets", "of uniform", "boundary triangles", "dihedral angles", "outside", "mean distance, of uniform",
         "largest, of uniform", "CPU s"],
        [[r["name"], r["what"], f"{r['tets']:,}", f"{100 * r['share']:.0f} %", f"{r['faces']:,}", r["angles"],
          f"{r['outside']:,}",
          f"{r['mean_times']:.2f}", f"{r['max_times']:.2f}", f"{r['cpu']:.1f}"] for r in rows])


def thin_table(rows):
    return "### Thin parts, two elements across\n\nDistances in units of the file.\n\n" + table(
        ["file", "tets", "genus", "of the input", "parts", "dihedral angles", "outside", "mean distance", "largest", "volume",
         "CPU s"],
        [[r["name"], f"{r['tets']:,}", str(r["genus"]), str(r["right_genus"]), str(r["components"]), r["angles"],
          f"{r['outside']:,}", f"{r['mean']:.3g}", f"{r['max']:.3g}", f"{100 * r['volume']:.2f} %",
          f"{r['cpu']:.1f}"] for r in rows])


def peers_table(rows):
    return "### With the same field\n\n" + table(
        ["field", "program", "tets", "CPU s", "dihedral angles", "outside", "mean radius ratio", "edge over size, 1 5 50 95 99 %",
         f"edges within {FIT[0]} .. {FIT[1]}"],
        [[r["name"], r["program"], f"{r['tets']:,}", f"{r['cpu']:.2f}", r["angles"], f"{r['outside']:,}",
          f"{r['ratio_mean']:.3f}", levels_text(r["levels"]), f"{100 * r['fit']:.1f} %"] for r in rows])


def graded_tables(rows):
    """All tables of the section, from its rows."""
    drawn = [("sphere", sphere_table), ("interior", interior_table), ("whole", whole_table), ("thin", thin_table),
             ("peers", peers_table)]
    return "\n\n".join(draw(part_of(rows, part)) for part, draw in drawn if part_of(rows, part))
