"""What the mesh shall follow beside the solid: sizes that vary, and points and lines that it shall contain."""
import ctypes
import os

from . import _arrays
from ._library import lib, path_of
from ._session import MadeByCall, Session


class Sizing:
    """Where elements shall be small: sources, each of which asks for sizes (edge lengths, units of the input) in some part of space.
    The least one counts everywhere, and what the other options ask for. Each method adds one source and returns the object:

        fine_rim = laves.Sizing().curve(rim, size=0.01).expression("0.1 + 0.05 * d")
        mesh = laves.mesh("part.stl", size=0.2, sizing=fine_rim)

    May be used for many meshes. docs/sizing.md tells what sizes become of it."""

    def __init__(self):
        self._session = Session()
        made = MadeByCall()
        self._session.call(lib.laves_sizing_create, self._session.context, made.argument)
        self.handle = made.handle(self._session, lib.laves_sizing_free)

    def _add(self, function, *arguments) -> "Sizing":
        self._session.call(function, self.handle.pointer, *arguments)
        return self

    def expression(self, text) -> "Sizing":
        """A Lua expression of x, y, z and d, the depth below the surface, such as "0.02 + 0.1 * d"; or one built of laves.solids."""
        return self._add(lib.laves_sizing_add_expression, str(text).encode())

    def script(self, path: "str | os.PathLike") -> "Sizing":
        """A file with a Lua script that returns such an expression."""
        return self._add(lib.laves_sizing_add_script, path_of(path))

    def background(self, path: "str | os.PathLike", array: "str | None" = None) -> "Sizing":
        """A mesh or image with sizes: NRRD, VTU, Gmsh .msh or .pos. array: the name of the values, needed where there are several."""
        return self._add(lib.laves_sizing_add_background, path_of(path), array.encode() if array is not None else None)

    def points(self, points, size: float, radius: float = 0.0) -> "Sizing":
        """size within radius of points, float64 (n, 3); beyond, it grows by the option `grading` per unit of distance."""
        p = _arrays.points_in(points)
        return self._add(lib.laves_sizing_add_points, _arrays.pointer_to(p, ctypes.c_double), len(p), size, radius)

    def curve(self, points, size: float, radius: float = 0.0) -> "Sizing":
        """The same about a polyline, float64 (n, 3), n at least 2; close it by repeating the first point."""
        p = _arrays.points_in(points)
        return self._add(lib.laves_sizing_add_curve, _arrays.pointer_to(p, ctypes.c_double), len(p), size, radius)

    def curve_file(self, path: "str | os.PathLike", size: float, radius: float = 0.0) -> "Sizing":
        """The same about all points and polylines of a file (docs/feature-files.md)."""
        return self._add(lib.laves_sizing_add_curve_file, path_of(path), size, radius)

    def tag(self, name: "str | int", size: float, radius: float = 0.0) -> "Sizing":
        """The same about the part of the surface that has a tag: its name or number."""
        return self._add(lib.laves_sizing_add_tag, str(name).encode(), size, radius)


class Features:
    """Points and lines of the surface that the mesh shall contain, beside the sharp edges that are found by themselves. Each method
    adds some and returns the object; may be used for many meshes. See docs/features.md."""

    def __init__(self):
        self._session = Session()
        made = MadeByCall()
        self._session.call(lib.laves_features_create, self._session.context, made.argument)
        self.handle = made.handle(self._session, lib.laves_features_free)

    def _add(self, function, *arguments) -> "Features":
        self._session.call(function, self.handle.pointer, *arguments)
        return self

    def points(self, points) -> "Features":
        """Points, float64 (n, 3), each of which becomes a vertex of the mesh at exactly that place."""
        p = _arrays.points_in(points)
        return self._add(lib.laves_features_add_points, _arrays.pointer_to(p, ctypes.c_double), len(p))

    def line(self, points) -> "Features":
        """A polyline, float64 (n, 3), n at least 2, which becomes a chain of edges; close it by repeating the first point."""
        p = _arrays.points_in(points)
        return self._add(lib.laves_features_add_line, _arrays.pointer_to(p, ctypes.c_double), len(p))

    def file(self, path: "str | os.PathLike") -> "Features":
        """The points and lines of a file (docs/feature-files.md)."""
        return self._add(lib.laves_features_add_file, path_of(path))


