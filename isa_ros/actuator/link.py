"""
The link of an actuator: frames from the commander to the REU, and back to the listeners.

A frame leaves in each direction when a cycle begins, the first at t = 0, at the first plant step
that is not earlier. Down, it carries the newest command that no frame has brought yet; up, what
the REU has sensed last. It arrives after the delay and a jitter, uniform from 0 to ``jitter_us``,
again at the first plant step that is not earlier; a frame never overtakes the one before it. A
lost frame does not arrive: the REU keeps its setpoint, listeners keep their sample, and the
command goes with the next frame. A command that has waited for the watchdog's time is dropped:
when a dead link comes back, what was commanded long ago does not act. A frozen REU sends no frames
and takes none.

Loss and jitter are noise without a state (`isa_ros.core.noise`), by the seed of the run, the name
of the actuator, the direction and the plant step at which the frame leaves.
"""

from dataclasses import dataclass
from typing import Any

from isa_ros.actuator.inbox import latch, merge
from isa_ros.core.kernel import kernel
from isa_ros.core.noise import noise_key, uniforms
from isa_ros.core.parameter import choice, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.signals import (
    EVERY_KIND, HAS_GAINS, HAS_REFERENCE, HAS_SETPOINT, Records)
from isa_ros.core.timebase import PLANT_STEP, PLANT_STEP_NS
from isa_ros.errors import ConfigError, ParameterError
import numpy as np

NONE = 'none'
KINDS = (NONE, 'ethercat', 'can', 'serial')
MOST_CYCLES = 8     # of delay
SLOTS = 16          # frames on their way; the delay and the jitter allow 10
_NS_PER_MS = 1_000_000
_US_PER_MS = 1000.0
STALE = MOST_CYCLES + 2  # cycles after which a sample is too old, without a watchdog
SET = HAS_SETPOINT | HAS_GAINS | HAS_REFERENCE
ASKED = EVERY_KIND ^ SET
DOWN, UP = 0, 1     # channels of the noise
_ASSUMED = 'assumed'


def _off(doc: str, unit: str, most: float, *, changeable: bool = False) -> Any:
    return parameter(
        doc, unit, absent=0.0, source=_ASSUMED, changeable=changeable, ge=0.0, le=most)


@dataclass(frozen=True, kw_only=True)
class LinkSheet(Parameters):
    """Timing and losses of the link of an actuator."""

    kind: str = choice(
        'the wire; none: commands and samples arrive at once', *KINDS, source=_ASSUMED)
    cycle_ms: float = _off('time from frame to frame; 0: the tick', 'ms', 100.0)
    delay_cycles: float = _off(
        'time on the way, whole cycles', 'cycles', float(MOST_CYCLES), changeable=True)
    jitter_us: float = _off(
        'largest additional time on the way, uniform from 0', 'us', 1e5, changeable=True)
    loss: float = _off(
        'probability that a frame is lost, each way', '1', 1.0, changeable=True)
    watchdog_ms: float = _off(
        'time without a frame after which the REU takes the link as lost; 0: off', 'ms', 1e5)

    def __post_init__(self) -> None:
        """Refuse a cycle below the plant step, and a watchdog that trips without a loss."""
        super().__post_init__()
        if self.delay_cycles != int(self.delay_cycles):
            raise ParameterError(
                f'delay_cycles = {self.delay_cycles:g} cycles, must be a whole number')
        if 0.0 < self.cycle_ms < PLANT_STEP_NS / _NS_PER_MS:
            raise ParameterError(
                f'cycle_ms = {self.cycle_ms:g} ms, must be >= the plant step '
                f'{PLANT_STEP_NS / _NS_PER_MS:g} ms, or 0 for the tick')
        jitter_ms = self.jitter_us / _US_PER_MS
        if self.cycle_ms and jitter_ms > self.cycle_ms:
            raise ParameterError(
                f'jitter_us = {self.jitter_us:g} us, must be <= cycle_ms = {self.cycle_ms:g} ms: '
                'a frame arrives before the next one')
        longest = max(1.0, self.delay_cycles) * self.cycle_ms + jitter_ms
        if 0.0 < self.watchdog_ms <= longest:
            raise ParameterError(
                f'watchdog_ms = {self.watchdog_ms:g} ms, must be > {longest:g} ms, the longest '
                'time without a frame where none is lost (cycle or delay, and jitter)')


NO_LINK = LinkSheet(
    kind=NONE, cycle_ms=0.0, delay_cycles=0.0, jitter_us=0.0, loss=0.0, watchdog_ms=0.0)

LINK = np.dtype([
    ('is_on', 'i8'),
    ('cycle_ns', 'i8'), ('delay_ns', 'i8'), ('watchdog_ns', 'i8'),
    ('jitter_ns', 'f8'),
    ('loss', 'f8'),
])
LINE = np.dtype([
    ('first', 'i8'),            # slot of the frame that arrives next
    ('count', 'i8'),            # frames on their way
    ('last_due', 'i8'),         # plant step at which the last one sent arrives
    ('lost', 'i8'),             # frames that did not arrive, since t = 0
    ('due', 'i8', (SLOTS,)),    # plant step of arrival, by slot
    ('sent', 'i8', (SLOTS,)),   # plant step of departure, by slot
])
"""One direction of a link. The contents of its frames lie beside it, in `SLOTS` rows."""

LINK_STATE = np.dtype([
    ('down', LINE), ('up', LINE),
    ('last_frame', 'i8'),       # plant step at which the REU last received a frame
    ('sampled', 'i8'),          # plant step of the sample that the listeners have
    ('set_step', 'i8'),         # plant step at which the setpoint or gains in the outbox were set,
    ('asked_step', 'i8'),       # and the requests and the mode
    ('dropped', 'i8'),          # commands that waited too long, since t = 0
    ('brought', 'i8'),          # departure of the last frame that the REU took, + 1; 0: none yet
])


def link_record(sheet: LinkSheet) -> np.record:
    """Return the `LINK` record of a sheet."""
    if sheet.kind == NONE:
        return record(LINK, **dict.fromkeys(LINK.names or (), 0))
    cycle = round(sheet.cycle_ms * _NS_PER_MS)
    if not cycle:
        raise ConfigError('link.cycle_ms = 0 ms is the tick of a run, must be > 0 ms without one')
    return record(
        LINK, is_on=1, cycle_ns=cycle, delay_ns=round(sheet.delay_cycles) * cycle,
        watchdog_ns=round(sheet.watchdog_ms * _NS_PER_MS),
        jitter_ns=sheet.jitter_us / _US_PER_MS * _NS_PER_MS, loss=sheet.loss)


def link_key(seed: int, name: str) -> int:
    """Return the key of the noise of a link: by the run's seed and the actuator's name."""
    return noise_key(seed, f'{name}/link')


def refuse_states(states: Records, owner: str) -> None:
    """
    Refuse the `LINK_STATE` rows of a saved state that no link can have.

    Raises
    ------
    ConfigError
        A line has more frames than slots, or a slot that does not exist.

    """
    for line in (states['down'], states['up']):
        for name, least, most in (('first', 0, SLOTS - 1), ('count', 0, SLOTS)):
            if not ((line[name] >= least) & (line[name] <= most)).all():
                raise ConfigError(
                    f'{owner}: saved state has {name} = {line[name][0]} of a link, must be '
                    f'{least} to {most}')


@kernel
def leaves(step, link):
    """Return whether a frame leaves at plant step ``step``, the first since a cycle began."""
    return (step * PLANT_STEP_NS) % link.cycle_ns < PLANT_STEP_NS


@kernel
def put_frame(step, channel, key, link, line):
    """
    Send a frame at plant step ``step``: return its slot in the `LINE`, or -1 if it is lost.

    It arrives the delay and the jitter after its cycle began, rounded up to plant steps, and not
    before the last one sent. A line whose slots are all taken loses it.
    """
    lot, wait = uniforms(key, step, channel)
    if lot < link.loss or line.count >= SLOTS:
        line.lost += 1
        return -1
    t_ns = step * PLANT_STEP_NS
    arrival = t_ns - t_ns % link.cycle_ns + link.delay_ns + int(link.jitter_ns * wait)
    due = (arrival + PLANT_STEP_NS - 1) // PLANT_STEP_NS
    slot = (line.first + line.count) % SLOTS
    line.last_due = max(due, line.last_due)
    line.due[slot] = line.last_due
    line.sent[slot] = step
    line.count += 1
    return slot


@kernel
def take_frame(step, line):
    """Return the slot of the next frame that has arrived at plant step ``step``, or -1."""
    if line.count <= 0 or line.due[line.first] > step:
        return -1
    slot = line.first
    line.first = (slot + 1) % SLOTS
    line.count -= 1
    return slot


@kernel
def hand_over(step, n, memory):
    """Begin a tick of actuator ``n``: move its pending command to the outbox; store it as sent."""
    memory.applied[n].kinds = 0
    memory.sent[n] = memory.pending[n]
    kinds, state = memory.pending[n].kinds, memory.links[n]
    if kinds:
        merge(memory.pending[n], memory.outbox[n])
        memory.pending[n].kinds = 0
        if kinds & SET:
            state.set_step = step
        if kinds & ASKED:
            state.asked_step = step
    drop_stale(step, memory.constants[n].link, state, memory.outbox[n])


@kernel
def drop_stale(step, link, state, outbox):
    """Drop what has waited in the outbox for the time of the watchdog."""
    if link.watchdog_ns == 0 or outbox.kinds == 0:
        return
    for kinds, since in ((SET, state.set_step), (ASKED, state.asked_step)):
        if outbox.kinds & kinds and (step - since) * PLANT_STEP_NS >= link.watchdog_ns:
            outbox.kinds &= EVERY_KIND ^ kinds
            state.dropped += 1


@kernel
def exchange_frames(step, is_sampled, n, memory):
    """
    Exchange the frames of actuator ``n`` that are due before plant step ``step``.

    ``is_sampled``: its sample is that of this step, for a frame that leaves inside the tick.
    """
    if is_sampled:
        send_sample(step, n, memory)
    link_down(step, memory.constants[n].link_key, memory.constants[n].link, memory.links[n],
              memory.outbox[n:n + 1], memory.commands_sent[n * SLOTS:(n + 1) * SLOTS],
              memory.constants[n].reu.is_frozen != 0.0, memory.reu[n], memory.applied[n])


@kernel
def link_down(step, key, link, state, outbox, frames, is_frozen, reu, applied):
    """
    Send the command in the outbox if a frame leaves at ``step``; apply those that have arrived.

    ``outbox`` (1,) and ``frames`` (SLOTS,) are `COMMAND` rows. Of several commands that arrive
    in a tick ``applied`` has the kinds of all, and the step of the last. What arrives at a
    frozen REU is lost.
    """
    if leaves(step, link):
        slot = put_frame(step, DOWN, key, link, state.down)
        if slot >= 0:
            frames[slot] = outbox[0]
            frames[slot].due_step = state.down.due[slot]
            outbox[0].kinds = 0
    slot = take_frame(step, state.down)
    while slot >= 0:
        if is_frozen:
            state.down.lost += 1
            slot = take_frame(step, state.down)
            continue
        state.last_frame, state.brought = step, state.down.sent[slot] + 1
        if frames[slot].kinds:
            kinds = applied.kinds
            latch(frames[slot], reu, applied)
            applied.kinds |= kinds
            applied.due_step = step
        slot = take_frame(step, state.down)
    if not is_frozen:
        watch(step, link, state, reu)


@kernel
def watch(step, link, state, reu):
    """Set ``link_lost`` of a `REU_STATE` when no frame has come for the watchdog's time."""
    if link.watchdog_ns == 0:
        return
    silence = (step - state.last_frame) * PLANT_STEP_NS
    reu.link_silence = (step - state.last_frame) * PLANT_STEP
    if silence < link.watchdog_ns:
        reu.link_lost = 0
    elif reu.link_lost == 0:
        reu.link_lost = 1
        reu.link_lost_step = step


@kernel
def send_sample(step, n, memory):
    """Send the sample of actuator ``n`` if a frame leaves at ``step``."""
    own, line = memory.constants[n], memory.links[n].up
    if own.reu.is_frozen == 0.0 and leaves(step, own.link):
        memory.samples[n].frames_lost_down = float(memory.links[n].down.lost)
        slot = put_frame(step, UP, own.link_key, own.link, line)
        if slot >= 0:
            memory.samples_sent[n * SLOTS + slot] = memory.samples[n]


@kernel
def receive_samples(step, n, memory):
    """Update the sample that listeners of actuator ``n`` have at ``step``: the newest arrived."""
    state = memory.links[n]
    slot = take_frame(step, state.up)
    while slot >= 0:
        memory.observed[n] = memory.samples_sent[n * SLOTS + slot]
        state.sampled = state.up.sent[slot]
        slot = take_frame(step, state.up)
    observed = memory.observed[n]
    observed.age = (step - state.sampled) * PLANT_STEP
    observed.frames_lost_up = float(state.up.lost)
    observed.commands_dropped = float(state.dropped)
    observed.is_stale = 1.0 if is_stale(step - state.sampled, memory.constants[n].link) else 0.0


@kernel
def is_stale(steps, link):
    """Return whether a sample of this age is too old: the watchdog's time, else `STALE` cycles."""
    longest = link.watchdog_ns if link.watchdog_ns else STALE * link.cycle_ns
    return steps * PLANT_STEP_NS >= longest
