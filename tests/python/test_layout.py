"""The binding and the library agree: structures, functions, and the vocabulary of solids. What the binding lacks is listed."""
import ctypes
import inspect
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import support
from support import ROOT

import laves
from laves import _header, solids

# Functions of laves.h that no Python code calls, and why that is well.
LACKING = {
    "laves_domain_from_file": "the form with options does the same",
    "laves_domain_from_triangles": "the form with options does the same",
    "laves_result_name": "results are classes of exceptions",
    "laves_defect_text": "kinds have their names of laves.h; phrases are for programs that print",
    "laves_exception_key": "the same as the name in lower case (test_keys_are_names)",
    "laves_exception_text": "as laves_defect_text",
    "laves_cause_key": "as laves_exception_key",
    "laves_cause_text": "as laves_defect_text",
    "laves_feature_fault_key": "as laves_exception_key",
    "laves_feature_fault_text": "as laves_defect_text",
    "laves_format_is_quadratic": "writing refuses the others with the library's sentence",
    "laves_format_from_name": "formats are told by the enum's names (test_format_names)",
}

# Of the library's vocabulary: Lua's own names, which Python has itself.
LUA = {"assert", "error", "ipairs", "math", "pairs", "select", "string", "table", "tonumber", "tostring", "type"}


def structures():
    return {name: kind for name, kind in vars(_header).items()
            if inspect.isclass(kind) and issubclass(kind, ctypes.Structure) and kind is not ctypes.Structure}


def ask_lua(expression):
    """The text of an error that an expression raises on purpose."""
    try:
        laves.Domain(expression)
    except laves.InputError as e:
        return str(e)
    raise AssertionError("no error")


def vocabulary():
    """The names that scripts see, in pieces that fit into the library's messages."""
    names, piece = [], 20
    while True:
        text = ask_lua("(function() local n = {} for k in pairs(_ENV) do n[#n + 1] = k end "
                       f"error('<' .. table.concat(n, ' ', {len(names) + 1}, math.ult({len(names) + piece}, #n) and {len(names) + piece} or #n)"
                       " .. '>' .. #n) end)()")
        found, count = re.search(r"<(.*)>(\d+)", text).groups()
        names += found.split()
        if len(names) >= int(count):
            return set(names)


class Layout(unittest.TestCase):
    def test_structures_are_the_compilers(self):
        """A C program tells size and place of all members."""
        with tempfile.TemporaryDirectory() as folder:
            source, binary = pathlib.Path(folder, "layout.c"), pathlib.Path(folder, "layout")
            source.write_bytes(subprocess.check_output([sys.executable, ROOT / "tools" / "make_python_header.py", "--layout"]))
            subprocess.check_call([os.environ.get("CC", "cc"), f"-I{ROOT / 'include'}", f"-I{os.environ['LAVES_BUILD']}/include", source, "-o",
                                   binary])
            told = subprocess.check_output([binary], text=True).split("\n")
        sizes = {}
        for name, structure in structures().items():
            sizes[name] = [ctypes.sizeof(structure)]
            for member, *_ in structure._fields_:
                place = getattr(structure, member)
                sizes[f"{name}.{member}"] = [place.offset, place.size]
        compiled = {line.split()[0]: [int(n) for n in line.split()[1:]] for line in told if line}
        sizes = {name: size for name, size in sizes.items() if not name.startswith("laves_report_stages")}
        self.assertGreater(len(compiled), 300)
        self.assertEqual(sizes, compiled)

    def test_what_is_lacking(self):
        text = "".join(p.read_text() for p in (ROOT / "python" / "laves").glob("*.py") if p.name != "_header.py")
        called = set(re.findall(r"\b_?lib\.(laves_\w+)", text))
        self.assertEqual(called - set(_header.FUNCTIONS), set())
        missing = set(_header.FUNCTIONS) - called
        self.assertEqual(missing - set(LACKING), set(), "not in the binding: call them, or say in LACKING why not")
        self.assertEqual(set(LACKING) - missing, set(), "in the binding by now")

    def test_version_is_the_headers(self):
        self.assertEqual(laves.__version__, (ROOT / "VERSION").read_text().strip())

    def test_keys_are_names(self):
        for enum, key in (("laves_exception_kind", "laves_exception_key"), ("laves_cause", "laves_cause_key"),
                          ("laves_feature_fault", "laves_feature_fault_key")):
            for number, name in enumerate(_header.ENUMS[enum]):
                self.assertEqual(getattr(laves._lib, key)(number).decode(), name.lower())

    def test_format_names(self):
        for number, name in enumerate(_header.ENUMS["laves_format"]):
            if name != "AUTO":
                self.assertEqual(laves._lib.laves_format_name(number).decode(), name.lower())

    def test_an_exception_for_each_result(self):
        results = [name for name in _header.ENUMS["laves_result"] if name.startswith("ERROR")]
        self.assertEqual(sorted(laves.errors._CLASSES), sorted(results))
        for cls in laves.errors._CLASSES.values():
            self.assertTrue(issubclass(cls, laves.Error))
            self.assertEqual(cls("text").exit_code, laves._lib.laves_result_exit_code(_header.CONSTANTS["LAVES_" + cls.result]))


class Vocabulary(unittest.TestCase):
    def test_names_are_those_of_scripts(self):
        ours = {name for name in vars(solids) if not name.startswith("_") and name != "Expression"}
        self.assertEqual(ours - {"d"}, vocabulary() - LUA)
        self.assertIn("sphere", ours)

    def test_parameters_are_those_of_scripts(self):
        """A table with an unknown name makes the library list those that it knows."""
        for name in ("sphere", "ellipsoid", "box", "rounded_box", "cylinder", "capsule", "cone", "torus", "gyroid", "schwarz_p", "schwarz_d",
                     "neovius", "iwp", "frd", "lidinoid", "fischer_koch_s"):
            known = re.search(r"it knows (.*)", ask_lua(name + "{unheard_of=1}"))[1]
            wanted = re.findall(r"\w+", known.replace(" and ", " "))
            self.assertEqual(list(inspect.signature(getattr(solids, name)).parameters), wanted, name)
        for name, first in (("rotate", ""), ("shell", ""), ("repeat_polar", ""), ("offset", "")):
            known = re.search(r"it knows (.*)", ask_lua(f"{name}(sphere(1), {{unheard_of=1}})"))[1]
            wanted = re.findall(r"\w+", known.replace(" and ", " "))
            self.assertEqual(list(inspect.signature(getattr(solids, name)).parameters)[1:], wanted, name)

    def test_everything_can_be_made(self):
        s = solids
        ball, field = s.sphere(1), s.x ** 2 + s.y ** 2 + s.z ** 2 - 1
        made = [s.ellipsoid(1, 2, 3), s.box(1), s.box(1, 2), s.box(1, z=3), s.rounded_box(1, 1, 1, r=0.2), s.cylinder(1, h=2),
                s.capsule(1, 2), s.cone(1, 2), s.cone(r=1, h=2, r2=0.5), s.torus(2, r=0.5), s.halfspace("x", 0.2) & ball,
                s.plane((1, 1, 1)) & ball, s.halfspace() & ball, s.plane(offset=0.1) & ball,
                s.metaballs(support.np.array([[0, 0, 0, 1], [1, 0, 0, 0.5]]), sharpness=2), s.union(ball, s.box(1)),
                s.union([ball, s.box(1)]), s.intersection(ball, s.box(1)), s.difference(ball, s.box(1)),
                s.smooth_union(ball, s.box(1.8), 0.2), s.smooth_intersection(ball, s.box(1.8), 0.2),
                ball.smooth_difference(s.box(1), 0.1), s.complement(~ball), s.morph(ball, s.box(1), 0.5), ball.offset(0.5),
                ball.offset(distance=-0.5), ball.shell(0.2), ball.bounds((-1, -1, 0), (1, 1, 1)), ball.move(1, 2, 3),
                ball.move((1, 2, 3)), ball.translate(by="z"), ball.move(support.np.ones(3)), s.box(1).rotate(30),
                s.box(1).rotate(30, axis=(1, 1, 0)), ball.scale(2), ball.scale(1, 2, 3), ball.mirror("x"),
                ball.mirror(normal=(1, 0, 0)), ball.repeat_linear((1, 0, 0), 3),
                ball.repeat_grid(step=(1, 1, 1), count=(2, 2, 1)), ball.move(2, 0, 0).repeat_polar(4),
                ball.move(0, 2, 0).repeat_polar(4, axis="x", angle=180),
                s.bounds(ball.warp(s.x, s.y * 2, s.z), (-2, -2, -2), (2, 2, 2)),
                ball.keep(points=[[0, 0, 1]], lines=[[[1, 0, 0], [0, 0, 1]]]), s.tag("a", ball), ball.region("b"),
                s.surface(ROOT / "demo" / "knot.ply"), field, s.solid(field), s.max(field, s.min(s.x, s.y, s.z, 5)),
                s.sqrt(s.x ** 2 + s.y ** 2 + s.z ** 2) - 1, s.length(s.x, s.y, s.z) - 1, abs(s.x) + s.abs(s.y) + abs(s.z) - 1,
                s.pow(s.x, 4) + s.y ** 4 + s.z ** 4 - 1, s.field(ball) - 0.5,
                s.bounds(s.sin(4 * s.x) + s.cos(4 * s.y) + 0 * s.tan(s.z / 4) - 0.5, (-1, -1, -1), (1, 1, 1)),
                s.bounds(s.exp(s.x) - s.log(s.y + 4) + s.atan2(s.z, 2) + s.asin(s.x / 4) - s.acos(s.y / 4), (-1, -1, -1), (1, 1, 1)),
                s.bounds(s.floor(s.x * 2) + s.ceil(s.y) + s.mod(s.z, 0.5) + s.z % 0.3, (-1, -1, -1), (1, 1, 1))]
        made += [getattr(s, name)(period=0.8, thickness=0.1) & ball
                 for name in ("gyroid", "schwarz_p", "schwarz_d", "neovius", "iwp", "frd", "lidinoid", "fischer_koch_s")]
        made += [s.gyroid(0.8, level=0.1) & ball]
        for solid in made:
            with self.subTest(str(solid)):
                self.assertEqual(laves.info(solid).kind, "implicit")

    def test_operators_mean_what_python_means(self):
        """Values of fields, in every order of operators, are those that Python computes."""
        x, y, z = solids.x, solids.y, solids.z
        p = support.np.random.default_rng(1).uniform(0.5, 0.9, (50, 3))
        px, py, pz = p.T
        for ours, right in ((x - y - z, px - py - pz), (x - (y - z), px - (py - pz)), (x / y / z, px / py / pz), (x / (y * z), px / (py * pz)),
                            (x ** y ** z, px ** py ** pz), ((x ** y) ** z, (px ** py) ** pz), (-x ** 2, -px ** 2), ((-x) ** 2, (-px) ** 2),
                            (2 - x, 2 - px), (2 / x, 2 / px), (2 ** x, 2 ** px), (2 * -x, 2 * -px), (x - -2, px + 2),
                            (x * (y + z) - 1, px * (py + pz) - 1),
                            (5 % x, 5 % px), (x % 0.3, px % 0.3), (1e-300 + x, px), (support.np.float64(2) * x, 2 * px), (-(x + y), -(px + py))):
            level = float(support.np.median(right)) + 1e-9
            domain = laves.Domain(solids.bounds(ours - level, (0, 0, 0), (1, 1, 1)))
            self.assertTrue(((domain.evaluate(p) < 0) == (right < level)).all(), str(ours))

    def test_what_is_shared_is_written_once(self):
        part = solids.sphere(1)
        for i in range(40):  # 2^40 balls if it were written out
            part = part.move(0.01, 0, 0) | part.rotate(1, "x")
        self.assertLess(len(str(part)), 5000)
        self.assertIn("s[1]", str(part))

    def test_deep_trees(self):
        chain = solids.sphere(0.6)
        for i in range(1, 600):
            chain = solids.union(chain, solids.sphere(0.6).move(0.5 * i, 0, 0))
        self.assertAlmostEqual(laves.info(chain).upper[0], 0.5 * 599 + 0.6, places=6)
        long_sum = solids.sphere(0.6)
        for i in range(1, 600):
            long_sum = long_sum + solids.sphere(0.6).move(0.5 * i, 0, 0)
        self.assertAlmostEqual(laves.info(long_sum).upper[0], 0.5 * 599 + 0.6, places=6)

    def test_what_has_no_place(self):
        for wrong in (lambda: solids.sphere(True), lambda: solids.sphere(None), lambda: solids.sphere(object()), lambda: solids.sphere(1) + "a",
                      lambda: solids.sphere(1) and solids.sphere(2), lambda: solids.sphere(1) + True):
            self.assertRaises(TypeError, wrong)
        self.assertRaises(ValueError, lambda: solids.sphere(float("nan")))

    def test_wrong_parameters_are_told_by_the_library(self):
        with self.assertRaisesRegex(laves.InputError, "sphere: r must be a positive number"):
            laves.info(solids.sphere(-1))


if __name__ == "__main__":
    support.main()
