"""
The end of a program: its exit code, and one line about an error.

Importing this module takes neither numba nor ROS: the programs use it before anything else.
"""

from collections.abc import Callable, Iterator
import contextlib
import errno
import gc
import os
import signal
import sys
from types import FrameType
from typing import NoReturn

from isa_ros.errors import IsaError, one_line

DONE, ANSWER_IS_NO, WRONG_INPUT, NOT_COMPLETED, DEFECT, INTERRUPTED = 0, 1, 2, 3, 70, 130
"""Exit codes; subclasses of `IsaError` have their own, for example 4 for divergence."""

REPORT_TO = 'isa_ros maintainers <isa_ros@users.noreply.github.com>'
"""Where a defect is reported: the maintainer in package.xml and setup.py."""

DEBUG_VARIABLE = 'ISA_ROS_DEBUG'
"""Environment variable with which the processes of a run show tracebacks, as with --debug."""

STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Signals that ask a program to end: Ctrl-C, kill, and the end of its terminal."""

_AGAIN_S = 0.02  # the callback has returned by then
_DISK_IS_FULL = (errno.ENOSPC, errno.EDQUOT)
_OWN_PACKAGES = ('isa_ros', 'msg_adapters')
_OUT_OF_MEMORY = ('cannot allocate memory', 'failed to map segment', "can't start new thread",
                  'pthread_create failed')
_ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def run_program(
        name: str, load: Callable[[], Callable[[], int]], interrupted: int = INTERRUPTED) -> int:
    """
    Load a program with ``load``, run it and return its exit code.

    While it is loaded nothing has begun that must be finished: a signal ends the process at once,
    with exit code ``interrupted``. An exception instead could be swallowed by an imported library.
    Nothing is collected meanwhile (`uncollected`).
    """
    def end_at_once(number: int, frame: FrameType | None) -> NoReturn:
        if interrupted:
            with contextlib.suppress(OSError):
                os.write(sys.stderr.fileno(), f'{name}: interrupted\n'.encode())
        os._exit(interrupted)

    try:
        before = replaced_handlers(end_at_once)
        try:
            with uncollected():
                run = load()
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
        sys.unraisablehook = _not_raised
        code = run()
    except (Exception, KeyboardInterrupt) as error:
        code = end_of(name, error)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second Ctrl-C finds nothing to stop
    if code == INTERRUPTED:
        _exit(code)
    return code


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """
    Load what stays until the process ends, and leave it out of all garbage collection.

    Looking through what imports make is a seventh of their time, and once more just after them,
    30 ms.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def _not_raised(ignored: 'sys.UnraisableHookArgs') -> None:
    """Interrupt again where a callback, for example one of LLVM, cannot pass an interrupt on."""
    if ignored.exc_type is KeyboardInterrupt:
        from _thread import interrupt_main
        from threading import Timer
        Timer(_AGAIN_S, interrupt_main).start()
    else:
        sys.__unraisablehook__(ignored)


def _exit(code: int) -> NoReturn:
    """Exit with a code: Python turns it to SIGINT if exec() was interrupted once."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError):
            stream.flush()
    os._exit(code)


Handler = Callable[[int, FrameType | None], object]


def replaced_handlers(handler: Handler) -> dict[int, Handler | int | None]:
    """Set a handler of the `STOPPING` signals, except those that nohup ignores; return others."""
    before: dict[int, Handler | int | None] = {}
    for number in STOPPING:
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            before[number] = signal.signal(number, handler)
    return before


def end_of(program: str, error: BaseException) -> int:
    """
    Print why a program ends, in one line, and return its exit code.

    With `DEBUG_VARIABLE` the traceback is printed before it.
    """
    if os.environ.get(DEBUG_VARIABLE):
        from traceback import print_exception
        print_exception(error)
    code, line = _meaning(error)
    if line:
        with contextlib.suppress(OSError):  # its terminal may be gone
            print(f'{program}: {one_line(line)}', file=sys.stderr, flush=True)
    if isinstance(error, BrokenPipeError):  # the reader of a pipe has closed it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return code


def _meaning(error: BaseException) -> tuple[int, str]:
    """Return exit code and line of an error; without a line it is none."""
    if isinstance(error, IsaError):
        return error.exit_code, str(error)
    if isinstance(error, KeyboardInterrupt):
        return INTERRUPTED, 'interrupted'
    if isinstance(error, BrokenPipeError):
        return DONE, ''
    if _is_out_of_memory(error):
        return NOT_COMPLETED, f'not enough memory ({_first_line(error) or "an allocation failed"})'
    if isinstance(error, OSError):
        where = f'{error.filename}: ' if error.filename else ''
        code = NOT_COMPLETED if error.errno in _DISK_IS_FULL else WRONG_INPUT
        return code, f'{where}{error.strerror or error}'
    if isinstance(error, ModuleNotFoundError) and error.name and (
            error.name.partition('.')[0] not in _OWN_PACKAGES):
        return WRONG_INPUT, (
            f'the Python package {error.name} is missing; source ROS 2 Jazzy, or use ./isa, which '
            'makes an environment')
    return DEFECT, (
        f'a defect of isa_ros, {type(error).__name__}: {error}{_place_of(error)}; please report '
        f'this line to {REPORT_TO}; --debug shows the traceback')


def _first_line(error: BaseException) -> str:
    return str(error).strip().partition('\n')[0]


def _is_out_of_memory(error: BaseException) -> bool:
    if isinstance(error, MemoryError) or getattr(error, 'errno', None) == errno.ENOMEM:
        return True
    text = str(error).lower()
    return isinstance(error, (ImportError, OSError, RuntimeError)) and any(
        words in text for words in _OUT_OF_MEMORY)


def _place_of(error: BaseException) -> str:
    """Return the last line of this package that an error passed through."""
    place, trace = '', error.__traceback__
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if file.startswith(tuple(os.path.join(_ROOT, own) for own in _OWN_PACKAGES)):
            place = f' ({os.path.relpath(file, _ROOT)}:{trace.tb_lineno})'
        trace = trace.tb_next
    return place
