"""Solids: what is to be meshed, whatever it is made of."""
import ctypes
import math
import os
import threading
import typing

import numpy as np

from . import _arrays, _header, errors, solids
from ._library import lib, path_of, text_of
from ._options import fill, mesh_options
from ._records import DomainInfo, Expectation, Place
from ._session import Handle, MadeByCall, Session, deliver_signals, noted

_SURFACE_SUFFIXES = (".stl", ".obj", ".ply", ".off", ".msh", ".lua", ".vtu", ".mesh", ".meshb", ".node", ".ele")


class _Function:
    """A Python function as a callback of the library's. Used as a context manager around calls that may ask it."""

    KIND = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)

    def __init__(self, function):
        self._state = {"raised": None, "stopped": False}
        self._users = 0
        self._lock = threading.Lock()
        self._callback = self.KIND(_evaluator(function, self._state))
        self.pointer = ctypes.cast(self._callback, dict(_header.laves_function._fields_)["evaluate"])

    @property
    def raised(self):
        """What the function raised since calls that may ask it have begun."""
        return self._state["raised"]

    def stop(self):
        """The call is cancelled: what is still asked gets any answer, without the function."""
        with self._lock:
            if self._users == 1:
                self._state["stopped"] = True

    def __enter__(self):
        with self._lock:
            if self._users == 0:
                self._state.update(raised=None, stopped=False)
            self._users += 1

    def __exit__(self, *_):
        with self._lock:
            self._users -= 1


def _evaluator(function, state):
    """What the library calls. The memory that it hands over is nearly always the same few pieces, of which views are kept."""
    views, views_max = {}, 4096

    def view(points, count, values):
        if len(views) >= views_max:
            views.clear()
        made = (np.frombuffer((ctypes.c_double * (3 * count)).from_address(points)).reshape(count, 3),
                np.frombuffer((ctypes.c_double * count).from_address(values)))
        views[points, count, values] = made
        return made

    def evaluate(_, points, count, values):
        given, wanted = views.get((points, count, values)) or view(points, count, values)
        try:
            if state["stopped"]:
                wanted[:] = 1
                return
            if noted:
                deliver_signals()
            answer = function(given.copy())  # the function may keep what it was given
            if getattr(answer, "shape", None) != (count,):
                raise ValueError(f"the function must return an array of shape ({count},) for points of shape ({count}, 3), not "
                                 + (f"{answer.shape}" if hasattr(answer, "shape") else type(answer).__name__))
            wanted[:] = answer
        except BaseException as e:  # it may not pass through the library; the call raises it in the end
            state.update(raised=e, stopped=True)
            wanted[:] = 1

    return evaluate


class Domain:
    """A solid: anything with an inside. Made of

    - a file: STL, OBJ, PLY, OFF, Gmsh surfaces, or a Lua script (.lua);
    - an expression, such as "sphere(1) - cylinder{r=0.4}", or one built of `laves.solids`;
    - points, float64 (n, 3), and triangles `faces`, whole numbers (m, 3), with `tags` (m,) if you like;
    - an object with points and faces: a PyVista surface or grid, a trimesh, a meshio mesh of triangles;
    - a function of points, float64 (n, 3), that returns a value for each, float64 (n,): negative inside, zero on the surface. It
      needs `bounds`, (lower, upper): the corners of a box that contains the solid with a little room. `lipschitz`, if known, bounds
      how fast values change per unit of distance, which spares evaluations far from the surface. It is called with batches of up to
      some hundred points, and with one thread unless `threads` says more.

    Of surfaces: winding, close_holes, overlap ("direction", "union", "nested") as in laves.h; defects=True keeps the place of each
    defect. threads and memory are those of laves.mesh(); progress and timeout, too.

    Only to be read once made; may be meshed by several threads at once."""

    def __init__(self, source, faces=None, *, tags=None, bounds=None, lipschitz: float = 0.0, defects: bool = False,
                 threads: "int | None" = None, memory: int = 0, progress=None, timeout: "float | None" = None, **surface):
        kind, content = _understand(source, faces, tags, bounds)
        # Threads would only wait for one another where all of them ask Python.
        self.session = Session((1 if kind == "function" else 0) if threads is None else threads, memory)
        self.function = None
        self._defects = None
        self._name = None  # of the file, or the expression, for certificates
        made = MadeByCall()
        call = {"progress": progress, "timeout": timeout}
        if kind in ("function", "expression") and (surface or defects):
            raise TypeError(f"{', '.join([*surface, *['defects'] * defects])}: only surfaces have that, and this is a {kind}")
        getattr(self, "_from_" + kind)(content, made, call, {"bounds": bounds, "lipschitz": lipschitz}, surface, defects)
        keeps = (self.function,) if self.function else ()
        self.handle = made.handle(self.session, lib.laves_domain_free, keeps)
        info = _header.laves_domain_info()
        lib.laves_domain_get_info(self.handle.pointer, ctypes.byref(info))
        self.info = DomainInfo(info)
        self.info.__dict__["tags"] = [text_of(lib.laves_domain_tag_name(self.handle.pointer, i)) for i in range(info.tag_count)]

    # ---- makers ----

    def _surface_options(self, given, defects):
        options = fill(lib.laves_surface_options_default(), given, "a surface")
        if defects:
            self._defects = Defects(self.session)
            options.defects = self._defects.handle.pointer
        return options

    def _call_surface(self, call, function, *arguments):
        try:
            self.session.call(function, *arguments, **call)
        except errors.InputError as e:
            e.defects = self._defects
            raise

    def _from_file(self, path, made, call, _, surface, defects):
        if not os.path.exists(path):
            raise errors.MissingFileError(f"the file '{os.fsdecode(path)}' does not exist")
        self._name = path_of(os.path.abspath(path))  # the current folder may be another one when a certificate is made
        options = self._surface_options(surface, defects)
        self._call_surface(call, lib.laves_domain_from_file_with, self.session.context, path_of(path), ctypes.byref(options),
                           made.argument)

    def _from_triangles(self, content, made, call, _, surface, defects):
        points, faces, tags = content
        options = self._surface_options(surface, defects)
        self._call_surface(call, lib.laves_domain_from_triangles_with, self.session.context,
                           _arrays.pointer_to(points, ctypes.c_double), len(points), _arrays.pointer_to(faces, ctypes.c_uint32),
                           len(faces), _arrays.pointer_to(tags, ctypes.c_int32), ctypes.byref(options), made.argument)

    def _from_expression(self, text, made, call, *_):
        self._name = text.encode()
        self.session.call(lib.laves_domain_from_expression, self.session.context, self._name, made.argument, **call)

    def _from_function(self, function, made, call, given, *_):
        box = np.asarray(given["bounds"], dtype=float)
        if box.shape != (2, 3):
            raise errors.OptionError(f"bounds must be the lower and the upper corner, of shape (2, 3), not {box.shape}")
        self.function = _Function(function)
        about = _header.laves_function(self.function.pointer, None, tuple(box[0]), tuple(box[1]), given["lipschitz"])
        self.session.call(lib.laves_domain_from_function, self.session.context, ctypes.byref(about), made.argument, **call)

    # ---- questions ----

    @property
    def _functions(self):
        return (self.function,) if self.function else ()

    @property
    def defects(self) -> "Defects":
        """The places of the surface's defects; the domain must have been made with defects=True."""
        if self._defects is None:
            raise errors.OptionError("the places of defects are known where they are asked for: laves.Domain(..., defects=True)")
        return self._defects

    def evaluate(self, points) -> np.ndarray:
        """Signed values, float64 (n,), at points, float64 (n, 3): negative inside. Distances for surfaces, in the units of the input;
        for others whatever the expression or function yields."""
        p = _arrays.points_in(points)
        values = np.empty(len(p))
        for f in self._functions:
            f.__enter__()
        try:
            lib.laves_domain_evaluate(self.handle.pointer, _arrays.pointer_to(p, ctypes.c_double), len(p),
                                      _arrays.pointer_to(values, ctypes.c_double))
            raised = next((f.raised for f in self._functions if f.raised), None)
        finally:
            for f in self._functions:
                f.__exit__()
        if raised:
            raise raised
        return values

    def _places(self, function, count):
        places = (_header.laves_thin_place * count)()
        found = function(self.handle.pointer, places, count)
        if found == 0 and count > 0 and math.isnan(places[0].thickness):
            raise errors.OutOfMemoryError("there is no memory to look for thin places")
        return [Place(p) for p in places[:found]]

    def thin_places(self, count: int = 16) -> "list[Place]":
        """The thinnest walls of a surface, thinnest first: `place` (3,), `thickness`, `kind`. Empty for what is no surface."""
        return self._places(lib.laves_domain_thin_places, count)

    def gap_places(self, count: int = 16) -> "list[Place]":
        """The narrowest gaps, likewise."""
        return self._places(lib.laves_domain_gap_places, count)

    def estimate(self, *, progress=None, timeout: "float | None" = None, **options) -> Expectation:
        """What a mesh with these options of laves.mesh() is likely to hold: `size`, `tets`, `vertices`, `peak_bytes`."""
        wished, keeps = mesh_options(options)
        expectation = _header.laves_expectation()
        self.session.call(lib.laves_estimate, self.session.context, self.handle.pointer, ctypes.byref(wished), ctypes.byref(expectation),
                          progress=progress, timeout=timeout, functions=self._functions)
        del keeps
        return Expectation(expectation)

    def mesh(self, *, threads: "int | None" = None, memory: "int | None" = None, progress=None, timeout: "float | None" = None,
             **options):
        """The mesh of the solid; as laves.mesh(). threads, memory: of the mesh; None: it shares those of the domain."""
        from ._mesh import generate
        session = self.session if threads is None and memory is None else Session(threads or 0, memory or 0)
        return generate(session, self, options, progress, timeout)

    def __repr__(self):
        return f"<laves.Domain {self.info.kind}, {self.info.format}>"


class Defects:
    """Places of the defects of a surface: a list of laves.Place with `kind` ("open_edge", ...), `corners` (k, 3), k 1 to 3."""

    def __init__(self, session):
        made = MadeByCall()
        session.call(lib.laves_defects_create, session.context, made.argument)
        self.session = session
        self.handle: Handle = made.handle(session, lib.laves_defects_free)

    def __len__(self) -> int:
        return lib.laves_defects_count(self.handle.pointer)

    def __getitem__(self, index: int) -> Place:
        if not -len(self) <= index < len(self):
            raise IndexError(f"there are {len(self)} places, not {index}")
        place = _header.laves_defect_place()
        lib.laves_defects_get(self.handle.pointer, index % len(self), ctypes.byref(place))
        found = Place(place)
        found.__dict__["corners"] = found.corners[:place.corner_count]
        return found

    def write(self, path: "str | os.PathLike"):
        """As points, lines and faces with a colour for each kind: .ply, .obj or .vtp."""
        self.session.call(lib.laves_defects_write, self.session.context, self.handle.pointer, path_of(path))


# ---- what a source is ----


def _understand(source, faces, tags, bounds) -> "tuple[str, typing.Any]":
    """The kind of a source, and it in the form that the maker of that kind takes."""
    if faces is not None:
        return "triangles", _triangles(source, faces, tags)
    if isinstance(source, solids.Expression):
        return "expression", str(source)
    if isinstance(source, (os.PathLike, bytes)):
        return "file", source
    if isinstance(source, str):
        return _file_or_expression(source)
    found = _surface_of(source)
    if found is not None:
        return "triangles", _triangles(found[0], found[1], tags if tags is not None else found[2])
    if callable(source):
        if bounds is None:
            raise TypeError("a function needs bounds=(lower, upper): the corners of a box that contains the solid")
        return "function", source
    raise TypeError(f"a solid can be a file, an expression, points and faces, a function, or an object with points and faces; not "
                    f"{type(source).__name__}" + (" alone: faces are missing" if isinstance(source, (np.ndarray, list, tuple)) else ""))


def _file_or_expression(text):
    """As on the command line: what exists is a file, what looks like one is a mistake, anything else is an expression."""
    looks_like_path = text.lower().endswith(_SURFACE_SUFFIXES) or ("/" in text and not set(text) & set("(){}=*+<>^ \n\t"))
    return ("file" if os.path.exists(text) or looks_like_path else "expression"), text


def _triangles(points, faces, tags):
    p = _arrays.points_in(points)
    f = _arrays.indices_in(faces, 3, np.uint32, len(p), "faces")
    return p, f, _arrays.labels_in(tags, len(f), "tags")


def _surface_of(source):
    """Points, triangles and tags of an object that has some; None: it has none."""
    if hasattr(source, "extract_surface") and not hasattr(source, "faces"):  # PyVista, of cells
        source = source.extract_surface()
    if hasattr(source, "vertices") and hasattr(source, "faces"):  # trimesh
        return source.vertices, source.faces, None
    if hasattr(source, "points") and hasattr(source, "cells_dict"):  # meshio
        if "triangle" not in source.cells_dict:
            raise errors.InputError("the mesh has no triangles")
        return source.points, source.cells_dict["triangle"], None
    if hasattr(source, "points") and hasattr(source, "faces"):  # PyVista: the number of corners before those of each face
        return source.points, _fan(np.asarray(source.faces)), None
    return None


def _fan(faces):
    """Triangles of polygons that are listed as VTK does: n, then n corners."""
    if faces.ndim == 2:
        return faces
    if len(faces) % 4 == 0 and np.all(faces[::4] == 3):
        return faces.reshape(-1, 4)[:, 1:]
    triangles, at = [], 0
    while at < len(faces):
        corners = faces[at + 1:at + 1 + faces[at]]
        triangles += [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
        at += 1 + faces[at]
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)
