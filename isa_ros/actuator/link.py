"""
The link of an actuator: frames from the commander to the REU, and back to the listeners.

A frame leaves in each direction when a cycle begins, the first at t = 0, at the first plant step
that is not earlier. Down, it carries the newest command that no frame has brought yet; up, what
the REU has sensed last. It arrives after the delay and a jitter, uniform from 0 to ``jitter_us``,
again at the first plant step that is not earlier; `isa_ros.actuator.frames` has this and what else
may happen to a frame. A lost one does not arrive: the REU keeps its setpoint, listeners keep their
sample, and the command goes with the next frame. A command that has waited for the watchdog's time
is dropped: when a dead link comes back, what was commanded long ago does not act. A frozen REU
sends no frames and takes none.

Whatever happens to frames is noise by the seed of the run, the name of the actuator, the direction
and the plant step at which the frame leaves.
"""

from typing import Any

from isa_ros.actuator.frames import (
    burst_odds, burst_rates, copy_frame, DOWN, HELD_BACK, leaves, LINE, put_frame, SLOTS,
    take_frame, UP)
from isa_ros.actuator.inbox import latch, merge
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.noise import noise_key
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
_NS_PER_MS = 1_000_000
_US_PER_MS = 1000.0
STALE = MOST_CYCLES + 2  # cycles after which a sample is too old, without a watchdog
SET = HAS_SETPOINT | HAS_GAINS | HAS_REFERENCE
ASKED = EVERY_KIND ^ SET
_ASSUMED = 'assumed'


def _off(doc: str, unit: str, most: float, *, changeable: bool = False) -> Any:
    return parameter(
        doc, unit, absent=0.0, source=_ASSUMED, changeable=changeable, ge=0.0, le=most)


@frozen(kw_only=True)
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
    burst_loss: float = _off(
        'share of the frames lost in bursts, each way, besides those of loss', '1', 1.0,
        changeable=True)
    burst_frames: float = _off(
        'mean number of frames of a burst; 0: no bursts', 'frames', 1e6, changeable=True)
    duplicates: float = _off(
        'probability that a frame arrives a second time, a cycle later, each way', '1', 1.0,
        changeable=True)
    reordered: float = _off(
        'probability that a frame is a cycle and a half late, so that the next overtakes it, '
        'each way', '1', 1.0, changeable=True)
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
        least = max(1.0, burst_odds(self.burst_loss))
        if 0.0 < self.burst_loss < 1.0 and self.burst_frames < least:
            raise ParameterError(
                f'burst_frames = {self.burst_frames:g} frames, must be >= {least:g} frames with '
                f'burst_loss = {self.burst_loss:g}: a good line loses no frame between two bursts')
        longest = max(1.0, self.delay_cycles) * self.cycle_ms + jitter_ms
        if self.reordered:
            longest += HELD_BACK * self.cycle_ms
        if 0.0 < self.watchdog_ms <= longest:
            raise ParameterError(
                f'watchdog_ms = {self.watchdog_ms:g} ms, must be > {longest:g} ms, the longest '
                'time without a frame where none is lost (cycle or delay, and jitter)')


NO_LINK = LinkSheet(
    kind=NONE, cycle_ms=0.0, delay_cycles=0.0, jitter_us=0.0, loss=0.0, burst_loss=0.0,
    burst_frames=0.0, duplicates=0.0, reordered=0.0, watchdog_ms=0.0)

LINK = np.dtype([
    ('is_on', 'i8'),
    ('cycle_ns', 'i8'), ('delay_ns', 'i8'), ('watchdog_ns', 'i8'),
    ('jitter_ns', 'f8'),
    ('loss', 'f8'),
    ('burst_begins', 'f8'), ('burst_ends', 'f8'),   # probabilities at a frame
    ('duplicates', 'f8'), ('reordered', 'f8'),
])
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
    begins, ends = burst_rates(sheet.burst_loss, sheet.burst_frames)
    return record(
        LINK, is_on=1, cycle_ns=cycle, delay_ns=round(sheet.delay_cycles) * cycle,
        watchdog_ns=round(sheet.watchdog_ms * _NS_PER_MS),
        jitter_ns=sheet.jitter_us / _US_PER_MS * _NS_PER_MS, loss=sheet.loss,
        burst_begins=begins, burst_ends=ends, duplicates=sheet.duplicates,
        reordered=sheet.reordered)


def link_key(seed: int, name: str) -> int:
    """Return the key of the noise of a link: by the run's seed and the actuator's name."""
    return noise_key(seed, f'{name}/link')


LARGEST_OF_LINE = {'first': SLOTS - 1, 'count': SLOTS, 'is_bad': 1}
"""Largest number by field of a `LINE` in a saved state; the smallest is 0."""


def refuse_states(states: Records, owner: str) -> None:
    """
    Refuse the `LINK_STATE` rows of a saved state that no link can have.

    Raises
    ------
    ConfigError
        A line has more frames than slots, or a slot that does not exist.

    """
    for line in (states['down'], states['up']):
        for name, most in LARGEST_OF_LINE.items():
            if not ((line[name] >= 0) & (line[name] <= most)).all():
                raise ConfigError(
                    f'{owner}: saved state has {name} = {line[name][0]} of a link, must be '
                    f'0 to {most}')


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
            copy = copy_frame(step, DOWN, key, link, state.down, slot)
            if copy >= 0:
                frames[copy] = frames[slot]
    slot = take_frame(step, state.down)
    while slot >= 0:
        if is_frozen:
            state.down.lost += 1
            slot = take_frame(step, state.down)
            continue
        state.last_frame = step
        state.brought = max(state.brought, state.down.sent[slot] + 1)
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
            copy = copy_frame(step, UP, own.link_key, own.link, line, slot)
            if copy >= 0:
                memory.samples_sent[n * SLOTS + copy] = memory.samples[n]


@kernel
def receive_samples(step, n, memory):
    """Update the sample that listeners of actuator ``n`` have at ``step``: the last arrived."""
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
