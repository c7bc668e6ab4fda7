"""
The plant at its limits, in simulation: full current, little pressure drop, end stop, converters.

As in `behaviour` the valve is driven directly, and each result is compared with a solution for
the shipped parameters. These limits a robot meets at its fastest and its strongest; inside of them
nothing of the other groups would notice that they moved.
"""

from isa_ros.analysis.response.actuator_trace import RATE_HZ, setpoints
from isa_ros.core.units import MILLI
from isa_ros.paper.printed import cell
from isa_ros.validation.actuators import CheckedActuators, SHIPPED
from isa_ros.validation.behaviour import (
    bench, driven, light, MODELS, pushed, ROTARY, spool_at, stall)
from isa_ros.validation.entry import around, Entry, Findings, OWN
from isa_ros.validation.plant_theory import holding_force, steady
from isa_ros.validation.sheets import plant_of
import numpy as np

FULL_MA = 5.0           # coils in series: the stop of the spool
FULL_S = 0.04
LOADED = 0.97           # of the hydraulic stall force, against the motion
LOADED_MA = 1.5
LOADED_S = 0.4
STOP_PLACE, STOP_MA, STOP_S = 0.98, 0.6, 1.0
CREEP_MA, CREEP_S = 0.1, 0.5
PERCENT = 2.0


def limits(actuators: CheckedActuators = SHIPPED) -> Findings:
    """Measure the plants at full current, near stall, at the end stop, and their readings."""
    return Findings(tuple(entry for model in MODELS for entry in (
        _full_speed(actuators, model), _loaded_speed(actuators, model),
        _stopped(actuators, model), *_codes(actuators, model))))


def _own(name: str, where: str, ours: float, expected: float, unit: str, law: str,
         percent: float = PERCENT) -> Entry:
    return Entry(
        name=name, source=OWN, where=where, paper='no such number', ours=ours, unit=unit,
        tolerance=around(expected, percent=percent),
        tolerance_source=f'{expected:.4g} by {law}; {percent:g} %')


def _speed_unit(model: str) -> str:
    return 'rad/s' if model == ROTARY else 'm/s'


def _full_speed(actuators: CheckedActuators, model: str) -> Entry:
    """Compare the largest speed without load: the spool is at its stop."""
    spool = spool_at(model, FULL_MA)
    speed = driven(light(bench(actuators, model, 'mass', 0.1), model), spool, FULL_S)['velocity']
    return _own(f'{model}_full_speed', 'Fig 5', float(np.mean(speed[-len(speed) // 10:])),
                steady(model, spool=spool).speed, _speed_unit(model),
                'the flow curve at 5 mA, areas and friction, without load')


def _loaded_speed(actuators: CheckedActuators, model: str) -> Entry:
    """Compare the speed against nearly the stall force: little pressure is left for the lands."""
    spool, force = spool_at(model, LOADED_MA), -LOADED * stall(model)
    found = pushed(bench(actuators, model, 'mass', 0.2), force)
    n = round(LOADED_S * RATE_HZ)
    speed = found.excite(found.begin(force=-force), np.full(n, spool))['velocity']
    return _own(f'{model}_loaded_speed', 'eqs 13 to 17', float(np.mean(speed[-n // 10:])),
                steady(model, spool=spool, force=force).speed, _speed_unit(model),
                f'the lands under the {1.0 - LOADED:.0%} of pressure that the load leaves')


def _stopped(actuators: CheckedActuators, model: str) -> Entry:
    """Compare how far a held valve presses the moving part into its end stop."""
    plant, spool = plant_of(model), spool_at(model, STOP_MA)
    place = driven(bench(actuators, model, 'mass', STOP_PLACE), spool, STOP_S)['position']
    return _own(f'{model}_stop', 'section 5.1', (place[-1] - plant.chambers.stroke) / MILLI,
                holding_force(model, spool) / plant.mechanics.k_stop / MILLI,
                'mrad' if model == ROTARY else 'mm',
                f'the force of the leaking lands at {STOP_MA:g} mA over the stiffness of the stop')


def _codes(actuators: CheckedActuators, model: str) -> tuple[Entry, Entry]:
    """Compare the smallest steps of the readings of force and position in slow motions."""
    column = 'Smart manifold' if model == ROTARY else 'ISA'
    bits, encoder = (cell('table_3', f'{what} resolution', column) for what in ('ADC', 'Encoder'))
    code = 2.0 * float(plant_of(model).sensors.force_range) / 2.0 ** bits.number
    rotary = model == ROTARY
    per_printed = np.degrees(1.0) if rotary else 1e6
    place = steps(actuators, model, 'mass', 'position') * per_printed
    return (
        _own(f'{model}_force_code', bits.where, steps(actuators, model, 'blocked', 'force'), code,
             'Nm' if rotary else 'N', 'the range of the sensor over 2^12', 0.1),
        Entry.given(f'{model}_position_code', encoder, place, around(encoder.number, percent=5.0),
                    '5 %: half of its last printed digit or less'))


def steps(actuators: CheckedActuators, model: str, load: str, field: str) -> float:
    """Return the smallest step between two readings of a slowly changing field, NaN if none."""
    found = bench(actuators, model, load)
    group = found.begin(force=0.0)
    given = found.loop.per_reference * spool_at(model, CREEP_MA)
    commands = setpoints(
        group, found.loop.quantity, np.full(round(CREEP_S * RATE_HZ), given))
    readings = np.unique(group.advance_many(found.ports, commands).samples[field])
    return float(np.diff(readings).min()) if len(readings) > 1 else float('nan')
