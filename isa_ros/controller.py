"""
A user's controller in the lockstep: the state of tick k in, the setpoints of tick k + 1 out.

Independent of ROS; with `isa_ros.nodes.Participant` a controller takes part in a run.
"""

from collections.abc import Mapping, Sequence
from inspect import signature
from typing import Any, NamedTuple

from isa_ros.core.record import attributed, row_record
from isa_ros.core.signals import Records, SAMPLE
from isa_ros.core.suggest import listed
from isa_ros.errors import ConfigError, RunError
import numpy as np
from numpy.typing import ArrayLike, NDArray


class State(NamedTuple):
    """The state of a run at one instant; the next tick overwrites the records."""

    t_ns: int
    actuators: Mapping[str, np.record]
    """`SAMPLE` by actuator: ``state.actuators['knee'].position``; SI, pressures gauge."""
    supplies: Mapping[str, np.record]
    """`SUPPLY_SAMPLE` by supply: ``state.supplies['supply'].pressure``, Pa gauge."""
    bodies: Mapping[str, np.record]
    """
    The sample of each body that actuators move, by its name.

    Of a leg: ``position``, ``velocity``, ``torque`` of its joints, ``foot_force``, ... (3,).
    """
    rows: Records = np.zeros(0, SAMPLE)
    """The same of all actuators, (n_actuators,): ``state.rows['position']`` in their order."""

    @property
    def body(self) -> np.record | None:
        """Return the sample of the only body; None without one, or with several."""
        return only_of(self.bodies)


class Setpoint(NamedTuple):
    """
    The command to one actuator; m, m/s, N, N/m, Ns/m or rad, rad/s, Nm, ...

    With a position it is an impedance setpoint. At most one of ``current``, ``spool`` and
    ``pressure`` is given, the setpoint of the mode of that name.
    """

    position: float | None = None
    """None: not needed by gains alone, nor by an effort in mode force or a mode further in."""
    velocity: float | None = None
    """None: 0, as an effort of None."""
    effort: float | None = None
    """Feed-forward force or torque; the setpoint itself in mode force."""
    stiffness: float | None = None
    """None keeps the gain in force, as does a damping of None."""
    damping: float | None = None
    is_enabled: bool | None = None
    """None leaves the actuator enabled or disabled, as it is."""
    mode: str | None = None
    """current, spool, pressure, force, position or impedance; None keeps the mode."""
    current: float | None = None
    """Of the amplifier, A."""
    spool: float | None = None
    """m."""
    pressure: float | None = None
    """Of chamber A less that of B, Pa."""
    clear_fault: bool = False
    quick_stop: bool = False


class Setpoints(NamedTuple):
    """
    The commands to n actuators at once, numbers or arrays (n,); meaning and units as `Setpoint`.

    A tenth of the time of a mapping from names to `Setpoint`.
    """

    names: Sequence[str]
    position: ArrayLike | None
    velocity: ArrayLike | None = None
    """None: 0, as an effort of None, which is refused where a mode uses it."""
    effort: ArrayLike | None = None
    stiffness: ArrayLike | None = None
    """None keeps the gains in force, as does a damping of None."""
    damping: ArrayLike | None = None

    def of(self, k: int) -> Setpoint:
        """Return the setpoint of the k-th actuator."""
        def own(values: ArrayLike | None) -> float | None:
            if values is None:
                return None
            return float(np.broadcast_to(values, len(self.names))[k])
        return Setpoint(own(self.position), own(self.velocity), own(self.effort),
                        own(self.stiffness), own(self.damping))


class Controller:
    """Base of a user's controller; override `step`, and the other methods as needed."""

    @classmethod
    def of(cls, run: Any, values: Mapping[str, Any], where: str) -> 'Controller':
        """
        Return the controller of a section ``{class: module:Class, ...}`` of a run file.

        ``values`` are its other keys, by default the arguments of the class; ``run`` is the
        `isa_ros.config.runs.run_config.RunConfig`, ``where`` file and key for messages.

        Raises
        ------
        ConfigError
            A value is refused.

        """
        arguments = signature(cls)
        try:
            arguments.bind(**values)
        except TypeError as error:
            takes = listed([own.name for own in arguments.parameters.values()
                            if own.kind in (own.POSITIONAL_OR_KEYWORD, own.KEYWORD_ONLY)])
            raise ConfigError(f'{where}: {cls.__name__} {error}; it takes {takes}') from error
        return cls(**values)

    def start(self, names: Sequence[str]) -> None:
        """Begin anew at t = 0 with actuators of these names, in the order of the run."""

    def step(self, state: State) -> Mapping[str, Setpoint] | Setpoints:
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


def only_rows(rows: Mapping[str, NDArray[np.void]]) -> dict[str, np.record]:
    """Return the only row of each array, (1,), with its fields as attributes, by name."""
    return {name: row_record(own) for name, own in rows.items()}


def only_of(records: Mapping[str, np.record]) -> np.record | None:
    """Return the only record; None without one, or with several."""
    return next(iter(records.values())) if len(records) == 1 else None


def by_name(names: Sequence[str], rows: NDArray[np.void]) -> dict[str, np.record]:
    """Return rows with their fields as attributes, on the same memory, by name."""
    return dict(zip(names, rows.view(attributed(rows.dtype))))
