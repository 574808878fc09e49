"""laves fills any solid with nearly regular tetrahedra.

    import laves
    mesh = laves.mesh("part.stl", size=0.5)
    mesh.points, mesh.tets      # float64 (n, 3), int32 (m, 4)
    mesh.write("part.vtu")

Lengths are in the units of the input, angles in degrees, indices from 0. Values of solids are negative inside. The same input and
options give the same mesh, whatever the number of threads. Python's global lock is free while the library works. docs/python.md."""
import ctypes as _ctypes
import os as _os

from . import _header, solids
from ._domain import Defects, Domain
from ._guides import Features, Sizing
from ._library import lib as _lib, path_of as _path_of, program_path, text_of as _text_of
from ._mesh import Certificate, Mesh
from ._options import fill as _fill
from ._quality import Quality
from ._records import Check, CurveReport, DomainInfo, Expectation, FeatureCheck, FileCheck, ImproveReport, Place, Report
from ._session import Deadline as _Deadline, Session as _Session
from .errors import (CancelledError, Error, InputError, InternalError, MissingFileError, OptionError, OutOfMemoryError, TargetMissed,
                     TimeoutError, WriteError)

__version__: str = _lib.laves_version().decode()

__all__ = ["mesh", "info", "estimate", "check", "check_file", "improve", "read", "tiling", "formats", "format_of", "solids", "Mesh",
           "Domain", "Defects", "Sizing", "Features", "Certificate", "Quality", "Check", "DomainInfo", "Expectation",
           "CurveReport", "FeatureCheck", "FileCheck", "ImproveReport", "Place", "Report", "Error", "OptionError", "InputError", "MissingFileError",
           "OutOfMemoryError", "WriteError", "CancelledError", "TimeoutError", "InternalError", "TargetMissed", "program_path",
           "__version__"]

_DOMAIN_OPTIONS = ("tags", "bounds", "lipschitz", "defects", "winding", "close_holes", "overlap")


def _domain_of(source, faces, options, call):
    given = {name: options.pop(name) for name in _DOMAIN_OPTIONS if name in options}
    if isinstance(source, Domain):
        if faces is not None or given:
            raise TypeError(f"{', '.join(given) or 'faces'}: to be said when the laves.Domain is made")
        return source
    return Domain(source, faces, **given, **call)


def mesh(source, faces=None, *, threads: "int | None" = None, memory: "int | None" = None, progress=None,
         timeout: "float | None" = None, **options) -> Mesh:
    """The tetrahedral mesh of a solid.

    source, faces: what laves.Domain takes: a file, an expression, points (n, 3) and faces (m, 3), an object that has them, a
    function of points with bounds=(lower, upper); or a laves.Domain. Its options (tags, bounds, lipschitz, winding, close_holes,
    overlap) are taken here, too.

    One of these says how fine; none: about 50 thousand tets:
    size: length of edges, units of the input.  relative_size: as a part of the diagonal of the box, (0, 0.5].
    tets, vertices: how many, met within 3 %.

    All members of laves_options in laves.h are options under their names, among them:
    method: "auto", "snap", "stuff".  guarantee: smallest dihedral angle that is promised, degrees, [0, 28].
    sizing: laves.Sizing, or an expression of x, y, z and d.  grading: how fast sizes may grow.  interior_growth, curvature_elements,
    thickness_elements, max_distance, min_size, max_size.
    features: laves.Features.  feature_angle: sharper edges are kept, degrees, 0: none.  feature_tags.
    align: "none", "pca", or a rotation matrix (3, 3).  regions: "none", "parts".  face_sources.  streamed.

    threads: 0: one per core, which is the default but for functions of Python: 1.  memory: bytes that may be held, 0: no limit.
    progress: called as progress(phase, fraction), from the calling thread, fifty times a second at most; returning False cancels
    within about 0.2 seconds (laves.CancelledError), and so does what it raises.
    timeout: seconds; laves.TimeoutError. Ctrl-C is answered likewise.

    Warns laves.TargetMissed when the mesh is valid but a wished target was missed; raises laves.Error."""
    timeout = _Deadline.of(timeout)
    call = {"threads": threads, "memory": memory or 0, "progress": progress, "timeout": timeout}
    domain = _domain_of(source, faces, options, call)
    apart = {"threads": threads, "memory": memory} if domain is source else {}
    return domain.mesh(progress=progress, timeout=timeout, **apart, **options)


def info(source, faces=None, **options) -> DomainInfo:
    """What a solid is: `kind`, `lower`, `upper`, `volume`, `area`, `closed`, `defects`, `tags`, ... Arguments as of laves.Domain."""
    return _domain_of(source, faces, options, options).info


def estimate(source, faces=None, *, threads: "int | None" = None, memory: int = 0, progress=None, timeout: "float | None" = None,
             **options) -> Expectation:
    """What laves.mesh() of the same arguments is likely to hold; a small part of its cost."""
    timeout = _Deadline.of(timeout)
    call = {"threads": threads, "memory": memory, "progress": progress, "timeout": timeout}
    return _domain_of(source, faces, options, call).estimate(progress=progress, timeout=timeout, **options)


def read(path: "str | _os.PathLike", *, threads: int = 0, memory: int = 0, progress=None, timeout: "float | None" = None) -> Mesh:
    """Reads a mesh of any program: VTU, Gmsh 2.2 and 4.1, Medit, TetGen."""
    return Mesh.read(path, threads=threads, memory=memory, progress=progress, timeout=timeout)


def tiling(cells, size: float) -> Mesh:
    """The plain tiling of a box of cells, three whole numbers of periods; a period is 2.5118 sizes long."""
    return Mesh.tiling(cells, size)


def check(mesh, surface=None, *, progress=None, timeout: "float | None" = None) -> Check:  # noqa: A002
    """What a mesh is: `valid`, topology, quality; with a surface its distances.

    mesh: laves.Mesh, or a file of any program.  surface: laves.Domain, or what makes one."""
    timeout = _Deadline.of(timeout)
    made = mesh if isinstance(mesh, Mesh) else read(mesh, progress=progress, timeout=timeout)
    domain = surface if surface is None or isinstance(surface, Domain) else Domain(surface, progress=progress, timeout=timeout)
    return made.check(domain, progress=progress, timeout=timeout)


def improve(mesh, *, threads: int = 0, memory: int = 0, progress=None, timeout: "float | None" = None, **options) -> Mesh:  # noqa: A002
    """A mesh of any program with better dihedral angles and the same boundary; mesh: laves.Mesh, or a file. As laves.Mesh.improve()."""
    timeout = _Deadline.of(timeout)
    made = mesh if isinstance(mesh, Mesh) else read(mesh, threads=threads, memory=memory, progress=progress, timeout=timeout)
    return made.improve(progress=progress, timeout=timeout, **options)


def check_file(path: "str | _os.PathLike", surface: "Domain | None" = None, *, places: int = 16, threads: int = 0, memory: int = 0,
               progress=None, timeout: "float | None" = None, **options) -> FileCheck:
    """Checks a mesh that may be larger than memory, by ranges of its VTU file (docs/streaming.md).

    Options: min_dihedral, max_dihedral, volume_length: the window; cache_bytes. `places` of the result: the worst tets outside it."""
    session, found = _Session(threads, memory), _header.laves_file_check()
    wished = _fill(_lib.laves_file_check_options_default(), options, "check_file()")
    room = (_header.laves_place * places)()
    wished.domain = surface.handle.pointer if surface is not None else None
    wished.places, wished.place_capacity = room, places
    session.call(_lib.laves_check_file, session.context, _path_of(path), _ctypes.byref(wished), _ctypes.byref(found),
                 progress=progress, timeout=timeout, functions=surface._functions if surface is not None else ())
    result = FileCheck(found)
    result.__dict__["places"] = [Place(p) for p in room[:min(found.outside_window, places)]]
    return result


def format_of(path: "str | _os.PathLike") -> "str | None":
    """The format that a file name's extension means ("vtu", "gmsh41", ...), or None."""
    number = _lib.laves_format_from_path(_path_of(path))
    return _text_of(_lib.laves_format_name(number))


def formats() -> "dict[str, bool]":
    """The formats that can be written, and whether a streamed mesh can be written in each."""
    return {name.lower(): _lib.laves_format_streams(i) for i, name in enumerate(_header.ENUMS["laves_format"]) if name != "AUTO"}
