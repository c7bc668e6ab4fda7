"""Controllers that a run calls by itself, in the process of its ticks."""

from collections.abc import Sequence

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.controller import (
    by_name, Controller, fill_requests, merge_requests, only_rows, State)
from isa_ros.core.signals import COMMAND, Records
from isa_ros.errors import ConfigError
from isa_ros.tick.exchange import IDLE_S, Rows, Transport
import numpy as np


class CallingTransport:
    """
    A `Transport` that calls ``controllers`` too, while actuators in other processes compute.

    ``names`` are those of the actuators and ``supplies`` those of the supplies, in the order of
    their rows. Where they request the same actuator as a node does, theirs is taken.
    """

    def __init__(
            self, transport: Transport, controllers: Sequence[Controller], names: Sequence[str],
            supplies: Sequence[str], step_ns: int) -> None:
        self._transport, self._controllers = transport, tuple(controllers)
        self._names, self._supplies, self._step_ns = list(names), supplies, step_ns
        self._requests: Records = np.zeros(len(names), COMMAND)
        self.group = transport.group
        self.begin = transport.begin

    def join(self, rows: Rows) -> None:
        """Start all at t = 0."""
        self._transport.join(rows)
        self._state = State(
            0, by_name(self._names, rows.samples), by_name(self._supplies, rows.supplies),
            only_rows(rows.bodies), rows.samples)
        for controller in self._controllers:
            controller.start(list(self._names))

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """Restore all participants from their snapshots, those of the controllers last."""
        first = len(snapshots) - len(self._controllers)
        if first < len(self._names):
            raise ConfigError(
                f'the saved state has {len(snapshots)} participants, the run has '
                f'{len(self._names) + len(self._controllers)}')
        self._transport.restore(tick, snapshots[:first], rows)
        for controller, own in zip(self._controllers, snapshots[first:]):
            controller.restore(own)

    def send(self, tick: int, rows: Rows) -> None:
        """Start the tick of the others, then call the controllers with the state before it."""
        self._transport.send(tick, rows)
        self._requests['kinds'] = 0
        state = self._state._replace(t_ns=tick * self._step_ns)
        for controller in self._controllers:
            fill_requests(
                controller.step(state), self._names, self._requests, state.actuators)

    def receive(self, rows: Rows) -> None:
        """Wait for the others, then add the requests of the controllers."""
        self._transport.receive(rows)
        merge_requests(self._requests, rows.requests)

    def idle(self, seconds: float = IDLE_S) -> None:
        """Wait for a moment while the run waits."""
        self._transport.idle(seconds)

    def snapshots(self) -> list[bytes]:
        """Return the state of every participant, those of the controllers last."""
        return [*self._transport.snapshots(),
                *(controller.snapshot() for controller in self._controllers)]


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
        [own.name for own in run.sampled_supplies], run.step_ns)
