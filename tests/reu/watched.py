"""A protection alone: its records, and readings that give a condition a wanted quantity."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from isa_ros.core.conditions import BITS
from isa_ros.core.device import FORCE, IMPEDANCE, POSITION
from isa_ros.core.parameter import defaults
from isa_ros.core.record import record, rows_of
from isa_ros.reu.cascade import REU_STATE
from isa_ros.reu.plausibility import EVIDENCE, VALVE_EVIDENCE
from isa_ros.reu.protection import protection_record, Ratings
from isa_ros.reu.protection_sheet import levels_of, Protection
from isa_ros.reu.reactions import protect
from isa_ros.reu.supervision import SUPERVISION

STEPS = 5                   # plant steps of a conversion
PERIOD = STEPS * 20e-6
STROKE, AREA_A, AREA_B = 0.1, 4e-4, 3e-4
SPOOL_GAIN, SPOOL_LAG = 0.02, 3e-3     # m per A of the amplifier, s
RATINGS = Ratings(
    stroke=STROKE, speed=1.0, force_range=1e4, pressure_range=25e6, current_range=12.5e-3,
    opening_pressure=22e6, spool_stop=2e-4)
SUPPLY = 20.7e6
FLOW_GAIN = 1e-7    # m3/s/sqrt(Pa): 0.46 l/s from the supply


def off(names: Mapping[str, Any] = BITS) -> Protection:
    """Return a protection of which no condition is watched."""
    sheet = defaults(Protection)
    return replace(sheet, **{
        name: replace(own, reaction='none')  # type: ignore[type-var]
        for name, own in levels_of(sheet).items() if name in names})


def only(name: str, hysteresis: float = 0.0, **levels: Any) -> Protection:
    """Return a protection that watches one condition."""
    sheet = off()
    own = replace(getattr(sheet, name), **{'warning': 0.0, 'trip': 0.0, 'reaction': 'warn'})
    return replace(sheet, hysteresis=hysteresis, **{name: replace(own, **levels)})


class Watched:
    """The records of a protection; `convert` is one conversion."""

    def __init__(self, sheet: Protection, watchdog: float = 0.0) -> None:
        evidence = record(
            EVIDENCE, area_a=AREA_A, area_b=AREA_B, end_a=0.0, end_b=0.0, preload=0.0,
            stiffness=0.0, force_range=RATINGS.force_range,
            stiction=100.0, viscous=0.0, inertia=1.0, speed_rate=1000.0, speed_steps=50,
            offset_steps=0, valve=record(
                VALVE_EVIDENCE, is_watched=1, is_piloted=0, gain=SPOOL_GAIN, play=0.0,
                stop=RATINGS.spool_stop, share=PERIOD / (SPOOL_LAG + PERIOD)))
        supervision = record(
            SUPERVISION, area_a=AREA_A, area_b=AREA_B, flow_gain=FLOW_GAIN, stroke=STROKE,
            coulomb=0.0, viscous=0.0, end_a=0.0, end_b=0.0, has_two=1,
            force_range=RATINGS.force_range, pressure_range=RATINGS.pressure_range,
            current_range=RATINGS.current_range, spool_range=3e-4, spool_gain=SPOOL_GAIN,
            opening=4e-5, follows_force=1, creep=0.02, slow_share=PERIOD / (6.4e-3 + PERIOD),
            mean_share=PERIOD / (0.05 + PERIOD))
        self._parts = evidence, supervision, STEPS, 0.0, watchdog
        self.become(sheet)
        self.state = rows_of(1, REU_STATE)[0]
        self.own = self.state.protection
        self.supply, self.temperature, self.step = SUPPLY, 40.0, 0
        measured, setpoint = self.state.measured, self.state.setpoint
        measured.position = self.own.evidence.position = 0.5 * STROKE
        self.state.status.is_on, self.state.status.mode = 1, IMPEDANCE
        self.state.status.is_open = 1
        setpoint.stiffness, setpoint.damping = 1e5, 4e3
        setpoint.position, setpoint.velocity, setpoint.effort = 0.02, 0.1, 50.0

    def become(self, sheet: Protection) -> None:
        """Take other levels, delays, reactions or another mask; the state stays."""
        self.constants = protection_record(sheet, RATINGS, *self._parts)

    def convert(self, n: int = 1) -> None:
        """Take ``n`` conversions of the present readings."""
        for _ in range(n):
            protect(self.step, self.supply, self.temperature, self.constants, self.state)
            self.step += STEPS

    def has(self, name: str) -> tuple[bool, bool]:
        """Return whether a condition warns and whether it trips."""
        bit = BITS[name]
        return bool(self.own.warnings >> bit & 1), bool(self.own.trips >> bit & 1)

    def show(self, name: str, quantity: float) -> None:
        """Set the readings so that the next conversion gives a condition this quantity."""
        READINGS[name](self, quantity)


def _measure(field: str) -> Callable[[Watched, float], None]:
    return lambda watched, quantity: setattr(watched.state.measured, field, quantity)


def _load_cell(watched: Watched, quantity: float) -> None:
    """Contradict pressures of 4 kN, with 100 N of friction allowed."""
    measured = watched.state.measured
    measured.pressure_a, measured.pressure_b = 10e6, 0.0
    measured.force = AREA_A * 10e6 - 100.0 - quantity


def _sensor_range(watched: Watched, quantity: float) -> None:
    """Read a pressure below its range; the other chamber has oil."""
    measured = watched.state.measured
    measured.pressure_a, measured.pressure_b = -quantity * RATINGS.pressure_range, 5e6


def _position_error(watched: Watched, quantity: float) -> None:
    """Stand still in mode position, away from the setpoint."""
    watched.state.status.mode = watched.state.status.acting = POSITION
    watched.state.setpoint.position = watched.state.measured.position + quantity


def _force_error(watched: Watched, quantity: float) -> None:
    """Measure less than the force block asks for, and the valve can give."""
    watched.state.status.acting = FORCE
    watched.state.force_reference = 2000.0
    watched.state.measured.force = 2000.0 - quantity


def _oscillation(watched: Watched, quantity: float) -> None:
    """Give the mean fast part of the force, which the next conversion hardly changes."""
    watched.state.status.acting = FORCE
    watched.own.supervision.force_activity = quantity / (1.0 - PERIOD / (0.05 + PERIOD))


def _runaway(watched: Watched, quantity: float) -> None:
    """Retract although the valve lets oil into chamber A."""
    measured = watched.state.measured
    measured.spool, measured.pressure_a, measured.pressure_b = 1e-4, 10e6, 10e6
    watched.state.speed.velocity = -quantity


READINGS: Mapping[str, Callable[[Watched, float], None]] = {
    'end_of_stroke': _measure('position'),
    'overspeed': lambda watched, quantity: setattr(watched.state.speed, 'velocity', -quantity),
    'overload': _measure('force'),
    'overpressure': _measure('pressure_b'),
    'overcurrent': lambda watched, quantity: setattr(
        watched.state.measured, 'current', -quantity),
    'overtemperature': lambda watched, quantity: setattr(watched, 'temperature', quantity),
    'supply_low': lambda watched, quantity: setattr(watched, 'supply', quantity),
    'relief_open': _measure('pressure_a'),
    'load_cell_implausible': _load_cell,
    'encoder_jump': lambda watched, quantity: setattr(
        watched.state.measured, 'position',
        watched.own.evidence.position + quantity * PERIOD),
    'spool_deviation': _measure('spool'),
    'sensor_range': _sensor_range,
    'position_error': _position_error,
    'force_error': _force_error,
    'oscillation': _oscillation,
    'runaway': _runaway,
}
NAMES = tuple(READINGS)
