"""A context of the C library, and the calls made with it: progress, cancelling, Ctrl-C, errors.

Each Domain, Sizing, Features and Mesh has a handle of the library's, which belongs to a session. A session ends when it and all of
its handles are gone, in whatever order Python finds them to be garbage."""
import contextlib
import ctypes
import itertools
import signal
import threading
import time

from . import _header, errors
from ._library import lib, text_of

# Seconds between two reports of progress, which cost some microseconds each; a cancel may be heard so much later.
PROGRESS_INTERVAL = 0.02

_CANCELLED = _header.CONSTANTS["LAVES_ERROR_CANCELLED"]
_TARGET_MISSED = _header.CONSTANTS["LAVES_TARGET_MISSED"]

_calls: "dict[int, _Call]" = {}  # that are running, by the number of their session
noted: "list[_Call]" = []  # those to which a Ctrl-C came that is not delivered yet
_numbers = itertools.count(1)


class Deadline:
    """A time limit that several calls share."""

    def __init__(self, seconds):
        self.seconds = seconds
        self.end = time.monotonic() + seconds

    @classmethod
    def of(cls, timeout):
        return timeout if timeout is None or isinstance(timeout, cls) else cls(timeout)


class _Call:
    """One call of the library while it lasts."""

    def __init__(self, progress, timeout, functions):
        self.progress = progress
        self.deadline = Deadline.of(timeout)
        self.functions = functions  # of domains that the library may ask
        self.raised = None  # by the progress callback
        self.expired = False
        self.signal = None  # (number, frame) of a Ctrl-C that came meanwhile, which only the main thread's call can have
        self.handler = None  # Python's handler of it

    def go_on(self, phase, fraction) -> bool:
        """The answer to a report of progress: whether the library shall go on."""
        if self.signal:
            self.deliver_signal()
        if any(f.raised for f in self.functions):
            return False
        if self.deadline and time.monotonic() > self.deadline.end:
            self.expired = True
            return False
        return self.progress is None or self.progress(text_of(phase), fraction) is not False

    def deliver_signal(self):
        number, frame = self.signal
        self.signal = None
        noted.remove(self)
        self.handler(number, frame)  # KeyboardInterrupt, unless the user's handler does otherwise


@_header.laves_progress_fn
def _report(user, phase, fraction):
    call = _calls.get(user)
    if call is None:
        return True
    try:
        goes_on = call.go_on(phase, fraction)
    except BaseException as raised:  # it may not pass through the library; the call raises it in the end
        call.raised = raised
        goes_on = False
    if not goes_on:
        for f in call.functions:
            f.stop()
    return goes_on


def deliver_signals():
    """For callbacks other than that of progress, which may come more seldom where they are slow: to be called where `noted` holds
    something."""
    if threading.current_thread() is threading.main_thread():
        for call in list(noted):
            call.deliver_signal()


@contextlib.contextmanager
def _deferred_interrupt(call):
    """Within, a Ctrl-C is noted, and raised where the library can be told to end: a callback's first instruction is no such place."""
    handler = signal.getsignal(signal.SIGINT) if threading.current_thread() is threading.main_thread() else None
    if not callable(handler):
        yield
        return
    call.handler = handler

    def note(number, frame):
        if call.signal is None:
            noted.append(call)
        call.signal = (number, frame)

    signal.signal(signal.SIGINT, note)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)


class Session:
    """A context.

    threads: threads to use, 0: one per core.  memory: bytes that all objects of the session may hold at once, 0: no limit."""

    def __init__(self, threads: int = 0, memory: int = 0):
        options = lib.laves_context_options_default()
        options.thread_count = _whole("threads", threads)
        options.memory_limit = _whole("memory", memory)
        self.number = next(_numbers)
        options.progress = _report
        options.progress_user = self.number
        options.progress_interval = PROGRESS_INTERVAL
        self.context = lib.laves_context_create(ctypes.byref(options))
        if not self.context:
            raise errors.OutOfMemoryError("there is no memory for a context")
        self._users = 1
        self._count_lock = threading.Lock()
        self._lock = threading.RLock()

    def keep(self):
        with self._count_lock:
            self._users += 1

    def drop(self, free=lib.laves_context_free):
        with self._count_lock:
            self._users -= 1
            last = self._users == 0
        if last:
            free(self.context)

    def __del__(self):
        if hasattr(self, "_lock"):
            self.drop()

    def call(self, function, *arguments, progress=None, timeout=None, functions=()) -> bool:
        """Calls a function of the library whose last argument is a laves_error, which is not to be given.

        Returns True when a target was missed, False when all is done; raises what is wrong."""
        error = _header.laves_error()
        call = _Call(progress, timeout, functions)
        with self._lock:
            if self.number in _calls:
                raise RuntimeError("laves: an object is used by its own callback")
            _calls[self.number] = call
            try:
                with _deferred_interrupt(call), contextlib.ExitStack() as stack:
                    for f in functions:
                        stack.enter_context(f)
                    result = function(*arguments, ctypes.byref(error))
                    raised = call.raised or next((f.raised for f in functions if f.raised), None)
            finally:
                del _calls[self.number]
        if call.signal and not raised:
            call.deliver_signal()
        if raised:
            raise raised
        if call.expired and result == _CANCELLED:
            raise errors.TimeoutError(f"it takes longer than the {call.deadline.seconds:g} seconds that it was given")
        if result > _TARGET_MISSED:
            raise errors.error_of(result, text_of(error.text) or "")
        return result == _TARGET_MISSED

    @property
    def bytes(self) -> int:
        return lib.laves_context_bytes(self.context)

    @property
    def peak_bytes(self) -> int:
        return lib.laves_context_peak_bytes(self.context)


def _whole(name, value) -> int:
    number = int(value)
    if number != value or number < 0:
        raise errors.OptionError(f"{name} must be a whole number, 0 or more, not {value!r}")
    return number


class Handle:
    """An object of the library's, freed when nothing in Python refers to it any more.

    keeps: what it refers to on the other side and must outlive it."""

    def __init__(self, session: Session, pointer, free, keeps=()):
        self.session = session
        self.pointer = pointer
        self.keeps = keeps
        self._free = free
        session.keep()

    def __del__(self):
        if self.pointer:
            self._free(self.pointer)
        self.session.drop()


class MadeByCall:
    """The out pointer of a call that makes an object."""

    def __init__(self):
        self._pointer = ctypes.c_void_p()
        self.argument = ctypes.byref(self._pointer)

    def handle(self, session, free, keeps=()) -> Handle:
        return Handle(session, self._pointer.value, free, keeps)
