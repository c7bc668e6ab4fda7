"""
Limit cycles of the blocked torque loop: sections 5.1 and 6 of the paper.

"High controller gains might lead to limit cycles as a steady state", and the experiment of
figure 13 oscillated against stiff metal. Which gains and which stiffness is not printed.
"""

from isa_ros.analysis.response.rig import Choice
from isa_ros.analysis.response.step import step
from isa_ros.config.runs.changed_parameters import Values, with_parameters
from isa_ros.reu.block import Pid
from isa_ros.validation.actuators import Actuators
from isa_ros.validation.entry import at_least, Entry, OWN, PAPER
from isa_ros.validation.sheets import model_sheet

RIG, MANIFOLD, TABLE_4 = 'rig_rotary', 'smart_manifold', 'table_4'
STEP_NM = 17.0
MIDDLE, STOP = 50.0, 5.0    # deg; the rig stops the wheel 5 deg inside the range
RIPPLE_S = 1.0
HIGHER, HIGH = 1.25, 2.5    # times the torque gains of Table 4
SLOWER_HZ = 1000.0
STIFF = {'plant.mechanics.sensor_stiffness': 5e4,   # Nm/rad, the largest plausible one
         'load.stiffness': 1e5}                     # Nm/rad, twice that of the sheet
WHERE = 'sections 5.1 and 6'
HUNTS = 'it deviates by more than one code of the torque sensor'


def hunting(actuators: Actuators) -> tuple[Entry, ...]:
    """Measure what remains of a step with the gains of Table 4, higher ones, and less rate."""
    code = torque_code()

    def target(name: str, paper: str, change: Values) -> Entry:
        ours = max(ripple(actuators, place, change) for place in (MIDDLE, STOP))
        stiff = '' if ours >= code else f'{ripple(actuators, STOP, {**STIFF, **change}):.2g}'
        return Entry(
            name=name, source=OWN, where=WHERE, paper=paper, ours=ours, unit='Nm',
            tolerance=at_least(code), gains=TABLE_4,
            tolerance_source=f'a target, by another model: {HUNTS}',
            reason=f'it settles; {stiff} Nm near the stop with a torque sensor of 5e4 and a '
            'support of 1e5 Nm/rad, the stiffest plausible')
    high = 'high gains might lead to limit cycles'
    return (
        Entry(name='hunting_gains_2_5', source=PAPER, where=WHERE, paper=high,
              ours=ripple(actuators, MIDDLE, gains(HIGH)), unit='Nm', tolerance=at_least(code),
              tolerance_source=f'2.5 times Table 4 is high; {HUNTS}', gains=TABLE_4,
              reason='2.5 times the gains of Table 4 are still damped'),
        target('hunting_gains_1_25', high, gains(HIGHER)),
        target('hunting_as_printed', 'oscillates on stiff metal contact', {}),
        target('hunting_1_khz', 'sampling frequencies can be varied',
               {'reu.force.rate_hz': SLOWER_HZ}))


def torque_code() -> float:
    """Return the resolution of the torque sensor, Nm."""
    sensors = model_sheet(MANIFOLD).plant.sensors
    return float(2.0 * sensors.force_range / 2.0 ** sensors.adc_bits)


def gains(factor: float) -> Values:
    """Return the torque gains of Table 4 times a factor."""
    force = model_sheet(MANIFOLD).reu.force
    assert isinstance(force, Pid)
    return {'reu.force.kp': factor * force.kp, 'reu.force.ki': factor * force.ki}


def ripple(actuators: Actuators, place: float, changes: Values) -> float:
    """Return the deviation (Nm) that remains after a step, blocked at ``place`` (deg)."""
    bench = actuators.rig(Choice(name=RIG, loop='force', position=place))
    changed = with_parameters(bench.config, changes, bench.run.source)
    return step(bench.with_config(changed), RIPPLE_S, STEP_NM).figures.ripple
