"""Solids and fields out of Python: the vocabulary of docs/implicit.md, with the same names, parameters and operators.

    from laves.solids import cylinder, sphere
    part = sphere(1) - cylinder(r=0.4).rotate(90, "x")
    mesh = laves.mesh(part, size=0.1)

Everything here only writes down what shall be: str(part) is the expression in Lua, which the library reads, so both mean the same to
the last bit, and what is wrong is told when it is meshed. Lengths are in the units of the mesh; angles in degrees, but for sin, cos and
their like. A vector is three numbers in a sequence or array, or "x", "y", "z".

Operators: + and | unite solids, * and & intersect, - subtracts, ~ is the outside. Between fields, and fields and numbers, + - * / % and
** are arithmetic (** is Lua's ^). Functions whose first parameter is a solid are methods as well: sphere(1).move(0, 0, 1)."""
import math as _math
import os as _os

from ._expression import Expression, call as _call

# ---- fields ----

x = Expression(["x"])
y = Expression(["y"])
z = Expression(["z"])
#: The depth below the surface; in sizes only (laves.Sizing.expression).
d = Expression(["d"])
pi = _math.pi


def abs(a):  # noqa: A001 (the names are those of the vocabulary)
    """The absolute value."""
    return _call("abs", [a])


def sqrt(a) -> Expression:
    """The square root; that of zero for what is negative."""
    return _call("sqrt", [a])


def sin(a) -> Expression:
    """The sine of radians."""
    return _call("sin", [a])


def cos(a) -> Expression:
    """The cosine of radians."""
    return _call("cos", [a])


def tan(a) -> Expression:
    """The tangent of radians."""
    return _call("tan", [a])


def asin(a) -> Expression:
    """The arc sine, radians."""
    return _call("asin", [a])


def acos(a) -> Expression:
    """The arc cosine, radians."""
    return _call("acos", [a])


def atan2(a, b) -> Expression:
    """The angle of (b, a), radians."""
    return _call("atan2", [a, b])


def exp(a) -> Expression:
    """e to the power of a."""
    return _call("exp", [a])


def log(a) -> Expression:
    """The natural logarithm; that of the least number above zero for what is not positive."""
    return _call("log", [a])


def pow(a, b):  # noqa: A001
    """a to the power of b, as a ** b; with b not whole a negative a counts as zero."""
    return _call("pow", [a, b])


def floor(a) -> Expression:
    """The largest whole number that is not above a."""
    return _call("floor", [a])


def ceil(a) -> Expression:
    """The least whole number that is not below a."""
    return _call("ceil", [a])


def mod(a, b) -> Expression:
    """The remainder, as a % b."""
    return _call("mod", [a, b])


def min(*values):  # noqa: A001
    """The least of fields and numbers."""
    return _call("min", values)


def max(*values):  # noqa: A001
    """The largest of fields and numbers."""
    return _call("max", values)


def length(*values) -> Expression:
    """The root of the sum of the squares of up to three."""
    return _call("length", values)


def field(solid) -> Expression:
    """The values of a solid, as a field to compute with."""
    return _call("field", [solid])


def solid(field) -> Expression:
    """The solid where a field is negative."""
    return _call("solid", [field])


# ---- primitives ----


def sphere(r) -> Expression:
    """A ball of radius r."""
    return _call("sphere", [r])


def ellipsoid(a, b, c) -> Expression:
    """An ellipsoid with half axes along x, y, z."""
    return _call("ellipsoid", [a, b, c])


def box(x, y=None, z=None) -> Expression:
    """A box of full widths; y and z default to x."""
    return _call("box", [x] if y is None and z is None else [], {} if y is None and z is None else {"x": x, "y": y, "z": z})


def rounded_box(x, y, z, r) -> Expression:
    """A box of full widths with edges and corners of radius r."""
    return _call("rounded_box", [x, y, z, r])


def cylinder(r, h=None) -> Expression:
    """A cylinder along z of radius r and full height h; endless if missing."""
    return _call("cylinder", [], {"r": r, "h": h})


def capsule(r, h) -> Expression:
    """A capsule along z of radius r, its straight part h long."""
    return _call("capsule", [], {"r": r, "h": h})


def cone(r, h, r2=None) -> Expression:
    """A cone along z: radius r at the bottom, full height h, radius r2 (0) at the top."""
    return _call("cone", [], {"r": r, "h": h, "r2": r2})


def torus(R, r) -> Expression:
    """A torus around z: radius R of the centre line, radius r of the tube."""
    return _call("torus", [R, r])


def halfspace(normal=None, offset=None) -> Expression:
    """Where normal . p is below offset (0), for the normal (z) at unit length."""
    return _call("halfspace", [], {"normal": normal, "offset": offset}) if normal is not None or offset is not None \
        else _call("halfspace", [])


def plane(normal=None, offset=None) -> Expression:
    """The same as halfspace."""
    return _call("plane", [], {"normal": normal, "offset": offset}) if normal is not None or offset is not None \
        else _call("plane", [])


def metaballs(balls, sharpness=None) -> Expression:
    """Balls that flow together: (n, 4), centre and radius of each; sharpness (1) up to 100, larger: less flow."""
    return _call("metaballs", [[float(v) for v in ball] for ball in balls], {"sharpness": 1 if sharpness is None else sharpness})


def surface(path) -> Expression:
    """The solid within the surface of a file: STL, OBJ, PLY, OFF or Gmsh."""
    return _call("surface", [_os.path.abspath(_os.fspath(path))])


def _periodic(name):
    def make(period=1, thickness=0, level=0) -> Expression:
        return _call(name, [], {"period": period, "thickness": thickness, "level": level})

    make.__name__ = make.__qualname__ = name
    make.__doc__ = (f"The periodic surface {name} as a solid: period, side of the cubic cell; thickness of the sheet around it, 0: one of\n"
                    "    its two sides; level of the level set. It fills all space: intersect it with something.")
    return make


gyroid = _periodic("gyroid")
schwarz_p = _periodic("schwarz_p")
schwarz_d = _periodic("schwarz_d")
neovius = _periodic("neovius")
iwp = _periodic("iwp")
frd = _periodic("frd")
lidinoid = _periodic("lidinoid")
fischer_koch_s = _periodic("fischer_koch_s")


# ---- combining and changing ----


def union(*solids) -> Expression:
    """What any of the solids holds; a list of them will do."""
    return _call("union", solids)


def intersection(*solids) -> Expression:
    """What all of them hold."""
    return _call("intersection", solids)


def difference(*solids) -> Expression:
    """The first without the others."""
    return _call("difference", solids)


def smooth_union(*solids_and_width) -> Expression:
    """The union, rounded where two surfaces are within the width, the last argument, of one another."""
    return _call("smooth_union", solids_and_width)


def smooth_intersection(*solids_and_width) -> Expression:
    """The intersection, likewise."""
    return _call("smooth_intersection", solids_and_width)


def smooth_difference(*solids_and_width) -> Expression:
    """The difference, likewise."""
    return _call("smooth_difference", solids_and_width)


def complement(a) -> Expression:
    """The outside of a, as ~a."""
    return _call("complement", [a])


def morph(a, b, t) -> Expression:
    """Between a (t = 0) and b (t = 1)."""
    return _call("morph", [a, b, t])


def offset(a, distance) -> Expression:
    """a grown by a length, or shrunk when it is negative."""
    return _call("offset", [a, distance])


def shell(a, thickness) -> Expression:
    """The wall of that thickness inside the surface of a."""
    return _call("shell", [a, thickness])


def bounds(a, lower, upper) -> Expression:
    """a cut to the box between two corners."""
    return _call("bounds", [a, lower, upper])


def move(a, *by, **named) -> Expression:
    """a moved by a vector, or by three numbers."""
    return _call("move", by, named, a)


def translate(a, *by, **named) -> Expression:
    """The same as move."""
    return _call("translate", by, named, a)


def rotate(a, angle, axis="z") -> Expression:
    """a turned about an axis through the origin: degrees, right-handed."""
    return _call("rotate", [angle, axis], solid=a)


def scale(a, *by) -> Expression:
    """a scaled by one factor, or one for each axis; negative ones mirror."""
    return _call("scale", by, solid=a)


def mirror(a, *normal, **named) -> Expression:
    """a mirrored in the plane through the origin with that normal."""
    return _call("mirror", normal, named, a)


def repeat_linear(a, step, count) -> Expression:
    """a and count - 1 copies, each moved by the vector step from the last."""
    return _call("repeat_linear", [], {"step": step, "count": count}, a)


def repeat_grid(a, step, count) -> Expression:
    """The same along x, y and z; both are vectors."""
    return _call("repeat_grid", [], {"step": step, "count": count}, a)


def repeat_polar(a, count, axis=None, angle=None) -> Expression:
    """count copies turned evenly over the angle (360 degrees) about the axis (z), the first in its place."""
    return _call("repeat_polar", [], {"count": count, "axis": axis, "angle": angle}, a)


def warp(a, X, Y, Z) -> Expression:
    """a with fields in place of its coordinates: its value at (X, Y, Z)."""
    return _call("warp", [a, X, Y, Z])


def keep(a, points=None, lines=None) -> Expression:
    """a with points (n, 3) and lines, a list of (k, 3), of its surface that the mesh shall contain."""
    return _call("keep", [], {"points": points, "lines": lines}, a)


def tag(a, b) -> Expression:
    """tag("name", solid) or solid.tag("name"): names the surface of a solid."""
    return _call("tag", [a, b])


def region(a, b) -> Expression:
    """region("name", solid) or solid.region("name"): names the inside of a solid."""
    return _call("region", [a, b])


def _add_methods():
    """Functions whose first parameter is a solid are methods as well."""
    for function in (union, intersection, difference, smooth_union, smooth_intersection, smooth_difference, complement, morph, offset,
                     shell, bounds, move, translate, rotate, scale, mirror, repeat_linear, repeat_grid, repeat_polar, warp, keep, tag,
                     region):
        setattr(Expression, function.__name__, function)


_add_methods()
