"""A device by itself: its constants, its state, and what is asked of it."""

from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.device import IMPEDANCE
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.signals import HAS_ENABLE, HAS_MODE
from isa_ros.reu.cascade import REU_STATE
from tests.sheets import actuator_sheet, override

QUICK_STOPS, DISABLES = 5, 6    # places of these reactions
PERIOD = 5          # plant steps between two conversions
STOP_STEPS = 2000   # conversions: 200 ms, the shipped time at rest
BIT = 1 << 3        # of any condition that disables


def constants(model='isa_v5', **values):
    """Return the REU's constants, with some parameters of the device replaced."""
    sheet = actuator_sheet(model)
    for name, value in values.items():
        sheet = override(sheet, f'reu.device.{name}', value)
    reu = row_record(actuator_record(sheet, 0)).reu
    reu.protection.reaction[:] = DISABLES
    return reu


def starting(auto_enable=1):
    """Return the state at t = 0."""
    state = rows_of(1, REU_STATE)[0]
    own = state.status
    own.auto_enable = own.requested_enable = auto_enable
    own.mode = own.acting = own.requested_mode = IMPEDANCE
    return state


def request(state, kinds, enable=0, mode=0):
    """Let commands have taken effect at the tick's start."""
    own = state.status
    own.requests |= kinds
    if kinds & HAS_ENABLE:
        own.requested_enable = enable
    if kinds & HAS_MODE:
        own.requested_mode = mode


def find(state, reaction, bits=BIT):
    """Let the protection have found something; a trip that stops stays until it is cleared."""
    own = state.protection
    stops = reaction >= QUICK_STOPS
    own.present = bits if stops else 0
    latched = 0 if own.reaction < QUICK_STOPS or own.clears and not stops else own.reaction
    own.clears = 0
    own.reaction = max(reaction, latched)
    own.trips = bits if own.reaction else 0
