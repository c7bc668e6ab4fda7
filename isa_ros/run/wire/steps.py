"""Steps: the messages of the coordinator."""

from collections.abc import Mapping, Sequence
from enum import IntEnum
import struct
from typing import NamedTuple

from isa_ros.core.device import MODES
from isa_ros.core.signals import COMMAND, LOAD_PORT, Records, SAMPLE, START, SUPPLY_PORT
from isa_ros.run.wire.header import opened, prefix, VERSION, WireError
from isa_ros.run.wire.parts import (
    is_finite, joined, Parts, refuse_command, split, tuned_of, tuned_part)
from isa_ros.run.wire.roster import Roster
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.exchange import PublishedRows, Rows
import numpy as np

STEP_TOPIC = '_isa/step'
"""Relative: of the namespace of the nodes."""

_STEP = struct.Struct('<IIIIHHIQq')  # prefix; version, kind, rows, run id, tick
HEADER_BYTES = _STEP.size
_NUMBER = struct.Struct('<q')
_LARGEST_STEP_NS = 1_000_000_000
_MODES = frozenset(map(float, range(len(MODES))))
_TICK = LOAD_PORT.itemsize + COMMAND.itemsize   # of an actuator


class StepKind(IntEnum):
    """Kinds of messages from the coordinator."""

    HELLO = 1
    """Call of the listed participants: answer and start at t = 0; ``tick`` counts the hellos."""
    TICK = 2
    END = 3
    """The run has ended; the next hello may begin another."""
    BEGIN = 4
    """Publish the first messages: all participants are ready and `/clock` is published. Sent again
    while the run continues without ticks on the topic. It names the nodes that are the
    participants, by their identities; answered by others of their names only."""
    SAVE = 5
    """Answer with the complete state before the next tick; ``tick`` is a number below 0, different
    for each request, so that answers can be assigned to their request."""
    RESTORE = 6
    """Continue from the state before the tick given in the body; ``tick`` as in a save."""
    CHANGE = 7
    """Change parameters at the start of the next tick; ``tick`` as in a save."""


# Calling an enumeration takes about a microsecond per tick; a dictionary a twentieth of it.
_STEP_KINDS = {int(kind): kind for kind in StepKind}


class Step(NamedTuple):
    """One message of the coordinator."""

    kind: StepKind
    run_id: int
    tick: int
    rows: int
    body: bytes

    def header(self) -> bytes:
        """Return the bytes before the body."""
        return _header(self.kind, self.run_id, self.tick, self.rows, len(self.body))

    def roster(self) -> Roster:
        """Return the participants that a hello calls: ``rows`` actuators first."""
        return Roster.decode(self.body[_NUMBER.size + self.rows * START.itemsize:])

    def step_ns(self) -> int:
        """Return the length of a tick from a hello."""
        return int(_NUMBER.unpack_from(self.body)[0])

    def start(self, index: int) -> np.void:
        """Return the `START` row of one actuator."""
        return self._row(START, _NUMBER.size + index * START.itemsize)

    def port(self, index: int) -> np.void:
        """Return the `LOAD_PORT` row of one actuator."""
        return self._row(LOAD_PORT, index * LOAD_PORT.itemsize)

    def command(self, index: int) -> np.void:
        """Return the `COMMAND` row of one actuator."""
        return self._row(COMMAND, self.rows * LOAD_PORT.itemsize + index * COMMAND.itemsize)

    def feed(self, index: int) -> np.void:
        """Return the `SUPPLY_PORT` row of one actuator, in a run that has such ports."""
        return self._row(SUPPLY_PORT, self.rows * _TICK + index * SUPPLY_PORT.itemsize)

    def state(self, roster: Roster) -> PublishedRows:
        """Return the rows that controllers receive: the state before a tick, nothing applied."""
        at = self.rows * _size_of_row(roster)
        samples = np.frombuffer(self.body, SAMPLE, self.rows, at)
        at += samples.nbytes
        supplies = np.frombuffer(self.body, SUPPLY_SAMPLE, len(roster.supplies), at)
        at += supplies.nbytes
        bodies = {}
        for name, record in roster.bodies.items():
            bodies[name] = np.frombuffer(self.body, record, 1, at)
            at += record.itemsize
        return PublishedRows(samples, np.zeros(self.rows, COMMAND), supplies, bodies)

    def _row(self, record: np.dtype[np.void], offset: int) -> np.void:
        row: np.void = np.frombuffer(self.body, record, 1, offset)[0]
        return row

    def restored_tick(self) -> int:
        """Return the tick before which a restored run continues."""
        return int(_NUMBER.unpack_from(self.body)[0])

    def snapshot(self, index: int) -> bytes:
        """Return the state from which one participant continues."""
        return split(self.body[_NUMBER.size:], self.rows)[index] or b''

    def identity(self, index: int) -> bytes | None:
        """Return which node is a participant of a run that begins."""
        return split(self.body, self.rows)[index]

    def changes(self, index: int) -> dict[str, float]:
        """Return the parameters of one actuator that change at the next tick."""
        part = split(self.body, self.rows)[index]
        return {} if part is None else tuned_of(part)

    def refuse_tick(self, n_actuators: int, index: int) -> None:
        """
        Refuse a tick that the actuator at ``index`` of a run with ``n_actuators`` cannot execute.

        Raises
        ------
        WireError
            It is of another run, or has a number that is not finite.

        """
        if self.rows != n_actuators:
            raise WireError(f'a tick of {self.rows} actuators, must be {n_actuators}')
        at = index * LOAD_PORT.itemsize
        if not is_finite(np.frombuffer(self.body, np.float64, LOAD_PORT.itemsize // 8, at)):
            raise WireError('a tick with a number that is not finite')
        refuse_command(self.command(index))

    def refuse_feed(self, index: int) -> None:
        """Refuse a tick without a valid `SUPPLY_PORT` for an actuator; as `refuse_tick`."""
        at = self.rows * _TICK + index * SUPPLY_PORT.itemsize
        if len(self.body) < self.rows * (_TICK + SUPPLY_PORT.itemsize):
            raise WireError('a tick without the ports of the supplies')
        if not is_finite(np.frombuffer(
                self.body, np.float64, SUPPLY_PORT.itemsize // 8, at)):
            raise WireError('a tick with a number that is not finite')

    def refuse_state(self, n_actuators: int, roster: Roster) -> None:
        """Refuse a tick that does not show a controller the state of its run; `refuse_tick`."""
        at = n_actuators * _size_of_row(roster)
        size = n_actuators * SAMPLE.itemsize + len(roster.supplies) * SUPPLY_SAMPLE.itemsize + sum(
            record.itemsize for record in roster.bodies.values())
        if self.rows != n_actuators or len(self.body) != at + size:
            raise WireError(f'a tick of {len(self.body)} bytes, must be {at + size}')
        if not is_finite(np.frombuffer(self.body, np.float64, size // 8, at)):
            raise WireError('a tick with a number that is not finite')
        modes = np.frombuffer(self.body, SAMPLE, n_actuators, at)['device_mode'].tolist()
        if not _MODES.issuperset(modes):
            raise WireError(f'a tick with a mode that there is not, of {modes}')

    def refuse_change(self, n_participants: int) -> None:
        """Refuse changes of another number of participants; as `refuse_tick`."""
        if self.rows != n_participants:
            raise WireError(
                f'changes of {self.rows} participants, must be of {n_participants}')

    def refuse_begin(self, n_participants: int) -> None:
        """Refuse a begin of another number of participants; as `refuse_tick`."""
        if self.rows != n_participants:
            raise WireError(
                f'a begin of {self.rows} participants, must be of {n_participants}')

    def refuse_restore(self, n_participants: int) -> None:
        """Refuse a request to restore another number of participants; as `refuse_tick`."""
        if self.rows != n_participants or self.restored_tick() < 0:
            raise WireError(
                f'a request to restore {self.rows} participants, must be {n_participants}')


def encode_hello(
        run_id: int, count: int, step_ns: int, starts: Records, roster: Roster) -> bytes:
    """Return the bytes of the ``count``-th hello; ``starts`` are the actuators' `START`, (n,)."""
    return _step(
        StepKind.HELLO, run_id, count, len(starts),
        _NUMBER.pack(step_ns) + starts.tobytes() + roster.encode())


def encode_tick(run_id: int, tick: int, rows: Rows, has_controllers: bool) -> bytes:
    """Return the bytes of one tick: ports and commands, for controllers also the samples."""
    body = b''.join(part.tobytes() for part in parts_of_tick(rows, has_controllers))
    return _step(StepKind.TICK, run_id, tick, len(rows.ports), body)


def parts_of_tick(rows: Rows, has_controllers: bool) -> list[Records]:
    """Return what the body of a tick consists of; `Step` has the inverse."""
    parts = [rows.ports, rows.commands]
    if rows.has_supply_ports:
        parts.append(rows.feeds)
    if has_controllers:
        parts += [rows.samples, rows.supplies, *rows.bodies.values()]
    return parts


def _size_of_row(roster: Roster) -> int:
    """Return the bytes of one actuator in a tick, before what controllers are shown."""
    return _TICK + (SUPPLY_PORT.itemsize if roster.has_supply_ports else 0)


def encode_begin(run_id: int, identities: Parts) -> bytes:
    """Return the bytes of a begin, with the identity of each participant of another process."""
    return _step(StepKind.BEGIN, run_id, 0, len(identities), joined(identities))


def encode_save(run_id: int, number: int) -> bytes:
    """Return the bytes that request the state before the next tick; see `StepKind.SAVE`."""
    return _step(StepKind.SAVE, run_id, number, 0, b'')


def encode_restore(run_id: int, number: int, tick: int, snapshots: Sequence[bytes]) -> bytes:
    """Return the bytes that restore every participant before ``tick``; see `StepKind.RESTORE`."""
    body = _NUMBER.pack(tick) + joined(snapshots)
    return _step(StepKind.RESTORE, run_id, number, len(snapshots), body)


def encode_change(
        run_id: int, number: int, changes: Mapping[int, Mapping[str, float]],
        n_participants: int) -> bytes:
    """Return the bytes that change parameters at the next tick, by participant."""
    body = joined([tuned_part(changes.get(k, {})) for k in range(n_participants)])
    return _step(StepKind.CHANGE, run_id, number, n_participants, body)


def encode_end(run_id: int) -> bytes:
    """Return the bytes that end a run."""
    return _step(StepKind.END, run_id, 0, 0, b'')


def _step(kind: StepKind, run_id: int, tick: int, rows: int, body: bytes) -> bytes:
    return _header(kind, run_id, tick, rows, len(body)) + body


def _header(kind: StepKind, run_id: int, tick: int, rows: int, n_bytes: int) -> bytes:
    return _STEP.pack(*prefix(_STEP.size + n_bytes), VERSION, kind, rows, run_id, tick)


def decode_step(data: bytes) -> Step:
    """
    Return the message of a coordinator from its bytes.

    Raises
    ------
    WireError
        The bytes are not a message, or from another version of this package.

    """
    (kind, rows, run_id, tick), body = opened(data, _STEP, 'step')
    if kind not in _STEP_KINDS or run_id == 0:
        raise WireError(f'a step of kind {kind} of run {run_id}')
    step = Step(_STEP_KINDS[kind], run_id, tick, rows, body)
    least = 0
    if step.kind is StepKind.TICK:
        least = rows * _TICK
    elif step.kind is StepKind.HELLO:
        least = _NUMBER.size + rows * START.itemsize
    elif step.kind is StepKind.RESTORE:
        least = _NUMBER.size
    if len(body) < least:
        raise WireError(f'a {step.kind.name} of {len(body)} bytes, must be >= {least}')
    if step.kind is StepKind.HELLO:
        _refuse_hello(step)
    elif step.kind is StepKind.RESTORE:
        split(body[_NUMBER.size:], rows)
    elif step.kind is StepKind.BEGIN:
        split(body, rows)
    elif step.kind is StepKind.CHANGE:
        for part in split(body, rows):
            if part is not None:
                tuned_of(part)
    return step


def _refuse_hello(step: Step) -> None:
    starts = np.frombuffer(
        step.body, np.float64, step.rows * START.itemsize // 8, _NUMBER.size)
    if not (is_finite(starts) and 0 < step.step_ns() <= _LARGEST_STEP_NS
            and step.rows <= len(step.roster().names)):
        raise WireError('a hello with an invalid step, start or number of actuators')
