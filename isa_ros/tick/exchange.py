"""Rows that surroundings, actuators and controllers exchange at a tick; who carries and takes."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol, TYPE_CHECKING

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.rows import memory_of
from isa_ros.core.bound import Part
from isa_ros.core.record import floats
from isa_ros.core.signals import COMMAND, LOAD_PORT, Records
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:   # an actuator has rows too, and no surroundings
    from isa_ros.surroundings.surroundings import Surroundings

IDLE_S = 0.005
"""Host time between two checks for requests while a run is paused."""


class PublishedRows(NamedTuple):
    """The rows that the messages are packed from; the same memory over a whole run."""

    samples: Records
    """`SAMPLE`, (n,)."""
    applied: Records
    """`COMMAND` that took effect at the tick's start, kinds 0 without one, (n,)."""
    supplies: Records
    """`SUPPLY_SAMPLE`, (m,)."""
    bodies: Mapping[str, Records]
    """Sample of each body by name, (1,), a record of floats."""
    sent: Records | None = None
    """`COMMAND` handed to the links at the tick's start, (n,); None: no links."""


class Rows:
    """
    The memory of one run's exchange, a row per actuator, (n_actuators,) each.

    Overwritten at every tick; copy rows to keep them. Those that actuators write are
    the rows of their ``group`` in this process; None: the actuators are in others.
    """

    def __init__(
            self, n_actuators: int, surroundings: 'Surroundings',
            group: ActuatorGroup | None = None) -> None:
        written = memory_of(n_actuators) if group is None else group
        self.ports: Records = (
            np.zeros(n_actuators, LOAD_PORT) if group is None else group.ticked.ports)
        """Boundary values of the tick, from the surroundings to the actuators."""
        self.feeds: Records = written.feeds
        """Ports of the supplies, from the surroundings to the actuators; zeros without."""
        self.has_supply_ports = surroundings.has_supply_ports
        """Whether a supply has one."""
        self.fed: Records = written.fed
        """What actuators answered to them, at the end of the tick."""
        self.commands: Records = (
            np.zeros(n_actuators, COMMAND) if group is None else group.ticked.commands)
        """Commands that take effect at the tick's start."""
        self.replies: Records = written.replies
        """Results of the tick, from the actuators to the surroundings."""
        self.samples: Records = written.observed
        """
        Samples at the tick's start; once the actuators have answered, at its end.

        Behind a link the newest that has arrived.
        """
        self.applied: Records = written.applied
        """Commands that took effect in the last tick; kinds 0 without one."""
        self.sent: Records = written.sent
        """Commands handed to the links at the last tick's start; kinds 0 without one."""
        self.tuned: Mapping[int, Mapping[str, float]] = {}
        """Parameters that changed at the start of the last tick, SI, by row and name."""
        self.tuned_supplies: Mapping[str, float] = {}
        """Those of the supplies, by SUPPLY.KEY."""
        self.changes: Mapping[int, Mapping[str, float]] = {}
        """Parameters that faults change at the tick's start, by row and name."""
        self.requests: Records = np.zeros(n_actuators, COMMAND)
        """Commands of the controllers, to take effect at the next tick."""
        self.supplies: Records = surroundings.supplies
        """`SUPPLY_SAMPLE` of the supplies; memory of the surroundings."""
        self.bodies: Mapping[str, Records] = {
            name: body.sample for name, body in surroundings.bodies.items()}
        """Sample of each body by name, (1,); memory of the bodies."""
        self.published = PublishedRows(
            self.samples, self.applied, self.supplies, self.bodies, self.sent)
        """The rows that the messages are packed from."""
        self.reply_values, self.sample_values = floats(self.replies), floats(self.samples)
        """The same memory as plain floats."""
        self._command_bytes = self.commands.view(np.uint8).data
        self._request_bytes = self.requests.view(np.uint8).data
        self._no_requests = bytes(self.requests.nbytes)

    @property
    def has_requests(self) -> bool:
        """Return whether a controller requests something for the next tick."""
        return bool(self._request_bytes != self._no_requests)

    def take_requests(self) -> None:
        """Make the requests the commands of this tick, and begin with no requests."""
        self._command_bytes[:] = self._request_bytes
        self._request_bytes[:] = self._no_requests

    def clear_requests(self) -> None:
        """Forget the requests."""
        self._request_bytes[:] = self._no_requests


class Ends(Protocol):
    """
    The actuators at the other end of quiet ticks: kernels that carry these out.

    They are run in each tick, in their order.
    """

    @property
    def parts(self) -> Sequence[Part]:
        """Return the kernels."""
        ...

    @property
    def is_settled(self) -> bool:
        """Return whether no parameter changed at the last tick, or changes at the next."""
        ...

    def begin_quiet(self, tick: int) -> None:
        """Get ready for the tick that begins after ``tick`` ones."""
        ...

    def end_quiet(self, tick: int, n_ticks: int, place: int) -> bool:
        """
        Take note of so many ticks after ``tick`` ones that all parts have carried out.

        ``place`` is that of the part which has ended the tick after them; below 0: none has run.
        Return whether that tick has begun and `Transport.receive` has to end it.
        """
        ...


class Transport(Protocol):
    """Connection to the actuators and controllers, in this process or in others."""

    @property
    def group(self) -> ActuatorGroup | None:
        """Return the actuators if they are in this process, for `Rows`."""
        ...

    @property
    def is_quiet(self) -> bool:
        """Return whether nothing but the actuators has to be looked at in each tick."""
        ...

    @property
    def ends(self) -> Ends | None:
        """Return what carries out quiet ticks; None: nothing does, or not yet."""
        ...

    def join(self, rows: Rows) -> None:
        """
        Wait until every participant is ready at t = 0.

        Fills their samples and applied commands. A second call begins another run.

        Raises
        ------
        ConfigError
            A participant has other parameters, or takes part in another run.
        RunError
            A participant did not answer in time.

        """
        ...

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """
        After `join`, restore the state of every participant before ``tick``; raises as `join`.

        ``snapshots`` come from `snapshots`.
        """
        ...

    def begin(self) -> None:
        """Make every participant publish its first messages; the time is already published."""
        ...

    def send(self, tick: int, rows: Rows) -> None:
        """Start the tick: send changes, ports, commands, and the samples to the controllers."""
        ...

    def receive(self, rows: Rows) -> None:
        """
        Wait for all participants; fill replies, samples, applied, tuned and requests.

        Raises
        ------
        RunError
            A participant failed or did not answer in time.
        SimulationDiverged
            The state of an actuator is no longer finite.
        Interrupted
            A stop was requested and the tick did not end.

        """
        ...

    def idle(self, seconds: float = IDLE_S) -> None:
        """
        Wait for a moment while the run waits; process the inputs of actuators in this process.

        Raises
        ------
        RunError
            A participant failed.

        """
        ...

    def snapshots(self) -> list[bytes]:
        """
        Return the complete state of each participant, in their order.

        Raises
        ------
        RunError
            A participant failed, did not answer in time, or cannot be saved.

        """
        ...


class RowSink:
    """Takes the rows of a run at each instant; override `take`, and other methods as needed."""

    def take_time(self, tick: int) -> None:
        """Take the time t = ``tick`` step_ns, before all else of that instant."""

    def take(self, tick: int, rows: Rows) -> None:
        """Take the rows at t = ``tick`` step_ns; the next tick overwrites them."""

    def quiet_ticks(self, tick: int) -> int:
        """
        Return how many ticks after ``tick`` ones it can take by kernels, if these are quiet.

        The rows of ``tick`` were taken. A sink that needs to be called at each returns 0.
        """
        return 0

    def takes_applied(self, expected: NDArray[np.bool_]) -> bool:
        """
        Return whether its kernels take ticks in which commands of some actuators are applied.

        ``expected`` are these in the next quiet ticks, (n,).
        """
        return not expected.any()

    def begin_quiet(
            self, tick: int, most: int, clock: NDArray[np.int64]) -> tuple[int, Sequence[Part]]:
        """
        Return for how many quiet ticks after ``tick`` it is ready, and what takes their rows.

        The kernels find nothing; ``clock`` has the finished ticks and the tick in ns.
        """
        return most, ()

    def end_quiet(self, tick: int, n_ticks: int) -> None:
        """Take note that the kernels have taken the rows of so many ticks after ``tick``."""

    def add_event(self, tick: int, text: str) -> None:
        """Take an event before ``tick``: a pause, a step, a reset."""

    def record(self) -> None:
        """Finish with the last rows, while the actuators compute the next ones."""

    def end(self) -> None:
        """Finish with the last rows of the run."""
