"""
The knee rig: section 5.2 and figures 14, 19 and 20, by the shipped run files and scenarios.

The ISA v5 at the knee has the gains retuned for the leg. Figure 14 is run on the pallet of
the rig and on rubber, figure 20 on the pallet and on the ground of `leg.yaml`.
"""

from collections.abc import Mapping
import math

from isa_ros.analysis.report.paper_figures import draw_force, draw_position
from isa_ros.analysis.signals.signals import signals_of
from isa_ros.analysis.signals.step_response import step_figures, StepFigures
from isa_ros.analysis.validation.entry import around, at_least, at_most, Drawing, Entry, Findings
from isa_ros.analysis.validation.isa_v5 import cell_code, CODE
from isa_ros.analysis.validation.plots import stacked
from isa_ros.core.gravity import STANDARD_GRAVITY
from isa_ros.paper.printed import statement
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load, Run
import numpy as np

RIG, LEG, KNEE = 'rig_knee', 'leg', 'kfe'
FORCE = f'{KNEE}.force'
WOOD, RUBBER = 'wood', 'rubber'
FORCE_STEPS = {'low': (200.0, 500.0), 'high': (1000.0, 3000.0)}  # N, of the scenarios
STEP_AT, BACK_AT, END_AT = 0.3, 0.7, 1.0     # s, of the scenarios
FIRST_PERIOD = 1.1     # s: both sines have settled by then
RELEASE = 0.1          # s, of the drop
DROP_S = 3.0           # until the leg stands
STEADY_ERROR = 10.0    # N
STANDING = 0.5         # s, at the end of it


def knee_rig() -> Findings:
    """Compare force steps, sine and drop of the knee with figures 14, 19 and 20."""
    steps = {(level, ground): on_ground(ground, f'force_step_{level}').simulate()
             for level in FORCE_STEPS for ground in (WOOD, RUBBER)}
    sine = load(RIG, 'knee_sine').simulate()
    drops = {config: load(config, 'drop').simulate(DROP_S) for config in (RIG, LEG)}
    return Findings(
        (*_force_steps(steps), *_sine(sine),
         *(entry for config, drop in drops.items() for entry in _drop(config, drop)),
         *_weight(drops[RIG])),
        (_fig_14(steps), _fig_19(sine), _fig_20(drops[RIG])))


def on_ground(material: str, scenario: str) -> Run:
    """Return the knee rig with a packaged material below the foot."""
    return load(RIG, scenario).replace({'leg.ground': material})


def edges(
        t: np.ndarray, force: np.ndarray, level: str) -> tuple[StepFigures, StepFigures]:
    """Return the figures of the knee's force (N) in the step and in the step back, (n,)."""
    base, top = FORCE_STEPS[level]

    def figures(first: float, last: float, start: float, target: float) -> StepFigures:
        inside = slice(*np.searchsorted(t, (first - 1e-9, last - 1e-9)))
        return step_figures(t[inside] - first, force[inside], start, target)
    return figures(STEP_AT, BACK_AT, base, top), figures(BACK_AT, END_AT, top, base)


def _force_steps(steps: dict[tuple[str, str], Result]) -> list[Entry]:
    entries = []
    found = {key: edges(result.time, result[FORCE], key[0]) for key, result in steps.items()}
    for (level, ground), both in found.items():
        entries.append(Entry(
            name=f'force_step_{level}_{ground}_error', source='section 5.2, Fig 14',
            paper='a step reference for force', unit='N',
            ours=max(abs(edge.steady_error) for edge in both),
            tolerance=at_most(STEADY_ERROR), tolerance_source=f'twice {CODE}'))
    for level in FORCE_STEPS:
        ratios = [soft.overshoot / hard.overshoot for soft, hard in zip(
            found[level, RUBBER], found[level, WOOD], strict=True)]
        entries.append(Entry(
            name=f'force_step_{level}_rubber_oscillation', source='section 5.1, Fig 14',
            paper='larger by the compliance of rubber', ours=min(ratios), unit='1',
            tolerance=at_least(1.0),
            tolerance_source='overshoot on rubber over that on wood, the lesser of up and down'))
    return entries


def tracking(signals: Mapping[str, np.ndarray], t: np.ndarray, name: str) -> tuple[float, float]:
    """
    Return the rms errors of position and force of an actuator; ``t`` (s) are the times.

    The position's in percent of half its reference's range, the force's in N or Nm.
    """
    late = t >= FIRST_PERIOD
    half = 0.5 * float(np.ptp(signals[f'{name}.position_reference'][late]))
    position, force = (
        _rms((signals[f'{name}.{field}'] - signals[f'{name}.{field}_reference'])[late])
        for field in ('position', 'force'))
    return 100.0 * position / half, force


def _sine(sine: Result) -> tuple[Entry, ...]:
    wheel = load('rig_rotary', 'wheel_sine').simulate()
    rotary, _ = tracking(wheel, wheel.time, 'rotor')
    position, force = tracking(sine, sine.time, KNEE)
    return (
        Entry(name='knee_sine_position', source='section 5.2, Fig 19',
              paper='similar to the rotary actuator', ours=position, unit='percent',
              tolerance=at_most(rotary),
              tolerance_source='rms over amplitude; the wheel of the rotary rig in its sine'),
        Entry(name='knee_sine_force', source='section 5.2, Fig 19',
              paper='similar to the rotary actuator', ours=force, unit='N',
              tolerance=at_most(2.0 * cell_code()), tolerance_source=f'rms; twice {CODE}'))


def touchdown(t: np.ndarray, normal: np.ndarray) -> float:
    """Return the time (s) from the release to the first contact by the ground force, (n,)."""
    touching = np.flatnonzero(normal > 0.0)
    return float(t[touching[0]] - RELEASE) if len(touching) else math.nan


def ground_force(result: Result) -> np.ndarray:
    """Return the vertical force of the ground on the foot in N, (n,)."""
    force: np.ndarray = result['body.foot_force'][:, 2]
    return force


def _drop(config: str, drop: Result) -> tuple[Entry, ...]:
    t, force, reference = drop.time, drop[FORCE], drop[f'{FORCE}_reference']
    fall = touchdown(t, ground_force(drop))
    after = t > RELEASE + fall + 0.05
    standing = t > DROP_S - STANDING
    height = 0.5 * STANDARD_GRAVITY * fall * fall
    limit = statement('knee_force_limit')
    return (
        Entry.of(f'{config}_drop_peak', limit, float(force.max()), (2000.0, limit.number),
                 'the printed limit, and well above the 0.7 kN of standing'),
        Entry(name=f'{config}_drop_peak_over_reference', source=limit.where,
              paper='a peak right after the impact', unit='1',
              ours=float(force.max() / reference.max()), tolerance=at_least(1.0),
              tolerance_source='the largest force over the largest reference'),
        Entry.of(f'{config}_drop_impact_time', statement('impact_time'), fall,
                 around(0.1, by=0.05), 'half of its one printed digit; the fall takes 0.143 s'),
        Entry.of(f'{config}_drop_height', statement('drop_height'), 100.0 * height,
                 around(10.0, by=0.5), 'half of the last printed digit, from the time of fall'),
        Entry(name=f'{config}_drop_tracking', source='section 5.2, Fig 20',
              paper='the reference starts being tracked', unit='percent',
              ours=100.0 * _rms((force - reference)[after]) / float(reference.max()),
              tolerance=at_most(5.0),
              tolerance_source='rms from 50 ms after the impact, of the peak: read off a figure'),
        Entry(name=f'{config}_drop_rest', source='section 5.2', paper='able to stabilize the leg',
              ours=float(force[standing].std()), unit='N', tolerance=at_most(cell_code()),
              tolerance_source=CODE))


def _weight(drop: Result) -> tuple[Entry, ...]:
    leg, slider = statement('leg_weight'), statement('slider_weight')
    config = drop.scenario.run.leg
    assert config is not None
    body = config.sheet.body
    links = body.mass_scale * sum(link.mass_kg for link in (body.hip, body.thigh, body.calf))
    standing = ground_force(drop)[drop.time > DROP_S - STANDING].mean()
    falling = leg.number + slider.number
    return (
        Entry.of('leg_weight', leg, links, around(leg.number, by=0.05),
                 'half of the last printed digit'),
        Entry(name='falling_weight', source=slider.where, paper=falling,
              ours=float(standing / STANDARD_GRAVITY), unit='kg',
              tolerance=around(falling, by=0.05),
              tolerance_source='half of the last printed digit; ground force at rest'))


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values * values)))


def _fig_14(steps: dict[tuple[str, str], Result]) -> Drawing:
    figure, axes = stacked('time, s', *(f'{level}: force, N' for level in FORCE_STEPS))
    for ax, level in zip(axes, FORCE_STEPS):
        hard = steps[level, WOOD]
        ax.plot(hard.time, hard[f'{FORCE}_reference'], 'b--', label='reference')
        for ground, style in ((WOOD, 'r'), (RUBBER, 'C2')):
            stepped = steps[level, ground]
            ax.plot(stepped.time, stepped[FORCE], style, linewidth=1.0, label=ground)
        ax.legend(loc='upper right', fontsize='small')
    return Drawing(
        'fig_14', 'Force steps of the knee with the foot on wood and on rubber, as Fig 14.',
        figure)


def _fig_19(sine: Result) -> Drawing:
    figure, (place, force) = stacked('time, s', '', '')
    actuator, signals = sine.scenario.run.actuator(KNEE), signals_of(sine)
    draw_position(place, actuator, signals)
    draw_force(force, actuator, signals)
    place.legend(loc='upper right', fontsize='small')
    return Drawing('fig_19', "The knee's position follows a sine, as Fig 19; below, its force.",
                   figure)


def _fig_20(drop: Result) -> Drawing:
    figure, (force, contact) = stacked('time, s', '', 'ground, N')
    draw_force(force, drop.scenario.run.actuator(KNEE), signals_of(drop))
    contact.plot(drop.time, ground_force(drop), 'k')
    contact.set_xlim(0.0, 1.5)
    force.legend(loc='upper right', fontsize='small')
    return Drawing(
        'fig_20', 'Force of the knee in a drop of 10 cm, let go at 0.1 s, as Fig 20; below, '
        'the ground force.', figure)
