"""
The current of the block valves: the REU switches it with its outputs.

The poppets and their lift are `isa_ros.plant.block_valve`; nothing measures them.
"""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.reu.protection import BLOCK

LONG_AGO = -(1 << 40)
"""Plant step of the last switch at the start of a run: the poppets rest."""


class BlockWiring(NamedTuple):
    """What an REU knows of its block valves."""

    opening: float = 0.0
    """From the current to the whole lift, s; 0: there are none."""
    closes_when_off: bool = True
    """Whether they have no current while the outputs are off, whatever the reason."""


@kernel
def switch_block(is_energised, step, own):
    """Switch the current of the block valves on (1) or off (0) at a plant step."""
    if own.is_energised != is_energised:
        own.is_energised, own.switched = is_energised, step


@kernel
def open_lines(is_wanted, reaction, step, rules, own):
    """
    Switch the block valves for outputs that are to be on, or off; return whether they are open.

    Nothing measures their lift: they count as open once their time to open is over. Without any
    the lines are open.
    """
    if rules.opening == 0.0:
        return True
    closes = (rules.closes_when_off == 1 or reaction == BLOCK
              or rules.emergency_stop > 0.0)
    switch_block(int(is_wanted or not closes), step, own)
    return own.is_energised == 1 and (step - own.switched) * PLANT_STEP >= rules.opening
