"""
The loops of an actuator, for excitation and measurement.

    position -> force or torque -> pressure difference -> spool -> current

With every block outside it off, a loop is excited by the setpoint. All of its signals are
recorded in one run: reference R, output Y, error R - Y, and U, the output of its block to the next
one inwards.
"""

from dataclasses import replace
import math
from typing import Any

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.sheet import actuator_record, ActuatorSheet
from isa_ros.analysis.response.actuator_trace import Trace
from isa_ros.core.frozen import frozen
from isa_ros.core.units import MILLI, MPA
from isa_ros.errors import ConfigError
from isa_ros.plant.return_spring import CoilSpring, spring_of
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.lead_lag import LeadLag
from isa_ros.reu.wiring import active, Off, VARIABLES
import numpy as np

FORCE_SHARE = 0.1       # amplitude over rating, as for the paper's force bandwidth
SPRING_SHARE = 0.5      # at most, over the preload: what alone pulls a single-acting cylinder in
INNER_SHARE = 0.25      # amplitude over spool travel and current, as in the paper's Table 1
POSITION_SHARE = 0.01   # amplitude over stroke: within the valve's flow up to tens of Hz
OPEN, PLANT, CLOSED = 'open', 'plant', 'closed'
FORCE, TORQUE = 'force', 'torque'


@frozen
class UserUnit:
    """A unit for the user's values of a quantity; one unit is ``scale`` SI units."""

    symbol: str
    scale: float = 1.0


@frozen
class Loop:
    """One loop of one actuator; signals have the names of a `Trace`."""

    name: str
    label: str                  # the name, but torque for the force loop of a rotary actuator
    sheet: ActuatorSheet        # with the blocks outside the loop off
    unit: UserUnit                  # of reference and output
    inward: str | None          # the output signal of its block
    inward_unit: UserUnit
    quantity: str               # of the setpoint that is its reference
    per_reference: float        # that quantity per SI unit of the reference
    rate_hz: float              # rate at which it samples its reference
    amplitude: float            # default amplitude of the excitation, SI
    largest: float              # largest sensible amplitude, SI

    def input_of(self, of: str, trace: Trace) -> np.ndarray:
        """
        Return the input of the response ``of`` closed, plant or open loop, shape (n,).

        Raises
        ------
        ConfigError
            The loop is closed inside the plant's equations, so that there is no Y/U.

        """
        reference = trace[f'{self.name}_reference']
        if of == OPEN:
            error: np.ndarray = reference - trace[self.name]
            return error
        if of == CLOSED:
            return reference
        if self.inward is None:
            raise ConfigError(
                f'--of plant: the {self.name} loop is closed inside the plant model, it has '
                'no output; valid: closed, open')
        return trace[self.inward]

    def response_unit(self, of: str) -> UserUnit:
        """Return the unit of a response, output over input."""
        if of != PLANT:
            return UserUnit('1')
        return UserUnit(f'{self.unit.symbol}/{self.inward_unit.symbol}',
                        self.unit.scale / self.inward_unit.scale)


def outermost(sheet: ActuatorSheet, name: str) -> ActuatorSheet:
    """
    Return the sheet with every block outside a loop off: the setpoint becomes its reference.

    The spool block may be off: the valve then closes the loop mechanically, and the current
    block is the outermost one.

    Raises
    ------
    ConfigError
        The loop's own block is off.

    """
    if name not in VARIABLES:
        raise ConfigError(f'loop {name!r} is unknown; valid: {", ".join(VARIABLES)}')
    is_on = active(sheet.reu)
    if name not in is_on and name != 'spool':
        raise ConfigError(f'the {name} loop is off; on: {", ".join(is_on)}')
    outside: dict[str, Any] = {other: Off() for other in VARIABLES[:VARIABLES.index(name)]}
    return replace(sheet, reu=replace(sheet.reu, **outside))


def loop_name(actuator: ConfiguredActuator, wanted: str) -> str:
    """
    Return the name of a loop that a user names: the torque loop of a rotary actuator is `force`.

    Raises
    ------
    ConfigError
        The torque is wanted of an actuator that has a force.

    """
    if wanted != TORQUE:
        return wanted
    if not actuator.sheet.is_rotary:
        raise ConfigError(
            f'--loop {TORQUE}: {actuator.name} is not rotary, its loop is --loop {FORCE}')
    return FORCE


def loop_of(sheet: ActuatorSheet, name: str) -> Loop:
    """Return a loop of an actuator, ready to be excited; as `outermost`."""
    alone = outermost(sheet, name)
    is_on = list(active(alone.reu).items())
    record = actuator_record(alone, 0)[0]
    units = units_of(sheet)
    inward = _inward(alone, [other for other, _ in is_on], name)
    current_per_spool = float(record['plant']['coil']['parallel']
                              / record['plant']['valve']['k_spool'])
    per_reference = 1.0
    if is_on[0][0] == 'current':     # its setpoint is in amperes of the series scale
        per_reference = 1.0 / float(record['plant']['coil']['parallel'])
        if name == 'spool':
            per_reference *= current_per_spool
    share, largest = {
        'position': (POSITION_SHARE, float(sheet.plant.drive.stroke)),
        'force': (FORCE_SHARE, rating(sheet)),
        'pressure': (FORCE_SHARE, PAPER_SUPPLY),
        'spool': (INNER_SHARE, float(record['plant']['valve']['x_max'])),
        'current': (INNER_SHARE, float(record['plant']['valve']['x_max']) * current_per_spool),
    }[name]
    return Loop(
        name=name, label=TORQUE if name == FORCE and sheet.is_rotary else name,
        sheet=alone, unit=units[name], inward=inward,
        inward_unit=units[inward.removesuffix('_reference') if inward else 'drive'],
        quantity='position' if name == 'position' else 'effort', per_reference=per_reference,
        rate_hz=is_on[0][1], amplitude=_least(share * largest, sheet, name), largest=largest)


def _least(amplitude: float, sheet: ActuatorSheet, name: str) -> float:
    """Return an amplitude, of a force no more than what a return spring gives both ways."""
    spring = spring_of(sheet.plant)
    if name != 'force' or not isinstance(spring, CoilSpring) or spring.preload == 0.0:
        return amplitude
    return min(amplitude, SPRING_SHARE * spring.preload)


def _inward(alone: ActuatorSheet, names: list[str], name: str) -> str | None:
    """Return the name of the signal from a loop's block to the next one inwards."""
    if name == 'current':
        return 'drive' if isinstance(alone.reu.current, LeadLag) else None
    if name not in names:
        return 'current_reference'
    return f'{names[names.index(name) + 1]}_reference'


def units_of(sheet: ActuatorSheet) -> dict[str, UserUnit]:
    """Return the user's unit of every loop's signals."""
    place, force = ((UserUnit('deg', math.radians(1.0)), UserUnit('Nm')) if sheet.is_rotary
                    else (UserUnit('mm', MILLI), UserUnit('N')))
    return {'position': place, 'force': force, 'pressure': UserUnit('MPa', MPA),
            'spool': UserUnit('mm', MILLI), 'current': UserUnit('mA', MILLI),
            'drive': UserUnit('V')}


def rating(sheet: ActuatorSheet) -> float:
    """Return the largest force (N) or torque (Nm) pushing out: rated, else hydraulic stall."""
    if isinstance(sheet.reu.position, Impedance):
        return sheet.reu.position.force_out
    return float(sheet.plant.drive.areas[0]) * PAPER_SUPPLY
