"""
One direction of a link: which frames are lost, when the others arrive, and in which order.

Losses are independent with the probability ``loss``, and in bursts by the model of Gilbert (1960)
and Elliott (1963): a line is good or bad, in the bad state every frame is lost, and at each frame
it becomes bad with p and good again with r = 1/(mean length of a burst), where p/(p + r) is the
share of the frames that bursts take. A frame that is held back comes a cycle and a half late, so
that the next one overtakes it; a duplicate comes again a cycle later, after the next one. No
receiver looks at a counter: what arrives last is in force.

All of it is noise without a state (`isa_ros.core.noise`), by the plant step of departure, but for
the state of the line, which follows from the steps before.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.noise import uniforms
from isa_ros.core.timebase import PLANT_STEP_NS
import numpy as np

SLOTS = 32          # frames on their way; delay, jitter, held back frames and copies allow 24
DOWN, UP = 0, 1     # channels of the noise,
_BURSTS = 2         # and the first of its other channels, each by direction too
_DISTURBED = 4
_TAKEN = -1
HELD_BACK = 1.5     # cycles

LINE = np.dtype([
    ('first', 'i8'),            # slot of the oldest frame
    ('count', 'i8'),            # slots in use; some of their frames may have been taken
    ('last_due', 'i8'),         # plant step at which the last one sent arrives
    ('lost', 'i8'),             # frames that did not arrive, since t = 0
    ('is_bad', 'i8'),           # 1: a burst of losses
    ('due', 'i8', (SLOTS,)),    # plant step of arrival, by slot; -1: taken
    ('sent', 'i8', (SLOTS,)),   # plant step of departure, by slot
])
"""One direction of a link. The contents of its frames lie beside it, in `SLOTS` rows."""


def burst_odds(share: float) -> float:
    """Return lost over received frames, for a share < 1 that is lost in bursts."""
    return share / (1.0 - share) if share < 1.0 else math.inf


def burst_rates(share: float, frames: float) -> tuple[float, float]:
    """Return p and r for a share of frames lost in bursts of a mean length in frames."""
    if share == 0.0:
        return 0.0, 1.0
    if share == 1.0:
        return 1.0, 0.0
    return burst_odds(share) / frames, 1.0 / frames


@kernel
def leaves(step, link):
    """Return whether a frame leaves at plant step ``step``, the first since a cycle began."""
    return (step * PLANT_STEP_NS) % link.cycle_ns < PLANT_STEP_NS


@kernel
def pass_burst(step, channel, key, link, line):
    """Move the state of the line on by one frame."""
    if link.burst_begins == 0.0:
        line.is_bad = 0
        return
    lot, _ = uniforms(key, step, _BURSTS + channel)
    if line.is_bad:
        line.is_bad = 0 if lot < link.burst_ends else 1
    else:
        line.is_bad = 1 if lot < link.burst_begins else 0


@kernel
def put_frame(step, channel, key, link, line):
    """
    Send a frame at plant step ``step``: return its slot in the `LINE`, or -1 if it is lost.

    It arrives the delay and the jitter after its cycle began, rounded up to plant steps, and not
    before the last one sent, unless that was held back. A line without a free slot loses it.
    """
    pass_burst(step, channel, key, link, line)
    lot, wait = uniforms(key, step, channel)
    if lot < link.loss or line.is_bad != 0 or line.count >= SLOTS:
        line.lost += 1
        return -1
    t_ns = step * PLANT_STEP_NS
    arrival = t_ns - t_ns % link.cycle_ns + link.delay_ns + int(link.jitter_ns * wait)
    due = max(first_step_since(arrival), line.last_due)
    is_held_back = False
    if link.reordered > 0.0:
        lot, _ = uniforms(key, step, _DISTURBED + channel)
        is_held_back = lot < link.reordered
    if is_held_back:
        due = first_step_since(arrival + int(HELD_BACK * link.cycle_ns))
    else:
        line.last_due = due
    return use_slot(due, step, line)


@kernel
def copy_frame(step, channel, key, link, line, slot):
    """Return the slot of the duplicate of the frame in ``slot``, sent at ``step``, or -1."""
    if link.duplicates == 0.0 or line.count >= SLOTS:
        return -1
    _, lot = uniforms(key, step, _DISTURBED + channel)
    if lot >= link.duplicates:
        return -1
    return use_slot(line.due[slot] + first_step_since(link.cycle_ns), step, line)


@kernel
def first_step_since(t_ns):
    """Return the first plant step that is not earlier than a time."""
    return (t_ns + PLANT_STEP_NS - 1) // PLANT_STEP_NS


@kernel
def use_slot(due, sent, line):
    """Put a frame behind the others of a `LINE`; return its slot."""
    slot = (line.first + line.count) % SLOTS
    line.due[slot], line.sent[slot] = due, sent
    line.count += 1
    return slot


@kernel
def take_frame(step, line):
    """Return the slot of the frame that has arrived first by plant step ``step``, or -1."""
    found = -1
    for k in range(line.count):
        slot = (line.first + k) % SLOTS
        if line.due[slot] != _TAKEN and line.due[slot] <= step and (
                found < 0 or line.due[slot] < line.due[found]):
            found = slot
    if found < 0:
        return -1
    line.due[found] = _TAKEN
    while line.count > 0 and line.due[line.first] == _TAKEN:
        line.first = (line.first + 1) % SLOTS
        line.count -= 1
    return found
