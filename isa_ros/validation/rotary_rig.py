"""
The rotary rig under torque control: figures 12 and 13, with the gains of Table 4 and retuned ones.

The wheel follows the shipped scenarios; the torque loop is measured on the same actuator,
blocked. Hunting is in `rotary_hunting`.
"""

from dataclasses import fields
from typing import Any

from isa_ros.analysis.report.paper_figures import paper_figure
from isa_ros.analysis.response.rig import Choice, Rig
from isa_ros.analysis.signals.signals import signals_of
from isa_ros.config.models.catalogue import gait_section
from isa_ros.config.runs.changed_parameters import with_parameters
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place
from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.units import MILLI
from isa_ros.loads.drop_rig import Wheel
from isa_ros.paper.printed import statement
from isa_ros.scenario.trot import foot_at, TrotParameters
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import Run
from isa_ros.validation.actuators import CheckedActuators, SHIPPED
from isa_ros.validation.entry import (
    around, as_printed, at_least, Drawing, Entry, Findings, INPUT, Observation, OWN, PAPER,
    regression, RETUNED, TABLE_4, WORDS)
from isa_ros.validation.rotary_hunting import hunting, torque_code
from isa_ros.validation.torque_step import (
    bandwidths, LEVELS, measured_step, TorqueStep)
import numpy as np

RIG, ROTOR = 'rig_rotary', 'rotor'
MANIFOLD = 'smart_manifold'
PRESETS = (TABLE_4, RETUNED)
STEP_NM = 17.0              # 10 % of the rating, section 6
STRIDE_S = 1.0 / 1.7        # of the trot, and of the sine
STRIDES = 2.0               # the last ones, after both have settled
FEET = 4                    # of the trotting robot
# Of the shipped parameters with Table 4: what K_p, K_i, rotor and filters move.
RISE_MS, BANDS_HZ = 8.15, (56.7, 58.2)
UNDEFINED = 'the paper does not define its rise'
CHOSEN = 'erratum 26: the place of K_f, and 0 to 90 % as the rise'
# Why the torque follows the motion less closely than our target, by the gains.
LOOSER = {
    TABLE_4: 'K_f in front of the whole PID holds back the integral too: in the proportional part '
    'only the trot is at 3.0 % and K_v gains 5 times, but Fig 13 is lost (erratum 26)',
    RETUNED: 'as with Table 4: K_f, here 3 ms, holds back the integral too'}
DAMPED_LESS = 'K_f is three quarters of that of Table 4, for the torque in motion'
DIGIT = 'approximately: half of the last printed digit'


def rotary_rig(actuators: CheckedActuators = SHIPPED) -> Findings:
    """Measure torque step, bandwidth, tracking and hunting; draw figures 12 and 13."""
    trots = {gains: of_preset(actuators, 'trot', gains).simulate() for gains in PRESETS}
    stepped = of_preset(actuators, 'step', TABLE_4).simulate()
    return Findings(
        (*(entry for gains in PRESETS for entry in (
            *_torque_step(actuators, gains), *_tracking(actuators, trots[gains], gains))),
         _neglected_inertia(actuators), _carried()),
        (Drawing('fig_12', 'Position and torque of the wheel following a trot at 1 m/s, as '
                 'Fig 12.', paper_figure('position_torque_tracking', signals_of(trots[TABLE_4]))),
         Drawing('fig_13', f'Torque step of {STEP_NM:g} Nm with the wheel blocked, as Fig 13.',
                 paper_figure('torque_step', signals_of(stepped)))),
        (*_position(trots[TABLE_4]), *hunting(actuators)))


def of_preset(actuators: CheckedActuators, scenario: str, gains: str, **changes: float) -> Run:
    """Return a scenario of the rig with a preset's gains and other values by their REU keys."""
    return actuators.run(RIG, scenario, {
        f'actuators.{ROTOR}.preset': gains,
        **{f'actuators.{ROTOR}.parameters.reu.force.{key}': value
           for key, value in changes.items()}})


def blocked(actuators: CheckedActuators, gains: str) -> Rig:
    """Return the torque loop of the rig's actuator against the blocked load, at mid stroke."""
    return actuators.rig(Choice(name=MANIFOLD, loop='force', preset=gains))


def _torque_step(actuators: CheckedActuators, gains: str) -> tuple[Entry, ...]:
    bench = blocked(actuators, gains)
    found = measured_step(bench, STEP_NM)
    printed, low = statement('torque_rise_time'), statement('blocked_bandwidth_low')
    band = low.number, statement('blocked_bandwidth_high').number
    bands = dict(zip(('3_db', '90_deg'), bandwidths(bench, STEP_NM), strict=True))
    return (
        *(Entry.of(f'torque_rise_{name}', printed, found.rise[name] / MILLI, as_printed(printed),
                   DIGIT, gains=gains, **_reading_of_rise(name, gains)) for name in LEVELS),
        Entry.of('torque_steady_error', statement('torque_steady_error'), found.steady_error,
                 around(0.0, by=torque_code()), 'eliminated: to a code of the torque sensor',
                 source=WORDS, unit='Nm', gains=gains),
        Entry(name='torque_overshoot', source=OWN, where='section 5.1, Fig 13',
              paper='low-amplitude oscillations, in the experiment only', ours=found.overshoot,
              unit='percent', tolerance=(0.0, 5.0),
              tolerance_source='the band into which it settles', gains=gains,
              reason=DAMPED_LESS if gains == RETUNED else ''),
        *(Entry(name=f'torque_bandwidth_{name}', source=PAPER, where=low.where,
                paper='50 to 100', ours=ours, unit='Hz', tolerance=band, gains=gains,
                tolerance_source='the printed range', reading='erratum 25: a stepped sine of '
                f'{STEP_NM:g} Nm, 10 % of the rating; the bandwidth is not defined')
          for name, ours in bands.items()),
        *(_step_regressions(found, bands) if gains == TABLE_4 else ()))


def _reading_of_rise(definition: str, gains: str) -> dict[str, Any]:
    """Return what is said of a definition of the rise: with one of them K_f was placed."""
    if (definition, gains) == ('0_90', TABLE_4):
        return {'reading': CHOSEN, 'is_choice': True}
    return {'reason': UNDEFINED}


def _step_regressions(found: TorqueStep, bands: dict[str, float]) -> tuple[Entry, ...]:
    where = 'section 5.1, Fig 13'
    return (
        regression('torque_rise', where, found.rise['0_90'] / MILLI, RISE_MS, 'ms', TABLE_4),
        *(regression(f'torque_bandwidth_{name}', where, ours, expected, 'Hz', TABLE_4)
          for (name, ours), expected in zip(bands.items(), BANDS_HZ, strict=True)))


def _tracking(actuators: CheckedActuators, trot: Result, gains: str) -> tuple[Entry, ...]:
    sine = torque_error(of_preset(actuators, 'wheel_sine', gains).simulate())
    uncompensated = torque_error(
        of_preset(actuators, 'wheel_sine', gains, kv=0.0).simulate())
    seen = '5 % are hardly seen in a figure'
    return (
        *(Entry(name=f'{name}_torque_error', source=OWN, where='section 5.1, Fig 12',
                paper='sufficient for locomotion', ours=error, gains=gains,
                unit='percent of peak, rms', tolerance=(0.0, 5.0), tolerance_source=seen,
                reason=LOOSER[gains])
          for name, error in (('trot', torque_error(trot)), ('sine', sine))),
        Entry(name='sine_torque_error_without_kv', source=WORDS, where='section 3, Fig 7',
              paper='K_v injects the flow of the motion', ours=uncompensated / sine,
              unit='times', tolerance=at_least(1.0), gains=gains,
              tolerance_source='without K_v the error is larger, one side'))


def torque_error(result: Result) -> float:
    """Return the rms torque error of the last strides in percent of the reference's peak."""
    late = _late(result)
    return relative_error(
        result[f'{ROTOR}.force_reference'][late], result[f'{ROTOR}.force'][late])


def _late(result: Result) -> np.ndarray:
    late: np.ndarray = result.time > result.time[-1] - STRIDES * STRIDE_S
    return late


def relative_error(reference: np.ndarray, applied: np.ndarray) -> float:
    """Return the rms of the error in percent of the reference's peak; both (n,)."""
    error = applied - reference
    return 100.0 * float(np.sqrt(np.mean(error * error)) / np.abs(reference).max())


def _position(trot: Result) -> tuple[Observation, ...]:
    """Observe how far the wheel is from its motion: the paper has no number of it."""
    late = _late(trot)
    reference = trot[f'{ROTOR}.position_reference'][late]
    error = trot[f'{ROTOR}.position'][late] - reference
    rms = 100.0 * float(np.sqrt(np.mean(error * error)) / (0.5 * np.ptp(reference)))
    where, words = 'section 5.1, Fig 12', 'resemblance between simulation and experiments'
    return (
        Observation(name='trot_position_error', where=where, paper=words, ours=rms,
                    unit='percent of amplitude, rms', how='Table 4, the last strides'),
        Observation(name='trot_position_peak', where=where, paper=words,
                    ours=float(np.abs(error).max()), unit='rad', how='Table 4, the last strides'))


def _carried() -> Entry:
    """Read the mass of the trotting robot back from the loads of its feet  (G4)."""
    shipped = gait_section('trot', 'gait')
    trot = build(TrotParameters, {
        each.name: shipped[each.name] for each in fields(TrotParameters)}, Place('trot'))
    low, high = (statement(f'robot_mass_{end}') for end in ('low', 'high'))
    strides = np.linspace(0.0, 1.0, 200, endpoint=False)
    loads = [foot_at(trot, float(stride)).load for stride in strides]
    return Entry(
        name='trot_robot_mass', source=INPUT, where=low.where, paper=f'{low.text} to {high.text}',
        ours=float(np.mean(loads)) * FEET / STANDARD_GRAVITY, unit='kg',
        tolerance=(low.number - low.half_digit, high.number + high.half_digit),
        tolerance_source='the printed range; half of the last printed digit')


def _neglected_inertia(actuators: CheckedActuators) -> Entry:
    """Compare the step with that of a rotor which carries the sensor's inertia."""
    bench, ratio = blocked(actuators, TABLE_4), statement('sensor_inertia')
    wheel = of_preset(actuators, 'trot', TABLE_4).configuration.actuators[0].load
    assert isinstance(wheel, Wheel)
    rotor = bench.config.sheet.plant.mechanics.inertia
    heavier = bench.with_config(with_parameters(
        bench.config, {'plant.mechanics.inertia': rotor + wheel.inertia / ratio.number},
        bench.run.source))
    without, carried = (measured_step(each, STEP_NM).rise['0_90'] for each in (bench, heavier))
    return Entry(
        name='sensor_inertia', source=OWN, where=ratio.where,
        paper='neglected: 2e3 times smaller than that of the load',
        ours=100.0 * abs(carried / without - 1.0), unit='percent', tolerance=(0.0, 1.0),
        tolerance_source='change of the 0 to 90 % rise, of 1 %, with it on the rotor',
        gains=TABLE_4)
