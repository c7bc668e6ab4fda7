"""
The hardware watchdog of the REU: a circuit beside the program, which the program resets.

A frozen program reads no sensor and runs no block, sends and takes no frames, and leaves its
output as it is. After `reu.watchdog_ms` without it the watchdog switches the output of the
amplifier off, to zero current; the condition `watchdog` trips, and the device is in fault. Only a
program that runs again can be cleared. Without a link the sample shows both at once, by the error
line of the circuit; over a link nothing arrives, and the age of the sample grows.
"""

from isa_ros.core.kernel import kernel
from isa_ros.reu.block_drive import switch_block
from isa_ros.reu.device import device_step
from isa_ros.reu.protection import BIT, judge_one
from isa_ros.reu.reactions import react


@kernel
def stand_still(step, period, reu, state):
    """
    Let a conversion of ``period`` s pass without the program of a frozen REU.

    ``reu`` is its `REU` record, ``state`` a `REU_STATE`.
    """
    state.frozen_for += period
    if reu.rules.emergency_stop > 0.0:
        cut_off(step, reu, state)
    if reu.watchdog == 0.0 or state.frozen_for < reu.watchdog:
        return
    own, protection = state.protection, reu.protection
    if protection.is_on and own.trips >> BIT.watchdog & 1 == 0:
        own.values[BIT.watchdog] = state.frozen_for
        judge_one(BIT.watchdog, step, state.status.mode, protection, own)
        own.first = own.first if own.first else own.trips & -own.trips
        react(protection, state)
        device_step(step, reu, state)
    cut_off(step, reu, state)


@kernel
def cut_off(step, reu, state):
    """Switch the amplifier's output and the block valves off; the program does not know it."""
    state.drive = 0.0
    if reu.rules.opening > 0.0:
        state.status.is_on = state.status.is_open = 0
        switch_block(0, step, state.status)
