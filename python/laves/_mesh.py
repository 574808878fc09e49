"""Meshes: their arrays, what can be asked of them, and how they leave."""
import ctypes
import functools
import json
import os
import tempfile
import typing
import warnings

import numpy as np

from . import _arrays, _header, errors
from ._domain import Domain
from ._library import lib, path_of, text_of
from ._options import enum_in, fill, mesh_options
from ._picture import html_of, picture_of
from ._quality import Quality
from ._records import Check, CurveReport, FeatureCheck, ImproveReport, Place, Record, Report
from ._session import Handle, MadeByCall, Session


class Certificate(Record):
    """What a mesh is, recomputed from its arrays: laves_certificate. `check`, `promise_holds`, `mesh_hash`, `exceptions`, ..."""

    def __init__(self, session: Session, structure):
        super().__init__(structure)
        words = bytes(structure)[type(structure).command.offset:].split(b"\0", structure.command_count)[:structure.command_count]
        self.__dict__["command"] = [word.decode("utf-8") for word in words]
        self.__dict__["_of"] = (session, structure)

    def as_dict(self) -> "dict[str, typing.Any]":
        """As the file holds it (docs/certificate.md)."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "certificate.json")
            self.write(path)
            with open(path, encoding="utf-8") as file:
                return json.load(file)

    def write(self, path: "str | os.PathLike") -> None:
        """As JSON, whole or not at all."""
        session, structure = self._of
        session.call(lib.laves_certificate_write, session.context, ctypes.byref(structure), path_of(path))

    @classmethod
    def read(cls, path: "str | os.PathLike") -> "Certificate":
        session, structure = Session(), _header.laves_certificate()
        session.call(lib.laves_certificate_read, session.context, path_of(path), ctypes.byref(structure))
        return cls(session, structure)

    def __repr__(self):
        return f"<laves.Certificate of {self.check.tets:,} tets, {'holds' if self.promise_holds else 'does NOT hold'}>"


class Mesh:
    """A tetrahedral mesh. Arrays are views of the library's memory, only to be read, and stay good as long as they are there, even
    when the mesh isn't: copy what you want to change.

    report: how it was made, or None.  domain: the solid that it is of, or None."""

    def __init__(self, session: Session, handle: Handle, domain: "Domain | None" = None, report=None, options=None):
        self.session = session
        self.handle = handle
        self.domain = domain
        self._raw_report = report
        self._options = options  # as the library takes them, and what these refer to
        self.report: "Report | ImproveReport | None" = Report(report) if report is not None else None

    # ---- makers ----

    @classmethod
    def read(cls, path: "str | os.PathLike", *, threads: int = 0, memory: int = 0, progress=None, timeout: "float | None" = None) -> "Mesh":
        """Reads a mesh of any program: VTU, Gmsh 2.2 and 4.1, Medit, TetGen."""
        if not os.path.exists(path):
            raise errors.MissingFileError(f"the file '{os.fsdecode(path)}' does not exist")
        session, made = Session(threads, memory), MadeByCall()
        session.call(lib.laves_mesh_read, session.context, path_of(path), made.argument, progress=progress, timeout=timeout)
        return cls(session, made.handle(session, lib.laves_mesh_free))

    @classmethod
    def from_arrays(cls, points, tets, regions=None, *, threads: int = 0, memory: int = 0) -> "Mesh":
        """A mesh of points, float64 (n, 3), and tets, whole numbers (m, 4), with regions (m,); they are copied, the boundary is found."""
        p = _arrays.points_in(points)
        t = _arrays.indices_in(tets, 4, np.int32, len(p), "tets")
        r = _arrays.labels_in(regions, len(t), "regions")
        session, made = Session(threads, memory), MadeByCall()
        session.call(lib.laves_mesh_from_arrays, session.context, _arrays.pointer_to(p, ctypes.c_double), len(p),
                     _arrays.pointer_to(t, ctypes.c_int32), len(t), _arrays.pointer_to(r, ctypes.c_int32), made.argument)
        return cls(session, made.handle(session, lib.laves_mesh_free))

    @classmethod
    def tiling(cls, cells, size: float) -> "Mesh":
        """The plain tiling of a box: cells, three whole numbers, periods along each axis; a period is 2.5118 sizes long."""
        session, made = Session(), MadeByCall()
        wanted = (ctypes.c_int * 3)(*[int(c) for c in cells])
        session.call(lib.laves_generate_tiling, session.context, wanted, size, made.argument)
        return cls(session, made.handle(session, lib.laves_mesh_free))

    # ---- arrays ----

    @property
    def vertex_count(self) -> int:
        return lib.laves_mesh_vertex_count(self.handle.pointer)

    @property
    def tet_count(self) -> int:
        return lib.laves_mesh_tet_count(self.handle.pointer)

    @property
    def face_count(self) -> int:
        return lib.laves_mesh_face_count(self.handle.pointer)

    def _view(self, function, kind, *shape):
        return _arrays.view(self.handle, function(self.handle.pointer), kind, shape)

    def _held(self, what, reader):
        if self.streamed:
            raise errors.OptionError(f"a streamed mesh does not hold its {what}; read them by ranges with mesh.{reader}()")

    @property
    def points(self) -> np.ndarray:
        """float64 (n, 3), in the units of the input."""
        self._held("points", "read_points")
        return self._view(lib.laves_mesh_points, np.float64, self.vertex_count, 3)

    @property
    def tets(self) -> np.ndarray:
        """int32 (m, 4): corners, each tet of positive volume. The first `lattice_tet_count` are exact tiles, but for graded meshes."""
        self._held("tets", "read_tets")
        return self._view(lib.laves_mesh_tets, np.int32, self.tet_count, 4)

    @property
    def faces(self) -> np.ndarray:
        """int32 (k, 3): boundary triangles, facing outwards."""
        return self._view(lib.laves_mesh_faces, np.int32, self.face_count, 3)

    def _labels(self, function, count):
        pointer = function(self.handle.pointer)
        return _arrays.view(self.handle, pointer, np.int32, (count,)) if pointer else np.ones(count, np.int32)

    @property
    def face_tags(self) -> np.ndarray:
        """int32 (k,): of each boundary face, 1 + the tag of the input that is nearest; all 1 where nothing has a tag (then no view).
        Names are in `face_groups`."""
        return self._labels(lib.laves_mesh_face_tags, self.face_count)

    @property
    def regions(self) -> np.ndarray:
        """int32 (m,): of each tet; all 1 where there is but one (then no view). Names are in `region_groups`."""
        return self._labels(lib.laves_mesh_regions, self.tet_count)

    @property
    def face_sources(self) -> "np.ndarray | None":
        """int32 (k,): the nearest face of the input for each boundary face, -1: none; None unless face_sources=True was asked."""
        pointer = lib.laves_mesh_face_sources(self.handle.pointer)
        return _arrays.view(self.handle, pointer, np.int32, (self.face_count,)) if pointer else None

    def _groups(self, dimension, labels) -> "dict[str, int]":
        named = ((int(tag), lib.laves_mesh_group_name(self.handle.pointer, dimension, int(tag))) for tag in np.unique(labels))
        return {name.decode("utf-8", "replace"): tag for tag, name in named if name is not None}

    @property
    def face_groups(self) -> "dict[str, int]":
        """Names of face tags that have one, and the tag of each."""
        return self._groups(2, self.face_tags)

    @property
    def region_groups(self) -> "dict[str, int]":
        """Names of regions that have one, and the number of each."""
        return self._groups(3, self.regions)

    @property
    def lattice_tet_count(self) -> int:
        """Tets [0, lattice_tet_count) are exact tiles of the tiling."""
        return lib.laves_mesh_lattice_tet_count(self.handle.pointer)

    @property
    def hash(self) -> str:
        """128 bits of all arrays, 32 hexadecimal digits: the same for any number of threads."""
        digits = ctypes.create_string_buffer(33)
        lib.laves_mesh_hash(self.handle.pointer, ctypes.cast(digits, ctypes.c_char_p))
        return digits.value.decode()

    # ---- ranges ----

    @property
    def streamed(self) -> bool:
        """Whether points and tets are made when they are read (streamed=True of laves.mesh())."""
        return lib.laves_mesh_is_streamed(self.handle.pointer)

    def _read(self, function, kind, columns, first, count, total):
        count = total - first if count is None else count
        if first < 0 or count < 0 or first + count > total:
            raise errors.OptionError(f"the range {first} .. {first + count} goes beyond the {total} of the mesh")
        rows = np.empty((count, columns), kind)
        error = _header.laves_error()
        pointer = rows.ctypes.data_as(ctypes.POINTER(ctypes.c_double if kind is np.float64 else ctypes.c_int32))
        result = function(self.handle.pointer, first, count, pointer, ctypes.byref(error))
        if result:
            raise errors.error_of(result, text_of(error.text))
        return rows

    def read_points(self, first: int = 0, count: "int | None" = None) -> np.ndarray:
        """Points [first, first + count), float64 (count, 3), of any mesh; a copy. count None: to the end. From any thread."""
        return self._read(lib.laves_mesh_read_points, np.float64, 3, first, count, self.vertex_count)

    def read_tets(self, first: int = 0, count: "int | None" = None) -> np.ndarray:
        """Tets [first, first + count), int32 (count, 4); likewise."""
        return self._read(lib.laves_mesh_read_tets, np.int32, 4, first, count, self.tet_count)

    def point_ranges(self, count: int = 65536) -> "typing.Iterator[np.ndarray]":
        """All points in order, in pieces of (count, 3)."""
        for first in range(0, self.vertex_count, count):
            yield self.read_points(first, min(count, self.vertex_count - first))

    def tet_ranges(self, count: int = 65536) -> "typing.Iterator[np.ndarray]":
        """All tets in order, in pieces of (count, 4)."""
        for first in range(0, self.tet_count, count):
            yield self.read_tets(first, min(count, self.tet_count - first))

    # ---- second order ----

    def curve(self, domain: "Domain | None" = None, *, straight: bool = False, features=None, progress=None,
              timeout: "float | None" = None, **options) -> CurveReport:
        """Gives each edge a node, so that tets have ten and faces six: `nodes`, `tet_nodes`, `face_nodes`; write() writes them. Those
        of the boundary stand on the domain's surface (None: the mesh's own domain) where that keeps all Jacobians positive.
        straight: all at the middle of their edge, which needs no domain. Once for each mesh; `points`, `tets` and all checks stay as
        they are. Options as in laves_curve_options: min_jacobian, distances, feature_angle, feature_tags, feature_size; what they
        leave out is as the mesh was made."""
        if self.order != 1:
            raise errors.OptionError("the mesh is of second order already")
        domain = None if straight else self._domain_or_own(domain)
        wished = lib.laves_curve_options_default()
        if self._options is not None:
            made = self._options[0]
            wished.feature_angle, wished.feature_tags, wished.features = made.feature_angle, made.feature_tags, made.features
            wished.feature_size = self._raw_report.feature_size if self._raw_report is not None else 0
        fill(wished, options, "curve()")
        if features is not None:
            wished.features = features.handle.pointer
        found = _header.laves_curve_report()
        self._call(lib.laves_mesh_curve, _pointer(domain), ctypes.byref(wished), ctypes.byref(found), domain=domain,
                   progress=progress, timeout=timeout)
        return CurveReport(found)

    @property
    def order(self) -> int:
        """1, or 2 after curve()."""
        return lib.laves_mesh_order(self.handle.pointer)

    @property
    def nodes(self) -> np.ndarray:
        """float64 (n, 3): the vertices, then the nodes on edges; of a mesh of first order `points`."""
        self._held("points", "read_points")
        return self._view(lib.laves_mesh_node_points, np.float64, lib.laves_mesh_node_count(self.handle.pointer), 3)

    @property
    def tet_nodes(self) -> np.ndarray:
        """int32 (m, 10): four corners, then the nodes on edges 01, 12, 02, 03, 13, 23; of a mesh of first order `tets`."""
        self._held("tets", "read_tets")
        return self._view(lib.laves_mesh_tet_nodes, np.int32, self.tet_count, 10 if self.order == 2 else 4)

    @property
    def face_nodes(self) -> np.ndarray:
        """int32 (k, 6): three corners, then the nodes on edges 01, 12, 02; of a mesh of first order `faces`."""
        return self._view(lib.laves_mesh_face_nodes, np.int32, self.face_count, 6 if self.order == 2 else 3)

    # ---- checks ----

    def _call(self, function, *arguments, domain=None, progress=None, timeout=None):
        return self.session.call(function, self.session.context, self.handle.pointer, *arguments, progress=progress, timeout=timeout,
                                 functions=domain._functions if domain is not None else ())

    def quality(self) -> Quality:
        """Angles and shapes of each tet, as arrays (m,)."""
        self._held("tets", "read_tets")
        return Quality(self.points, self.tets)

    def check(self, domain: "Domain | None" = None, *, progress=None, timeout: "float | None" = None) -> Check:
        """Whether the mesh is valid, its topology and quality, and with a domain its distances, by code that shares nothing with
        what makes meshes."""
        found = _header.laves_check()
        self._call(lib.laves_check_mesh, _pointer(domain), ctypes.byref(found), domain=domain, progress=progress, timeout=timeout)
        return Check(found)

    def check_features(self, domain: "Domain | None" = None, *, places: int = 16, progress=None, timeout: "float | None" = None,
                       features=None, **options) -> FeatureCheck:
        """How well the mesh keeps the creases and corners of a domain (None: its own), with the worst `places` of each fault. Options
        as in laves_feature_options: angle, tags, size, tolerance."""
        domain = self._domain_or_own(domain)
        wished = fill(lib.laves_feature_options_default(), options, "check_features()")
        wished.features = features.handle.pointer if features is not None else None
        found, count = _header.laves_feature_check(), ctypes.c_size_t()
        room = (_header.laves_feature_place * (places * _header.CONSTANTS["LAVES_FEATURE_FAULT_COUNT"]))()
        self._call(lib.laves_check_features, _pointer(domain), ctypes.byref(wished), ctypes.byref(found), room, places,
                   ctypes.byref(count), domain=domain, progress=progress, timeout=timeout)
        check = FeatureCheck(found)
        check.__dict__["places"] = [Place(p) for p in room[:count.value]]
        return check

    # ---- improvement ----

    def improve(self, *, progress=None, timeout: "float | None" = None, **options) -> "Mesh":
        """A mesh with better dihedral angles and the same boundary, regions and tags; of a mesh of any program. The worst angles are
        never worse than before. Its `report` is a laves.ImproveReport.

        Options, as in laves_improve_options: min_dihedral, max_dihedral: the window that is asked for, degrees, 30 and 140.
        volume_length.  tolerance: how far the boundary may come to be from where it was, units of the mesh, 0.  fixed_boundary.
        passes: most passes, 0: as many as help.  seconds: when to stop with what there is.

        Warns laves.TargetMissed when tets stay outside the window; raises laves.InputError when the mesh is not valid."""
        self._held("tets", "read_tets")
        wished = fill(lib.laves_improve_options_default(), options, "improve()")
        made, report = MadeByCall(), _header.laves_improve_report()
        missed = self._call(lib.laves_improve, ctypes.byref(wished), made.argument, ctypes.byref(report), progress=progress, timeout=timeout)
        better = Mesh(self.session, made.handle(self.session, lib.laves_mesh_free), self.domain)
        better.report = ImproveReport(report)
        if missed:
            warnings.warn(f"{report.outside_after:,} tetrahedra are outside the asked window", errors.TargetMissed, stacklevel=2)
        return better

    def _domain_or_own(self, domain):
        if domain is None and self.domain is None:
            raise errors.OptionError("the mesh does not know its solid; name a laves.Domain")
        return domain if domain is not None else self.domain

    def _places(self, function, *arguments, domain, capacity, progress, timeout):
        room, count = (_header.laves_place * capacity)(), ctypes.c_size_t()
        self._call(function, _pointer(domain), *arguments, room, capacity, ctypes.byref(count), domain=domain, progress=progress,
                   timeout=timeout)
        return count.value, [Place(p) for p in room[:min(count.value, capacity)]]

    def outside_window(self, min_dihedral: float = 40, max_dihedral: float = 125, volume_length: float = 0, *,
                       domain: "Domain | None" = None, capacity: int = 1000, progress=None,
                       timeout: "float | None" = None) -> "tuple[int, list[Place]]":
        """How many tets leave a window of dihedral angles, degrees, or have a smaller volume-length ratio; and the worst of them."""
        return self._places(lib.laves_check_window, min_dihedral, max_dihedral, volume_length, domain=domain, capacity=capacity,
                            progress=progress, timeout=timeout)

    def further_than(self, distance: float, *, domain: "Domain | None" = None, capacity: int = 1000, progress=None,
                     timeout: "float | None" = None) -> "tuple[int, list[Place]]":
        """How many places there are where boundary and surface are further apart than a distance; and the furthest."""
        return self._places(lib.laves_check_distance, distance, domain=self._domain_or_own(domain), capacity=capacity,
                            progress=progress, timeout=timeout)

    def certify(self, domain: "Domain | None" = None, *, progress=None, timeout: "float | None" = None, **options) -> Certificate:
        """States what the mesh is. domain: to measure distances against; None: its own, if it knows that. Options as in
        laves_certify_options: distances, command (a list of words that make the mesh again), and, where the mesh was not made here,
        promised_min_dihedral and so on."""
        own = domain is None or domain is self.domain
        domain = self.domain if domain is None else domain
        words = [os.fsencode(word) for word in options.pop("command", None) or []]
        wished = fill(lib.laves_certify_options_default(), options, "certify()")
        wished.command, wished.command_count = (ctypes.c_char_p * len(words))(*words), len(words)
        wished.domain = _pointer(domain)
        if domain is not None:
            wished.input = domain._name
        if own and self._options is not None:
            wished.options = ctypes.pointer(self._options[0])
            wished.report = ctypes.pointer(self._raw_report)
        found = _header.laves_certificate()
        self._call(lib.laves_certify, ctypes.byref(wished), ctypes.byref(found), domain=domain, progress=progress, timeout=timeout)
        return Certificate(self.session, found)

    @functools.cached_property
    def certificate(self) -> Certificate:
        """What the mesh is, against its own solid: made once, when it is asked for."""
        return self.certify()

    def verify(self, certificate: "Certificate | str | os.PathLike", domain: "Domain | None" = None, *, progress=None,
               timeout: "float | None" = None) -> "list[str]":
        """A sentence on each figure of a certificate that is not so; empty: it tells the truth. domain: None: its own, if it knows."""
        if not isinstance(certificate, Certificate):
            certificate = Certificate.read(certificate)
        domain = self.domain if domain is None else domain
        differences, count = (_header.laves_difference * 100)(), ctypes.c_size_t()
        self._call(lib.laves_certificate_verify, _pointer(domain), domain._name if domain is not None else None,
                   ctypes.byref(certificate._of[1]), differences, len(differences), ctypes.byref(count), domain=domain,
                   progress=progress, timeout=timeout)
        return [d.text.decode("utf-8", "replace") for d in differences[:min(count.value, len(differences))]]

    # ---- out ----

    def write(self, path: "str | os.PathLike", format: "str | None" = None, *, ascii: bool = False, compression: int = 1,  # noqa: A002
              progress=None, timeout: "float | None" = None) -> None:
        """Writes a file, whole or not at all: VTU, Gmsh, Medit, TetGen; STL, OBJ, PLY, OFF of the boundary.

        format: "vtu", "gmsh41", ...; None: by the extension.  ascii: text where there is a choice.  compression: of VTU, 0 to 9."""
        wished = lib.laves_write_options_default()
        wished.format = enum_in("laves_format", "format", format) if format else 0
        wished.ascii, wished.compression = bool(ascii), int(compression)
        self._call(lib.laves_mesh_write, path_of(path), ctypes.byref(wished), progress=progress, timeout=timeout)

    def to_meshio(self):
        """A meshio.Mesh with cells "tetra" and "triangle" ("tetra10" and "triangle6" of second order), and their numbers as cell data "region" and "tag"."""
        import meshio
        kinds = ("tetra", "triangle") if self.order == 1 else ("tetra10", "triangle6")
        cells = [(kinds[0], self.tet_nodes), (kinds[1], self.face_nodes)]
        regions, tags = self.regions, self.face_tags
        data = {"region": [regions, np.zeros(len(tags), np.int32)], "tag": [np.zeros(len(regions), np.int32), tags]}
        names = {name: np.array([tag, 2]) for name, tag in self.face_groups.items()}
        names.update({name: np.array([tag, 3]) for name, tag in self.region_groups.items()})
        return meshio.Mesh(self.nodes, cells, cell_data=data, field_data=names)

    def to_pyvista(self):
        """A pyvista.UnstructuredGrid of the tets, with cell data "region"; its points are a view where PyVista allows."""
        import pyvista
        kind = pyvista.CellType.TETRA if self.order == 1 else pyvista.CellType.QUADRATIC_TETRA
        grid = pyvista.UnstructuredGrid({kind: self.tet_nodes}, self.nodes)
        grid.cell_data["region"] = self.regions
        return grid

    def picture(self, path: "str | os.PathLike | None" = None, *options: str) -> "bytes | None":
        """A PNG of the mesh, drawn by the program: `laves help view` lists the options, such as "--cut", "x". None: there is no program."""
        drawn = picture_of(self, options)
        if path is not None and drawn is not None:
            with open(path, "wb") as file:
                file.write(drawn)
        return drawn

    def __repr__(self):
        return f"<laves.Mesh {self.tet_count:,} tets, {self.vertex_count:,} vertices, {self.face_count:,} boundary faces>"

    def _repr_html_(self) -> str:
        rows = [("tets", f"{self.tet_count:,}"), ("vertices", f"{self.vertex_count:,}"), ("boundary faces", f"{self.face_count:,}")]
        if not self.streamed:
            found = self.check()
            rows += [("valid", "yes" if found.valid else "NO"),
                     ("dihedral angles", f"{found.min_dihedral.min:.2f}° .. {found.max_dihedral.max:.2f}°"),
                     ("radius ratio", f"min {found.radius_ratio.min:.3f}, mean {found.radius_ratio.mean:.3f}"),
                     ("volume", f"{found.volume:.6g}"), ("edges", f"{found.edge_min:.4g} .. {found.edge_max:.4g}")]
        return html_of(self, rows)


def _pointer(domain):
    if domain is None:
        return None
    if not isinstance(domain, Domain):
        raise TypeError(f"the solid must be a laves.Domain, not {type(domain).__name__}")
    return domain.handle.pointer


def generate(session: Session, domain: Domain, options: dict, progress, timeout) -> Mesh:
    """The mesh of a domain; options by the names of laves_options."""
    wished, keeps = mesh_options(options)
    made, report = MadeByCall(), _header.laves_report()
    missed = session.call(lib.laves_generate, session.context, domain.handle.pointer, ctypes.byref(wished), made.argument,
                          ctypes.byref(report), progress=progress, timeout=timeout, functions=domain._functions)
    # The mesh may ask its domain as long as it is there, when it makes its points as they are read.
    handle = made.handle(session, lib.laves_mesh_free, (domain, keeps))
    mesh = Mesh(session, handle, domain, report, (wished, keeps))
    if missed:
        said = "; ".join(Report(report).warnings) or "a wished target was missed"
        warnings.warn(said, errors.TargetMissed, stacklevel=4)
    return mesh
