"""
Tracks: the setpoints of one actuator by tick, SI, with the names of the setpoint topic.

A missing velocity or effort is zero; a missing gain leaves the gain in force unchanged.
"""

from bisect import bisect_right
from dataclasses import field
import math

from isa_ros.actuator.setpoint_range import SetpointRange
from isa_ros.config.text.parameter_sets import as_tree
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.signals import GAINS_OF_COMMAND, HAS_GAINS, HAS_SETPOINT
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.scenario.device_steps import DeviceStep
from isa_ros.scenario.waveforms import Excursion, MAX_EFFORT, OF_SETPOINTS, SetpointMotion
import numpy as np

GAIT = 'gait'
MOTIONS = (*OF_SETPOINTS, GAIT)
_REST = Excursion(0.0, 0.0, 0.0)


@frozen(kw_only=True)
class ImpedanceSetpoint(Parameters):
    """One impedance setpoint, SI."""

    position: float = parameter('equilibrium', 'm | rad', ge=-100.0, le=100.0)
    velocity: float = parameter('of the equilibrium', 'm/s | rad/s', ge=-1e3, le=1e3)
    effort: float = parameter('feed-forward', 'N | Nm', ge=-MAX_EFFORT, le=MAX_EFFORT)


@frozen
class TrackEvent:
    """The command to one actuator at one tick; None leaves a value unchanged."""

    tick: int
    setpoint: ImpedanceSetpoint | None
    stiffness: float | None
    damping: float | None
    motion: SetpointMotion | None
    device: DeviceStep
    limits: SetpointRange | None = field(default=None, compare=False, repr=False)
    """Limits each setpoint to this range; None: no setpoint leaves it, or may."""

    def write(self, tick: int, step_ns: int, row: np.void) -> None:
        """
        Fill the `COMMAND` row of ``tick``, this event's own or a later one of its motion.

        Values of the row that the event does not set are left unchanged.
        """
        if self.setpoint is not None:
            motion = self.motion
            self.write_setpoint(
                _REST if motion is None else motion.at((tick - self.tick) * step_ns), row)
        elif tick == self.tick and self.has_gains:
            row['kinds'] |= HAS_GAINS
            self._write_gains(row)
        if self.limits is not None and int(row['kinds']) & (HAS_SETPOINT | HAS_GAINS):
            self.limits.admit(row)
        if tick == self.tick:
            self.device.write(row)

    def write_setpoint(self, added: Excursion, row: np.void) -> None:
        """Fill a `COMMAND` row with the setpoint at an excursion of the motion."""
        own = self.setpoint
        assert own is not None
        row['kinds'] |= HAS_SETPOINT
        row['position'] = own.position + added.position
        row['velocity'] = own.velocity + added.velocity
        row['effort'] = own.effort + added.effort
        self._write_gains(row)

    @property
    def has_gains(self) -> bool:
        """Return whether it gives a gain."""
        return any(getattr(self, name) is not None for name in GAINS_OF_COMMAND)

    def _write_gains(self, row: np.void) -> None:
        for name in GAINS_OF_COMMAND:
            value = getattr(self, name)
            row[name] = math.nan if value is None else value


@frozen
class Track:
    """The events of one actuator, in ascending order of time."""

    actuator: str
    events: tuple[TrackEvent, ...]

    def at(self, tick: int) -> TrackEvent | None:
        """Return the event of ``tick``, or the earlier one whose motion still runs."""
        k = bisect_right(self.events, tick, key=lambda event: event.tick) - 1
        if k < 0:
            return None
        event = self.events[k]
        return event if event.tick == tick or event.motion is not None else None


def event_tree(event: TrackEvent, step_ns: int) -> Tree:
    """Return an event as a scenario file has it, with its position as a number."""
    tree: Tree = {'t_s': event.tick * step_ns / NS_PER_SECOND}
    if event.setpoint is not None:
        tree |= as_tree(event.setpoint)
    for name in GAINS_OF_COMMAND:
        if getattr(event, name) is not None:
            tree[name] = getattr(event, name)
    tree |= event.device.tree()
    if event.motion is not None:
        tree[motion_key(event.motion)] = event.motion.tree()
    return tree


def motion_key(motion: SetpointMotion) -> str:
    """Return the key that a motion has in its event."""
    return next((name for name, cls in OF_SETPOINTS.items() if isinstance(motion, cls)), GAIT)
