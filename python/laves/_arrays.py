"""NumPy arrays for the library, and of the library's memory."""
import ctypes

import numpy as np

from . import errors


def points_in(points, name="points") -> np.ndarray:
    """As float64 (n, 3), contiguous; a copy only where it isn't that already."""
    return _rows(points, 3, np.float64, name)


def indices_in(indices, columns, kind, count, name) -> np.ndarray:
    """As whole numbers (n, columns) of a kind that the library takes, checked against the count of points."""
    found = np.asarray(indices)
    if found.size and found.dtype.kind not in "iu":
        raise errors.OptionError(f"{name} must be whole numbers, not {found.dtype}")
    found = _rows(found, columns, None, name)
    if found.dtype == kind and (found.dtype.kind == "u" or columns == 4):
        return found  # the library looks at the range itself
    if found.size and not (0 <= int(found.min()) and int(found.max()) < count):
        bad = int(np.argmax(((found < 0) | (found >= count)).any(axis=1)))
        raise errors.OptionError(f"{name}[{bad}] is {found[bad].tolist()}, but there are {count} points")
    return np.ascontiguousarray(found, dtype=kind)


def labels_in(labels, count, name) -> "np.ndarray | None":
    """As int32 (count,), or None."""
    if labels is None:
        return None
    found = np.asarray(labels)
    if found.shape != (count,) or (found.size and found.dtype.kind not in "iu"):
        raise errors.OptionError(f"{name} must be {count} whole numbers, one for each, not {found.dtype} {found.shape}")
    if found.size and not (-2**31 <= int(found.min()) and int(found.max()) < 2**31):
        raise errors.OptionError(f"{name} must fit 32 bits")
    return np.ascontiguousarray(found, dtype=np.int32)


def _rows(values, columns, kind, name):
    try:
        found = np.ascontiguousarray(values, dtype=kind)
    except (TypeError, ValueError) as e:
        raise errors.OptionError(f"{name} must be an array of numbers: {e}") from None
    if found.dtype.kind not in "fiu":
        raise errors.OptionError(f"{name} must be an array of numbers, not of {found.dtype}")
    if found.size == 0:
        found = found.reshape(0, columns)
    if found.ndim != 2 or found.shape[1] != columns:
        raise errors.OptionError(f"{name} must have the shape (n, {columns}), not {found.shape}")
    return found


def pointer_to(array, kind):
    """The memory of an array that the caller keeps alive; None: NULL."""
    return None if array is None else array.ctypes.data_as(ctypes.POINTER(kind))


class _Memory:
    """A piece of the library's memory as NumPy's array interface; keeps its owner alive."""

    def __init__(self, owner, address, kind, shape):
        self.owner = owner
        self.__array_interface__ = {"version": 3, "data": (address, True), "typestr": np.dtype(kind).str, "shape": shape}


def view(owner, pointer, kind, shape) -> np.ndarray:
    """A view, only to be read, of what a pointer of the library's points to. The owner lives as long as the view."""
    address = ctypes.cast(pointer, ctypes.c_void_p).value
    if not address or 0 in shape:
        empty = np.empty(shape, kind)
        empty.flags.writeable = False
        return empty
    return np.asarray(_Memory(owner, address, kind, shape))
