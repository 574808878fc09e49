"""What can go wrong: one class for each laves_result, all of them laves.Error. The text is the library's sentence."""
import builtins

from . import _header
from ._library import lib


class Error(Exception):
    """What a call of laves can raise. `text` is one sentence that says what is wrong, where, and what to do; `result` is the
    name of the C library's result, such as "ERROR_INPUT", and `exit_code` is what the program would end with."""

    result = ""

    def __init__(self, text: str):
        super().__init__(text)
        self.text = text

    @property
    def exit_code(self) -> int:
        return lib.laves_result_exit_code(_header.CONSTANTS["LAVES_" + self.result])

    def __str__(self) -> str:  # OSError and others would print something else
        return self.text


class OptionError(Error, ValueError):
    """An option or argument is out of its range."""

    result = "ERROR_OPTION"


class InputError(Error, ValueError):
    """The input cannot be read, or describes no solid."""

    result = "ERROR_INPUT"
    #: Places of the surface's defects where they were asked for (laves.Domain(..., defects=True)): laves.Defects, or None
    defects = None


class MissingFileError(InputError, FileNotFoundError):
    """The input is a file that does not exist."""


class OutOfMemoryError(Error, MemoryError):
    """Memory is short, or the limit that `memory` sets would be passed."""

    result = "ERROR_MEMORY"


class WriteError(Error, OSError):
    """The output cannot be written."""

    result = "ERROR_WRITE"


class CancelledError(Error):
    """The progress callback returned False."""

    result = "ERROR_CANCELLED"


class TimeoutError(Error, builtins.TimeoutError):
    """The seconds that `timeout` gave are over."""

    result = "ERROR_TIMEOUT"


class InternalError(Error, RuntimeError):
    """A promise of the library was broken; please report it."""

    result = "ERROR_INTERNAL"


class TargetMissed(UserWarning):
    """The mesh is valid, but a wished target was missed; mesh.report and mesh.certificate say which. A warning: the
    mesh is there. `warnings.simplefilter("error", laves.TargetMissed)` makes it an error."""


_CLASSES = {c.result: c for c in (OptionError, InputError, OutOfMemoryError, WriteError, CancelledError, TimeoutError, InternalError)}


def error_of(result: int, text: str) -> Error:
    """The exception for a result of the library's that is an error."""
    name = _header.ENUMS["laves_result"][result]
    return _CLASSES[name](text or lib.laves_result_text(result).decode())
