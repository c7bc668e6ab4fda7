"""
Limit cycles of the blocked torque loop: sections 5.1 and 6 of the paper.

"High controller gains might lead to limit cycles as a steady state", and the text reports
oscillations of the experiment against stiff metal. Which gains and which stiffness is not printed.
"""

from isa_ros.analysis.response.rig import Choice
from isa_ros.analysis.response.step import step
from isa_ros.config.runs.changed_parameters import Values, with_parameters
from isa_ros.reu.block import Pid
from isa_ros.validation.actuators import CheckedActuators
from isa_ros.validation.entry import Observation
from isa_ros.validation.sheets import model_sheet

RIG, MANIFOLD = 'rig_rotary', 'smart_manifold'
STEP_NM = 17.0
MIDDLE, STOP = 50.0, 5.0    # deg; the rig stops the wheel 5 deg inside the range
RIPPLE_S = 1.0
HIGHER, HIGH = 1.25, 2.5    # times the torque gains of Table 4
SLOWER_HZ = 1000.0
STIFF = {'plant.mechanics.sensor_stiffness': 5e4,   # Nm/rad, the largest plausible one
         'load.stiffness': 1e5}                     # Nm/rad, twice that of the sheet
WHERE = 'sections 5.1 and 6'


def hunting(actuators: CheckedActuators) -> tuple[Observation, ...]:
    """
    Observe what remains of a step with the gains of Table 4, higher ones, and less rate.

    The paper names neither gains nor stiffness that hunt, so nothing is judged: a bar from below
    would be met by any damage that makes the loop less stable.
    """
    def observed(name: str, paper: str, how: str, changes: Values, place: float) -> Observation:
        return Observation(
            name=name, where=WHERE, paper=paper, ours=ripple(actuators, place, changes),
            unit='Nm', how=how)
    high, stiff = 'high gains might lead to limit cycles', 'oscillates on stiff metal contact'
    return (
        observed('hunting_as_printed', stiff, 'Table 4, at mid stroke', {}, MIDDLE),
        observed('hunting_at_the_stop', stiff, 'Table 4, 5 deg inside the range', {}, STOP),
        observed('hunting_stiffest', stiff, 'Table 4, there, with a torque sensor of 5e4 and a '
                 'support of 1e5 Nm/rad, the stiffest plausible', STIFF, STOP),
        observed('hunting_gains_1_25', high, f'{HIGHER:g} times K_p and K_i of Table 4, at mid '
                 'stroke', gains(HIGHER), MIDDLE),
        observed('hunting_gains_2_5', high, f'{HIGH:g} times K_p and K_i of Table 4, at mid '
                 'stroke', gains(HIGH), MIDDLE),
        observed('hunting_1_khz', 'sampling frequencies can be varied', 'Table 4 at 1 kHz, at mid '
                 'stroke', {'reu.force.rate_hz': SLOWER_HZ}, MIDDLE))


def torque_code() -> float:
    """Return the resolution of the torque sensor, Nm."""
    sensors = model_sheet(MANIFOLD).plant.sensors
    return float(2.0 * sensors.force_range / 2.0 ** sensors.adc_bits)


def gains(factor: float) -> Values:
    """Return the torque gains of Table 4 times a factor."""
    force = model_sheet(MANIFOLD).reu.force
    assert isinstance(force, Pid)
    return {'reu.force.kp': factor * force.kp, 'reu.force.ki': factor * force.ki}


def ripple(actuators: CheckedActuators, place: float, changes: Values) -> float:
    """Return the deviation (Nm) that remains after a step, blocked at ``place`` (deg)."""
    bench = actuators.rig(Choice(name=RIG, loop='force', position=place))
    changed = with_parameters(bench.config, changes, bench.run.source)
    return step(bench.with_config(changed), RIPPLE_S, STEP_NM).figures.ripple
