"""Code and numbers of a caller: failures with their place, arrays with a number per actuator."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
import traceback

from isa_ros.errors import ConfigError, IsaError, RunError
import numpy as np
from numpy.typing import ArrayLike, NDArray


@contextmanager
def failures_of(function: str) -> Iterator[None]:
    """Raise `RunError` with the place in the caller's code where it fails, or ends the program."""
    try:
        yield
    except IsaError:
        raise
    except (Exception, SystemExit) as error:
        raise RunError(f'{function}: {cause_of(error)}') from error


def cause_of(error: BaseException) -> str:
    """Return an error as one line, with the place where it was raised."""
    said = ' '.join(str(error).split())
    shown = f'{type(error).__name__}: {said}' if said else type(error).__name__
    if isinstance(error, SyntaxError):      # its text has the place
        return shown
    frames = traceback.extract_tb(error.__traceback__)
    place = next((one for one in reversed(frames) if not one.filename.startswith('<')), frames[-1])
    return f'{shown} ({Path(place.filename).name}:{place.lineno})'


def at_step(error: IsaError, controller: object) -> str:
    """Return an error about what a controller returned, with the place where its step begins."""
    controller = getattr(controller, '__wrapped__', controller)
    code = getattr(getattr(controller, 'step', None), '__code__', None)
    return f'{error} ({Path(code.co_filename).name}:{code.co_firstlineno})' if code else str(error)


def numbers_of(names: Sequence[str], what: str, given: ArrayLike) -> NDArray[np.float64]:
    """
    Return an array with a finite number for each of k actuators, (k,).

    Raises
    ------
    ConfigError
        It has another shape, or a number is not finite; ``what`` says what is given.

    """
    values = np.asarray(given, float)
    if values.shape != (len(names),):
        raise ConfigError(
            f'{what} has the shape {values.shape}, must have ({len(names)},): one number for each '
            f'of {", ".join(names)}')
    if not np.isfinite(values).all():
        broken = int(np.flatnonzero(~np.isfinite(values))[0])
        raise ConfigError(f'{names[broken]}: {what} = {values[broken]}, must be finite')
    return values
