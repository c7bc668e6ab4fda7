"""An actuator whose steps the compiled loop answers, beside its twin in Python."""

from dataclasses import replace
import socket
import struct

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.nodes.lockstep.sockets import LARGEST
from isa_ros.run.wire.answer_loop import AnswerLoop
from isa_ros.run.wire.answering import Ended
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.parts import actuator_parts
from isa_ros.run.wire.steps import decode_step, encode_tick
from isa_ros.tick.exchange import Rows
import numpy as np
from tests.actuator.linked import link_of
from tests.run.filled import filled

RUN, INDEX, N = 0x1234_5678_9ABC_DEF0, 1, 3
FAR_NS = 2**62          # of the host's clock: never due


def made(is_linked: bool = False) -> SmartActuator:
    config: ConfiguredActuator = default_actuator('isa_v5', 'kfe')
    sheet = replace(config.sheet, link=link_of(delay_cycles=2.0)) if is_linked else config.sheet
    actuator = SmartActuator(replace(config, sheet=sheet, load=None), DEFAULT_TIMING)
    actuator.start(0.01, 0.0, 20.7e6, 0.0)
    for _ in range(3):      # until its first parameters are in force
        actuator.tick(step_rows(0).ports[INDEX])
    return actuator


def step_rows(tick: int, has_feed: bool = False, target: float | None = None) -> Rows:
    """Return the rows of a tick, different for each actuator and tick."""
    rows = filled(N, bodies={})
    rows.ports.view(np.float64)[:] = 0.0
    rows.ports['x0'] = 0.01 + 1e-8 * np.arange(N) + 1e-9 * (tick % 100)
    rows.ports['v0'] = 1e-6
    rows.ports['inverse_mass'] = 0.01 * (1.0 + np.arange(N))
    rows.ports['supply_pressure'] = 20.7e6 - 1e4 * (tick % 100)
    rows.commands['kinds'] = HAS_SETPOINT
    rows.commands['position'], rows.commands['due_step'] = 0.03, 0
    for name in 'velocity', 'effort', 'stiffness', 'damping':
        rows.commands[name] = 0.0 if name in ('velocity', 'effort') else np.nan
    rows.commands['position'][INDEX] = 0.0 if target is None else target
    rows.commands['kinds'][INDEX] = 0 if target is None else HAS_SETPOINT
    rows.has_supply_ports = has_feed
    rows.feeds.view(np.float64)[:] = 0.0
    rows.feeds['elastance'], rows.feeds['share'] = 1e9 * (1.0 + np.arange(N)), 1.0
    return rows


def encoded(tick: int, **changed: object) -> bytes:
    return encode_tick(RUN, tick, step_rows(tick, **changed), False)


class Bench:
    """An actuator in the loop, a twin of it in Python, and the coordinator's socket."""

    def __init__(self, has_feed: bool = False, is_linked: bool = False) -> None:
        self.actuator, self.twin = made(is_linked), made(is_linked)
        self.has_feed = has_feed
        self.coordinator, self.end = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.coordinator.settimeout(10.0)
        self.end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, struct.pack('@ll', 0, 20_000))
        self.loop = AnswerLoop(self.actuator.ticked, self.actuator.advance, LARGEST)
        self.loop.expect(decode_step(encoded(7, has_feed=has_feed)), INDEX, has_feed)

    def run(self, tick: int, most: int = 1, until_ns: int = FAR_NS,
            keeps: bool = False) -> Ended:
        return self.loop.run(self.end.fileno(), tick, until_ns, most, keeps)

    def by_python(self, tick: int, target: float | None = None) -> bytes:
        """Return what Python answers to a tick."""
        rows, twin = step_rows(tick, self.has_feed, target), self.twin
        if target is not None:
            twin.accept(rows.commands[INDEX])
        if self.has_feed:
            twin.memory.feeds[0] = rows.feeds[INDEX]
        twin.tick(rows.ports[INDEX])
        own = twin.memory
        return encode_answer(AnswerKind.DONE, RUN, tick, INDEX, actuator_parts(
            own.replies, own.observed, own.applied, {}, own.sent,
            own.fed if self.has_feed else None))


def closed(bench: Bench) -> None:
    bench.coordinator.close()
    bench.end.close()
