"""
A user's controller in the lockstep: the state of tick k in, the setpoints of tick k + 1 out.

Independent of ROS; with `isa_ros.nodes.Participant` a controller takes part in a run.
"""

from collections.abc import Mapping, Sequence
import math
from typing import Any, NamedTuple

from isa_ros.core.signals import HAS_ENABLE, HAS_SETPOINT
from isa_ros.core.suggest import listed, shortened
from isa_ros.errors import RunError, SetpointError
import numpy as np
from numpy.typing import NDArray


class State(NamedTuple):
    """The state of a run at one instant; the next tick overwrites the records."""

    t_ns: int
    actuators: Mapping[str, np.record]
    """`SAMPLE` by actuator: ``state.actuators['knee'].position``; SI, pressures gauge."""
    supplies: Mapping[str, np.record]
    """`SUPPLY_SAMPLE` by supply: ``state.supplies['supply'].pressure``, Pa gauge."""
    body: np.record | None
    """
    The sample of the body that the actuators move, None without one.

    Of a leg: ``position``, ``velocity``, ``torque`` of its joints, ``foot_force``, ... (3,).
    """


class Setpoint(NamedTuple):
    """The impedance setpoint of one actuator; m, m/s, N, N/m, Ns/m or rad, rad/s, Nm, ..."""

    position: float
    velocity: float = 0.0
    effort: float = 0.0
    """Feed-forward force or torque."""
    stiffness: float | None = None
    """None keeps the gain in force, as does a damping of None."""
    damping: float | None = None
    is_enabled: bool | None = None
    """None leaves the actuator enabled or disabled, as it is."""


_GAINS = ('stiffness', 'damping')
_NUMBERS = ('position', 'velocity', 'effort', *_GAINS)


class Controller:
    """Base of a user's controller; override `step`, and the other methods as needed."""

    def start(self, names: Sequence[str]) -> None:
        """Begin anew at t = 0 with actuators of these names, in the order of the run."""

    def step(self, state: State) -> Mapping[str, Setpoint]:
        """
        Return the setpoints that take effect one tick after ``state``, by actuator.

        An actuator that is left out keeps its setpoint. The result must depend only on the
        states since `start`, otherwise the run cannot be repeated.
        """
        raise NotImplementedError

    def snapshot(self) -> bytes:
        """Return the whole state of the controller; needed only for saving a run."""
        raise RunError(f'{type(self).__name__} has no snapshot(), so the run cannot be saved')

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`."""
        raise RunError(f'{type(self).__name__} has no restore(), so the run cannot continue')


def fill_requests(
        setpoints: Mapping[str, Setpoint], names: Sequence[str],
        requests: NDArray[np.void]) -> None:
    """
    Write setpoints into the `COMMAND` rows of the actuators ``names``, shape (n_actuators,).

    Raises
    ------
    SetpointError
        An actuator that the run does not have, or an invalid value.

    """
    if not isinstance(setpoints, Mapping):
        raise SetpointError(f'{_quoted(setpoints)} are no setpoints by actuator')
    for name, setpoint in setpoints.items():
        if name not in names:
            raise SetpointError(
                f'{_quoted(name)} is not an actuator of the run; valid: {listed(names)}')
        if not isinstance(setpoint, tuple) or len(setpoint) != len(Setpoint._fields):
            raise SetpointError(f'{name}: {_quoted(setpoint)} is not a Setpoint')
        values: Sequence[Any] = setpoint
        for field, value in zip(_NUMBERS, values):
            if value is None and field in _GAINS:
                continue
            try:
                is_valid = math.isfinite(value) and (value >= 0.0 or field not in _GAINS)
            except (TypeError, OverflowError):
                raise _refusal(name, field, value, 'a number') from None
            if not is_valid:
                raise _refusal(name, field, value, '>= 0' if math.isfinite(value) else 'finite')
        position, velocity, effort, stiffness, damping, is_enabled = setpoint
        if is_enabled is not None and not isinstance(is_enabled, (bool, np.bool_)):
            raise _refusal(name, 'is_enabled', is_enabled, 'True or False')
        requests[names.index(name)] = (
            HAS_SETPOINT if is_enabled is None else HAS_SETPOINT | HAS_ENABLE, bool(is_enabled),
            position, velocity, effort, math.nan if stiffness is None else stiffness,
            math.nan if damping is None else damping, 0)


def _refusal(name: str, field: str, value: Any, bound: str) -> SetpointError:
    return SetpointError(f'{name}: setpoint {field} = {_quoted(value)}, must be {bound}')


def _quoted(value: Any) -> str:
    return shortened(repr(value))


def merge_requests(requests: NDArray[np.void], into: NDArray[np.void]) -> None:
    """Overwrite rows of ``into`` with those `COMMAND` rows of a controller that hold a command."""
    for row, kinds in enumerate(requests['kinds'].tolist()):
        if kinds:
            into[row] = requests[row]


def by_name(names: Sequence[str], rows: NDArray[np.void]) -> dict[str, np.record]:
    """Return rows with their fields as attributes, on the same memory, by name."""
    return dict(zip(names, rows.view(np.recarray)))


class ControllerSeat:
    """One controller of a run: shows it the state, and takes what it asks for."""

    def __init__(self, controller: Controller, names: Sequence[str]) -> None:
        self.controller = controller
        self.names = list(names)
        controller.start(self.names)

    def step(self, state: State, requests: NDArray[np.void]) -> None:
        """
        Write into ``requests`` what takes effect one tick after ``state``.

        They are `COMMAND` rows of the actuators, (n_actuators,); those that the controller leaves
        out are unchanged.
        """
        fill_requests(self.controller.step(state), self.names, requests)
