"""
What an actuator can use of the declared range of a value that may change during a run.

A declaration holds for every actuator; these are the narrower ends of one of them, so that what
is described to users is what is accepted.

Gains: with K_p > u_max / q, where u_max is the block's limit and q the smallest step of its
measured value, one count saturates the demand: the loop is a relay. Likewise with K_i after one
period, with K_r by one count of the reference, and with a gain on a filtered rate, K_d, K_v and
the damping of an impedance, where the rate that one count shows is q times the bandwidth of its
filter. Outputs: a block demands no more than the next one inwards can have.
"""

from collections.abc import Iterator, Mapping
import math
from typing import Any, NamedTuple

from isa_ros.actuator.link import NO_LINK
from isa_ros.actuator.sheet import ActuatorSheet, ROUNDED, valve_stop
from isa_ros.core.conditions import REACTIONS
from isa_ros.core.remembered import remembered
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.plant.block_valve import NoneBlock
from isa_ros.plant.channels import longest_delay_ms
from isa_ros.plant.sensors import sensors_record
from isa_ros.plant.spool import PilotedSpool
from isa_ros.reu.block import Pid
from isa_ros.reu.compensation import DeadBand
from isa_ros.reu.feedback_linearisation import FeedbackLinearisation
from isa_ros.reu.filters import low_pass_coefficient
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.lead_lag import LeadLag
from isa_ros.reu.protection_sheet import reactions_of
from isa_ros.reu.wiring import loop_steps, Off, valve_block, VARIABLES
import numpy as np

_STEPS = {'position': 'encoder', 'force': 'force_step', 'pressure': 'pressure_step',
          'spool': 'spool_step'}
"""Field of `SENSORS` with the smallest step of each measured variable."""
_RANGES = {'force': 'force_range', 'pressure': 'pressure_range', 'spool': 'spool_range'}
"""Field of `SENSORS` with the largest value that a block can be asked for."""

_DIGITS = 9     # of a tick in ms: 0.3, not 0.30000000000000004
RELAY = 'with more, one count of its sensor demands the whole output'


class Usable(NamedTuple):
    """The narrower ends of a range, in the unit of the sheet, and the reason."""

    bounds: Mapping[str, float]
    """Any of ``ge``, ``le``, ``lt``; they replace declared ones that are wider."""
    why: str

    def narrowed(self, declared: Mapping[str, float]) -> dict[str, float]:
        """Return ``declared`` bounds with those of its own that are narrower."""
        found = dict(declared)
        for name, bound in self.bounds.items():
            lower = name == 'ge'
            inside = [own for key, own in declared.items() if key.startswith('g') == lower]
            if all(bound > own if lower else bound < own for own in inside):
                found = {key: own for key, own in found.items() if key.startswith('g') != lower}
                found[name] = bound
        return found


def narrowed(
        key: str, declared: Mapping[str, Any], narrower: Mapping[str, Usable]
        ) -> Mapping[str, Any]:
    """
    Return the declaration of a key with what is ``narrower`` of `usable`, and its reason.

    A choice keeps its names: those that do not fit are refused where they are chosen.
    """
    if key not in narrower:
        return declared
    own = narrower[key]
    if 'names' in declared:
        return {**declared, 'doc': f'{declared["doc"]}; {own.why}'}
    bounds = own.narrowed(declared['bounds'])
    if bounds == declared['bounds']:
        return declared
    return {**declared, 'bounds': bounds, 'doc': f'{declared["doc"]}; {own.why}'}


@remembered
def usable(sheet: ActuatorSheet) -> Mapping[str, Usable]:
    """Return what is narrower than its declaration, by the keys of `isa params`."""
    found: dict[str, Usable] = {}
    for variable in VARIABLES:
        block = getattr(sheet.reu, variable)
        if not isinstance(block, Off):
            found |= {f'reu.{variable}.{name}': own
                      for name, own in _of_block(sheet, variable).items()}
    if isinstance(sheet.plant.block_valve, NoneBlock):
        weaker = Usable({'le': float(REACTIONS.index('disable'))}, 'block needs block valves')
        found |= {f'reu.protection.{key}': weaker for key in reactions_of(sheet.reu.protection)}
    found |= {f'plant.valve.{name}': own for name, own in _of_hysteresis(sheet)}
    period = loop_steps(sheet.reu)['current']
    late = Usable({'le': longest_delay_ms(period)}, 'as many as its delay line has')
    found |= {f'plant.sensors.{name}.delay_ms': late for name in sheet.plant.sensors.channels}
    return found


def _of_hysteresis(sheet: ActuatorSheet) -> Iterator[tuple[str, Usable]]:
    """Yield what hysteresis and threshold of a valve leave each other; a pilot has none."""
    valve = sheet.plant.valve
    widest, threshold = valve.hysteresis_percent, valve.threshold_percent
    between, why = 0.5 * valve.hysteresis_from_percent, 'the threshold is part of the hysteresis'
    most = 0.0 if isinstance(sheet.plant.spool, PilotedSpool) else threshold + between
    yield 'hysteresis_percent', Usable({'ge': threshold, 'le': most}, why)
    yield 'threshold_percent', Usable({'ge': widest - between, 'le': widest}, why)


def refuse_timeout(sheet: ActuatorSheet, tick: float) -> None:
    """
    Refuse a time between two setpoints that is shorter than the tick, s, in which one can come.

    Raises
    ------
    ConfigError
        It would trip whatever is commanded.

    """
    timeout_ms, tick_ms = sheet.reu.protection.setpoint_timeout_ms, round(tick / MILLI, _DIGITS)
    if 0.0 < timeout_ms < tick_ms:
        raise ConfigError(
            f'reu.protection.setpoint_timeout_ms = {timeout_ms:g} ms, must be >= '
            f'step_ms = {tick_ms:g} ms, as setpoints come once a tick; or 0: off')


def unlinked(sheet: ActuatorSheet) -> Mapping[str, Usable]:
    """Return what does not change during a run without a link, by key."""
    if sheet.link.kind != NO_LINK.kind:
        return {}
    return {f'link.{name}': Usable({'ge': value, 'le': value}, 'there is no link')
            for name, value in vars(sheet.link).items() if isinstance(value, float)}


def _of_block(sheet: ActuatorSheet, variable: str) -> dict[str, Usable]:
    block, sensors = getattr(sheet.reu, variable), sensors_record(sheet.plant.sensors)
    found: dict[str, Usable] = {}
    if isinstance(block, (Pid, FeedbackLinearisation)):
        most, why = _largest_output(sheet, variable, sensors)
        found['limit'] = Usable({'le': most}, why)
    if isinstance(block, LeadLag):
        found['lead_rad_per_s'] = Usable(
            {'lt': math.pi * block.rate_hz}, 'half of the rate of its block')
    if isinstance(block, Pid):
        found['offset'] = Usable({'ge': -most, 'le': most}, why)
        found |= dict(_gains(sheet, block, float(sensors[_STEPS[variable]]), float(
            sensors['encoder'])))
        if isinstance(block.compensation, DeadBand):
            found['compensation.overlap'] = Usable(
                {'lt': block.limit}, 'beyond it is the whole output of its block')
    elif isinstance(block, Impedance):
        force, count = max(block.force_out, block.force_in), float(sensors['encoder'])
        sensor = sheet.plant.mechanics.sensor_stiffness
        found['stiffness'] = (
            Usable({'le': force / count}, RELAY) if force / count < sensor else
            Usable({'le': sensor}, 'with more it is stiffer than its force sensor'))
        found['damping'] = Usable({'le': force / _rate_of(count, sheet)}, RELAY)
    return found


def _gains(
        sheet: ActuatorSheet, block: Pid, count: float, encoder: float
        ) -> Iterator[tuple[str, Usable]]:
    """Yield the largest gains of a block whose sensor has steps of ``count``."""
    most = block.limit / count
    per_count = low_pass_coefficient(block.derivative_filter_hz, block.rate_hz) * block.rate_hz
    for name, gain in (('kp', most), ('ki', most * block.rate_hz), ('kd', most / per_count)):
        yield name, Usable({'le': gain}, RELAY)
    for name, gain in (('kr', most), ('kv', block.limit / _rate_of(encoder, sheet))):
        yield name, Usable({'ge': -gain, 'le': gain}, RELAY)


def _rate_of(count: float, sheet: ActuatorSheet) -> float:
    """Return the speed that one count of the encoder shows, m/s or rad/s."""
    speed = sheet.reu.speed
    return float(low_pass_coefficient(speed.filter_hz, speed.rate_hz)) * speed.rate_hz * count


def _largest_output(
        sheet: ActuatorSheet, variable: str, sensors: np.record) -> tuple[float, str]:
    """Return the largest output of a block in its unit, and what that is."""
    if variable == valve_block(sheet.reu):
        return valve_stop(sheet) * (1.0 + ROUNDED), 'the stop of the spool'
    if variable == 'spool':     # a piloted one commands the current of its pilot stage
        return float(sensors['current_range']), 'the range of the current sensor'
    inner = next(name for name in VARIABLES[VARIABLES.index(variable) + 1:]
                 if not isinstance(getattr(sheet.reu, name), Off))
    return float(sensors[_RANGES[inner]]), f'the range of the sensor of the {inner} block'
