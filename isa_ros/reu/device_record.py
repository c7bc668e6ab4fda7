"""The records of a device: its constants, made from its sheet, and its state."""

from isa_ros.core.device import EVENTS, STATES
from isa_ros.core.elementary import exp
from isa_ros.core.record import record
from isa_ros.reu.block_drive import BlockWiring
from isa_ros.reu.bumpless import FADE
from isa_ros.reu.flow_stop import FLOW_STOP, FLOW_STOP_STATE
from isa_ros.reu.impedance import SETPOINT
from isa_ros.reu.transitions import GUARDS, next_states
from isa_ros.reu.wiring import Device, possible_modes, Reu
import numpy as np

CLOSES, STAYS = 'close', 'ramp_and_hold'  # kinds of a quick stop

DEVICE = np.dtype([
    ('next', 'i8', (len(STATES) * len(EVENTS) * len(GUARDS),)),
    ('modes', 'i8'),               # bits 1 << mode of those that the wiring has
    ('initialisation', 'f8'),      # s
    ('ramps', 'i8'),               # 1: a quick stop brakes; 0: it closes the valve
    ('stays', 'i8'),               # 1: it stays at rest with the outputs on
    ('hold', 'f8'),                # conversions at rest until a quick stop ends
    ('period', 'f8'),              # between two steps of the device, s
    ('return_speed', 'f8'),        # m/s | rad/s
    ('flow', FLOW_STOP),
    ('opening', 'f8'),             # of the block valves, from their current on, s; 0: none
    ('closes_when_off', 'i8'),     # 1: they have no current while the outputs are off
    ('emergency_stop', 'f8'),      # 1: its line is open
    ('fade', 'f8')])               # share of a faded jump that is left after a period
DEVICE_STATE = np.dtype([
    ('state', 'i8'), ('mode', 'i8'), ('event', 'i8'),
    ('since_step', 'i8'),          # plant step of the last change of state, mode or conditions
    ('acting', 'i8'),              # the mode whose blocks run; another one during a stop
    ('is_on', 'i8'),               # 1: the blocks command the valve; 0: null
    ('is_stopping', 'i8'),         # 1: the valve follows ``stop``
    ('is_damping', 'i8'),          # 1: the reaction damp acts
    ('is_returning', 'i8'),        # 1: the position block follows ``back``
    ('auto_enable', 'i8'),
    ('requests', 'i8'),            # kinds of the commands since the last step
    ('requested_mode', 'i8'), ('requested_enable', 'i8'),
    ('refused', 'i8'),             # kinds of the commands that it refused in this tick
    ('refused_requests', 'i8'),    # to enable, clear or stop, since t = 0
    ('unused_setpoints', 'i8'),    # that came while it did not follow them
    ('trips', 'i8'), ('warnings', 'i8'),   # bits of the conditions at the last step
    ('stop', SETPOINT),            # of the stopping movement: its place, speed, and valve
    ('flow', FLOW_STOP_STATE),
    ('back', SETPOINT),            # on the way back to the setpoint,
    ('return_speed', 'f8'),        # with this speed, m/s | rad/s
    ('is_energised', 'i8'),        # 1: the block valves have current, which opens them
    ('switched', 'i8'),            # plant step at which that changed
    ('is_open', 'i8'),             # 1: they are open, or there are none
    ('fade', FADE)])


def device_record(
        sheet: Device, reu: Reu, period: float, flow: np.record,
        block: BlockWiring = BlockWiring()) -> np.record:
    """
    Return the `DEVICE` record of an REU whose current block has a period in s.

    ``flow`` is the `FLOW_STOP` record of its stops.
    """
    return record(
        DEVICE, next=next_states(), modes=sum(1 << mode for mode in possible_modes(reu)),
        initialisation=sheet.initialisation_ms * 1e-3, ramps=int(sheet.quick_stop != CLOSES),
        stays=int(sheet.quick_stop == STAYS),
        hold=max(flow.window, round(sheet.quick_stop_hold_ms * 1e-3 / period)),
        period=period, return_speed=sheet.return_speed, flow=flow,
        opening=block.opening, closes_when_off=int(block.closes_when_off),
        emergency_stop=sheet.emergency_stop,
        fade=exp(-period / (sheet.fade_ms * 1e-3)))
