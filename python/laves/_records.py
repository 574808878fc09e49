"""Structures of the library as plain Python objects, with the names of laves.h."""
import ctypes
import typing

import numpy as np

from . import _header

# Arrays of which only the first so many count.
_COUNTS = {"stages": "stage_count", "lost": "lost_count", "warnings": "warning_count", "exceptions": "exception_count"}
# Arrays with a place for each member of an enum.
_BY_KIND = {"defects": "laves_defect", "defect_place": "laves_defect", "exception_counts": "laves_exception_kind"}


class Record:
    """What the library told: the members of a structure of laves.h, under their names there.

    Enums are lower-case words ("surface"), texts are str, vectors are arrays; what has no value is nan. Only to be read."""

    def __init__(self, structure: ctypes.Structure):
        enums = getattr(structure, "_enums_", {})
        for name, kind, *_ in structure._fields_:
            value = getattr(structure, name)
            if name == "cookie" or kind is ctypes.c_void_p:
                continue
            if name in enums:
                value = _header.ENUMS[enums[name]][value].lower()
            self.__dict__[name] = _python_value(structure, name, value)

    def __getattr__(self, name: str) -> typing.Any:
        raise AttributeError(f"{type(self).__name__} has no '{name}'; it has {', '.join(self.__dict__)}")

    def __setattr__(self, name, value):
        raise AttributeError(f"{type(self).__name__} is only to be read")

    def as_dict(self) -> "dict[str, typing.Any]":
        """The same as dictionaries and lists, without NumPy's types, as json.dumps takes them."""
        return {name: _plain(value) for name, value in self.__dict__.items()}

    def __repr__(self):
        members = "\n".join(f"  {name}: {_short(value)}" for name, value in self.__dict__.items())
        return f"{type(self).__name__}\n{members}"


class Report(Record):
    """What was done to make a mesh: laves_report."""


class Check(Record):
    """What a mesh is, from its arrays alone: laves_check. `valid`, counts, topology, statistics of quality, distances."""


class FileCheck(Record):
    """What checking a file by ranges finds: laves_file_check."""


class ImproveReport(Record):
    """What was done to improve a mesh: laves_improve_report. `before`, `after`, `outside_before`, `outside_after`, ..."""


class FeatureCheck(Record):
    """How well a mesh keeps the creases and corners of a solid: laves_feature_check, and `places`, the worst first."""


class CurveReport(Record):
    """What giving a mesh nodes of second order did: laves_curve_report."""


class DomainInfo(Record):
    """What a solid is: laves_domain_info, and `tags`, the names of its parts."""


class Expectation(Record):
    """What a mesh is likely to hold: laves_expectation."""


class Place(Record):
    """Where something is out of order: laves_place, laves_thin_place, laves_defect_place, laves_feature_place or laves_exception."""


class Part(Record):
    """A structure within another."""


_NAMES = {"laves_thin_place": Place, "laves_exception": Place, "laves_check": Check}


def _python_value(structure, name, value):
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, ctypes.Structure):
        return _NAMES.get(type(value).__name__, Part)(value)
    if not isinstance(value, ctypes.Array):
        return value
    if name in _COUNTS:
        value = value[:getattr(structure, _COUNTS[name])]
    if name in _BY_KIND:
        kinds = _header.ENUMS[_BY_KIND[name]]
        return {kind.lower(): _python_value(structure, "", v) for kind, v in zip(kinds, value)}
    items = list(value)
    if items and isinstance(items[0], (int, float)):
        return np.array(items)
    if items and isinstance(items[0], ctypes.Array) and not isinstance(items[0][0], (bytes, ctypes.Structure)):
        return np.array([list(row) for row in items])
    return [text_value(item) for item in items]


def text_value(item):
    if isinstance(item, ctypes.Array) and item._type_ is ctypes.c_char:
        return item.value.decode("utf-8", "replace")
    return _python_value(None, "", item)


def _plain(value):
    if isinstance(value, Record):
        return value.as_dict()
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_plain(v) for v in value]
    return value.tolist() if isinstance(value, np.ndarray) else value


def _short(value):
    if isinstance(value, Record):
        return ", ".join(f"{k} {_short(v)}" for k, v in value.__dict__.items())
    if isinstance(value, dict):
        return ", ".join(f"{k} {_short(v)}" for k, v in value.items())
    if isinstance(value, list):
        return f"{len(value)} of them" if len(value) > 3 else "; ".join(_short(v) for v in value)
    if isinstance(value, np.ndarray):
        return " ".join(f"{v:g}" for v in value.ravel())
    return f"{value:.9g}" if isinstance(value, float) else str(value)
