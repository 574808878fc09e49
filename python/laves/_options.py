"""Keyword arguments become the structures of options of the library."""
import ctypes
import difflib

import numpy as np

from . import _header, errors
from ._library import lib
from ._guides import Features, Sizing

# Names that are shorter here than in laves.h; both are taken.
ALIASES = {"tets": "tet_target", "vertices": "vertex_target"}


def fill(structure, given: dict, what: str):
    """Sets members by name. Unknown names are a TypeError, as for any Python function."""
    kinds = {name: kind for name, kind, *_ in structure._fields_ if name != "cookie"}
    enums = getattr(structure, "_enums_", {})
    for name, value in given.items():
        member = ALIASES.get(name, name)
        if member not in kinds:
            near = difflib.get_close_matches(name, [*kinds, *ALIASES], 1)
            raise TypeError(f"{what} has no option '{name}'" + (f"; do you mean '{near[0]}'?" if near else "; it has " + ", ".join(kinds)))
        if member in enums:
            value = enum_in(enums[member], name, value)
        try:
            setattr(structure, member, _converted(kinds[member], value))
        except (TypeError, ValueError, ctypes.ArgumentError):
            raise errors.OptionError(f"{name} cannot be {value!r}") from None
    return structure


def enum_in(enum, name, value) -> int:
    members = [m.lower() for m in _header.ENUMS[enum]]
    if value is None and "none" in members:
        value = "none"
    if value not in members:
        raise errors.OptionError(f"{name} must be one of {', '.join(map(repr, members))}, not {value!r}")
    return members.index(value)


def _converted(kind, value):
    if issubclass(kind, ctypes.Array):
        flat = np.asarray(value, dtype=float).ravel()
        if len(flat) != kind._length_:
            raise ValueError
        return kind(*flat)
    if kind is ctypes.c_double:
        return float(value)
    if kind is ctypes.c_bool:
        if not isinstance(value, (bool, np.bool_)):
            raise TypeError
        return bool(value)
    if kind in (ctypes.c_int64, ctypes.c_size_t, ctypes.c_int):
        if int(value) != value:
            raise ValueError
        return int(value)
    return value


def sizing_in(sizing) -> "Sizing | None":
    if sizing is None or isinstance(sizing, Sizing):
        return sizing
    return Sizing().expression(sizing)


def mesh_options(given: dict):
    """laves_options, and the objects that must outlive it."""
    given = dict(given)
    sizing, features = sizing_in(given.pop("sizing", None)), given.pop("features", None)
    if features is not None and not isinstance(features, Features):
        raise errors.OptionError("features must be a laves.Features; feature_angle=0 keeps no creases")
    align = given.get("align")
    if align is not None and not isinstance(align, str):  # a rotation matrix
        given["align"], given["rotation"] = "rotation", align
    options = fill(lib.laves_options_default(), given, "laves.mesh()")
    options.sizing = sizing.handle.pointer if sizing else None
    options.features = features.handle.pointer if features else None
    return options, (sizing, features)
