"""Controllers that a run calls by itself, in the process of its ticks."""

from collections.abc import Sequence

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.controller import by_name, Controller, only_rows, State
from isa_ros.core.signals import COMMAND, Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, RunError, SetpointError
from isa_ros.requests import fill_requests, merge_requests
from isa_ros.surroundings.callers import at_step, failures_of
from isa_ros.tick.exchange import IDLE_S, Rows, Transport
import numpy as np


class CallingTransport:
    """
    A `Transport` that calls ``controllers`` too, while actuators in other processes compute.

    ``names`` are those of the actuators and ``supplies`` those of the supplies, in the order of
    their rows. Where they request the same actuator as a node does, theirs is taken.
    ``called`` is how messages call the first controllers; the others have the name of their class.

    Every method raises `RunError` if a controller fails or returns no setpoints.
    """

    def __init__(
            self, transport: Transport, controllers: Sequence[Controller], names: Sequence[str],
            supplies: Sequence[str], step_ns: int, called: Sequence[str] = ()) -> None:
        self._transport, self._controllers = transport, tuple(controllers)
        self._called = [*called, *(type(own).__name__ for own in controllers[len(called):])]
        self._names, self._supplies, self._step_ns = list(names), supplies, step_ns
        self._requests: Records = np.zeros(len(names), COMMAND)
        self.group = transport.group
        self.is_quiet, self.ends = False, None
        self.begin = transport.begin

    def join(self, rows: Rows) -> None:
        """Start all at t = 0."""
        self._transport.join(rows)
        self._state = State(
            0, by_name(self._names, rows.samples), by_name(self._supplies, rows.supplies),
            only_rows(rows.bodies), rows.samples)
        for called, controller in zip(self._called, self._controllers):
            with failures_of(f'{called}.start'):
                controller.start(list(self._names))

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """Restore all participants from their snapshots, those of the controllers last."""
        first = len(snapshots) - len(self._controllers)
        if first < len(self._names):
            raise ConfigError(
                f'the saved state has {len(snapshots)} participants, the run has '
                f'{len(self._names) + len(self._controllers)}')
        self._transport.restore(tick, snapshots[:first], rows)
        for called, controller, own in zip(
                self._called, self._controllers, snapshots[first:]):
            with failures_of(f'{called}.restore'):
                controller.restore(own)

    def send(self, tick: int, rows: Rows) -> None:
        """Start the tick of the others, then call the controllers with the state before it."""
        self._transport.send(tick, rows)
        self._requests['kinds'] = 0
        state = self._state._replace(t_ns=tick * self._step_ns)
        for called, controller in zip(self._called, self._controllers):
            where = f'{called}.step at t = {state.t_ns / NS_PER_SECOND:g} s'
            with failures_of(where):
                setpoints = controller.step(state)
            try:
                fill_requests(setpoints, self._names, self._requests, state.actuators)
            except SetpointError as error:
                raise RunError(f'{where}: {at_step(error, controller)}') from error

    def receive(self, rows: Rows) -> None:
        """Wait for the others, then add the requests of the controllers."""
        self._transport.receive(rows)
        merge_requests(self._requests, rows.requests)

    def idle(self, seconds: float = IDLE_S) -> None:
        """Wait for a moment while the run waits."""
        self._transport.idle(seconds)

    def snapshots(self) -> list[bytes]:
        """Return the state of every participant, those of the controllers last."""
        states = list(self._transport.snapshots())
        for called, controller in zip(self._called, self._controllers):
            with failures_of(f'{called}.snapshot'):
                states.append(controller.snapshot())
        return states


def calling(run: RunConfig, transport: Transport) -> Transport:
    """
    Return the transport with the controllers that a run calls by itself.

    Raises
    ------
    ConfigError
        One of them cannot be made.

    """
    if not run.called:
        return transport
    return CallingTransport(
        transport, [own.made(run) for own in run.called], [own.name for own in run.actuators],
        [own.name for own in run.sampled_supplies], run.step_ns,
        [own.called for own in run.called])
