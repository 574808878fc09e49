"""The C library: found, loaded, and its functions given their types."""
import ctypes
import os
import pathlib

from . import _header

HERE = pathlib.Path(__file__).resolve().parent


def _library_path() -> pathlib.Path:
    """The library that came with the package, or the one that LAVES_LIBRARY names."""
    asked = os.environ.get("LAVES_LIBRARY")
    if asked:
        return pathlib.Path(asked)
    found = sorted((HERE / "lib").glob("liblaves.so*"))
    if not found:
        raise ImportError(f"there is no liblaves.so in {HERE / 'lib'}: install the package (pip install .), or name a shared library "
                          "of laves in the environment variable LAVES_LIBRARY")
    return found[0]


def program_path() -> "pathlib.Path | None":
    """The program that came with the package, or the one that LAVES_PROGRAM names; None: there is none."""
    asked = os.environ.get("LAVES_PROGRAM")
    path = pathlib.Path(asked) if asked else HERE / "bin" / "laves"
    return path if path.exists() else None


def _load() -> ctypes.CDLL:
    library = ctypes.CDLL(str(_library_path()))  # calls give up Python's global lock while they last
    for name, (result, arguments) in _header.FUNCTIONS.items():
        function = getattr(library, name)
        function.restype = result
        function.argtypes = arguments
    return library


lib = _load()


def text_of(value: "bytes | None") -> "str | None":
    """A text of the library's, which is UTF-8 but for names out of files."""
    return None if value is None else value.decode("utf-8", "replace")


def path_of(path) -> bytes:
    """A file name for the library."""
    return os.fsencode(os.fspath(path))
