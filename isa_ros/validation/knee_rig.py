"""
The knee rig: section 5.2 and figures 14, 19 and 20, by the shipped run files and scenarios.

The ISA v5 at the knee has the gains of Table 4 as read, and those retuned for the leg (the paper
retuned its own, section 5.2): two columns. Figure 14 is run on the pallet of the rig and on
rubber, figure 20 on the pallet and on the ground of `leg.yaml`.
"""

from collections.abc import Mapping
import math
from typing import NamedTuple

from isa_ros.analysis.report.paper_figures import draw_force, draw_position
from isa_ros.analysis.signals.signals import signals_of
from isa_ros.analysis.signals.step_response import step_figures, StepFigures
from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.paper.printed import statement
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import Run
from isa_ros.validation.actuators import CheckedActuators, SHIPPED
from isa_ros.validation.entry import (
    around, as_printed, at_least, at_most, Drawing, Entry, Findings, INPUT, OWN, RETUNED, TABLE_4,
    WORDS)
from isa_ros.validation.isa_v5 import cell_code, CODE
from isa_ros.validation.plots import stacked
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
TRACKING = 5.0         # percent
FREE_FALL_BY = 3e-3    # s: 2 ms of sag under the impedance, 1 ms of a tick
STANDING = 0.5         # s, at the end of it
AS_READ = ('K_v of Table 4, read as 0.24 mm per m/s, is a quarter of the flow that the motion '
           'takes (erratum 6); with four times as much the sine is at 4.8 % and 32 N, the drop '
           'at 3.6 %')


def knee_rig(actuators: CheckedActuators = SHIPPED) -> Findings:
    """Compare force steps, sine and drop of the knee with figures 14, 19 and 20."""
    found: list[Entry] = []
    for gains in (TABLE_4, RETUNED):
        steps = {(level, ground): on_ground(actuators, ground, f'force_step_{level}', gains
                                            ).simulate()
                 for level in FORCE_STEPS for ground in (WOOD, RUBBER)}
        sine = of_preset(actuators, RIG, 'knee_sine', gains).simulate()
        drops = {config: of_preset(actuators, config, 'drop', gains).simulate(DROP_S)
                 for config in (RIG, LEG)}
        found += [*_force_steps(steps, gains), *_sine(sine, gains),
                  *(entry for config, drop in drops.items()
                    for entry in _drop(config, drop, gains))]
    return Findings((*found, *_weight(drops[RIG])),
                    (_fig_14(steps), _fig_19(sine), _fig_20(drops[RIG])))


def of_preset(actuators: CheckedActuators, config: str, scenario: str, gains: str) -> Run:
    """Return a scenario of a leg with a preset's gains at the knee."""
    return actuators.run(config, scenario, {f'actuators.{KNEE}.preset': gains})


def on_ground(actuators: CheckedActuators, material: str, scenario: str, gains: str) -> Run:
    """Return the knee rig with a packaged material below the foot."""
    return of_preset(actuators, RIG, scenario, gains).replace({'leg.ground': material})


def edges(
        t: np.ndarray, force: np.ndarray, level: str) -> tuple[StepFigures, StepFigures]:
    """Return the figures of the knee's force (N) in the step and in the step back, (n,)."""
    base, top = FORCE_STEPS[level]

    def figures(first: float, last: float, start: float, target: float) -> StepFigures:
        inside = slice(*np.searchsorted(t, (first - 1e-9, last - 1e-9)))
        return step_figures(t[inside] - first, force[inside], start, target)
    return figures(STEP_AT, BACK_AT, base, top), figures(BACK_AT, END_AT, top, base)


def _force_steps(steps: dict[tuple[str, str], Result], gains: str) -> list[Entry]:
    entries = []
    found = {key: edges(result.time, result[FORCE], key[0]) for key, result in steps.items()}
    for (level, ground), both in found.items():
        entries.append(Entry(
            name=f'force_step_{level}_{ground}_error', source=OWN, where='section 5.2, Fig 14',
            paper='a step reference for force', unit='N', gains=gains,
            ours=max(abs(edge.steady_error) for edge in both),
            tolerance=(0.0, STEADY_ERROR), tolerance_source=f'twice {CODE}',
            reason='K_i as read has not yet settled 0.4 s after the step'))
    for level in FORCE_STEPS:
        ratios = [soft.overshoot / hard.overshoot if hard.overshoot else math.nan
                  for soft, hard in zip(found[level, RUBBER], found[level, WOOD], strict=True)]
        entries.append(Entry(
            name=f'force_step_{level}_rubber_oscillation', source=WORDS,
            where='section 5.1, Fig 14', paper='potentially increased by the rubber',
            ours=min(ratios), unit='1', tolerance=at_least(1.0), gains=gains,
            tolerance_source='increased: overshoot on rubber over that on wood, the lesser of up '
            'and down; one side',
            reason='no overshoot on wood to compare with'))
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


def _sine(sine: Result, gains: str) -> tuple[Entry, ...]:
    position, force = tracking(sine, sine.time, KNEE)
    printed = statement('knee_tracking')
    return (
        Entry(name='knee_sine_position', source=OWN, where=printed.where, paper=printed.text,
              ours=position, unit='percent of amplitude, rms', tolerance=(0.0, TRACKING),
              tolerance_source='a target: 5 % are hardly seen in a figure', gains=gains,
              reason=AS_READ),
        Entry(name='knee_sine_force', source=OWN, where=printed.where, paper=printed.text,
              ours=force, unit='N, rms', tolerance=(0.0, 2.0 * cell_code()),
              tolerance_source=f'a target: twice {CODE}', gains=gains, reason=AS_READ))


def touchdown(t: np.ndarray, normal: np.ndarray) -> float:
    """Return the time (s) from the release to the first contact by the ground force, (n,)."""
    touching = np.flatnonzero(normal > 0.0)
    return float(t[touching[0]] - RELEASE) if len(touching) else math.nan


def ground_force(result: Result) -> np.ndarray:
    """Return the vertical force of the ground on the foot in N, (n,)."""
    force: np.ndarray = result['body.foot_force'][:, 2]
    return force


class LegDrop(NamedTuple):
    """The knee's force in a drop."""

    fall: float
    """From the release to the first contact, s."""
    peak: float
    """Largest force, N."""
    over_reference: float
    """That over the largest reference."""
    tracking: float
    """Rms of the force's error from 50 ms after the contact, percent of the largest reference."""
    rest: float
    """Deviation of the force at the end, N."""


def drop_figures(drop: Result) -> LegDrop:
    """Return the figures of a drop of `DROP_S`."""
    t, force, reference = drop.time, drop[FORCE], drop[f'{FORCE}_reference']
    fall = touchdown(t, ground_force(drop))
    after = t > RELEASE + fall + 0.05
    peak, highest = float(force.max()), float(reference.max())
    return LegDrop(fall, peak, peak / highest, 100.0 * _rms((force - reference)[after]) / highest,
                   float(force[t > DROP_S - STANDING].std()))


def _drop(config: str, drop: Result, gains: str) -> tuple[Entry, ...]:
    found = drop_figures(drop)
    height = 0.5 * STANDARD_GRAVITY * found.fall * found.fall
    limit, where = statement('knee_force_limit'), 'section 5.2, Fig 20'
    free = math.sqrt(2.0 * 1e-2 * statement('drop_height').number / STANDARD_GRAVITY)
    return (
        Entry.of(f'{config}_drop_peak', limit, found.peak, at_most(limit.number),
                 'the printed limit, one side', gains=gains),
        Entry(name=f'{config}_drop_peak_over_reference', source=WORDS, where=limit.where,
              paper='a peak right after the impact', unit='1', gains=gains,
              ours=found.over_reference, tolerance=at_least(1.0),
              tolerance_source='the largest force over the largest reference, one side'),
        Entry(name=f'{config}_drop_fall', source=OWN, where=where, paper='from 10 cm',
              ours=found.fall,
              unit='s', tolerance=around(free, by=FREE_FALL_BY), gains=gains,
              tolerance_source='a free fall of 10 cm; 3 ms for sag and tick'),
        Entry.given(f'{config}_drop_height', statement('drop_height'), 100.0 * height,
                    as_printed(statement('drop_height')),
                    'half of the last printed digit, from the time of fall', gains=gains),
        Entry(name=f'{config}_drop_tracking', source=OWN, where=where,
              paper='the reference starts being tracked', unit='percent', gains=gains,
              ours=found.tracking, tolerance=(0.0, TRACKING), reason=AS_READ,
              tolerance_source='a target: rms from 50 ms after the impact, of the peak'),
        Entry(name=f'{config}_drop_rest', source=OWN, where='section 5.2',
              paper='able to stabilize the leg', gains=gains,
              ours=found.rest, unit='N', tolerance=(0.0, cell_code()),
              tolerance_source=f'a target: {CODE}', reason=AS_READ))


def _weight(drop: Result) -> tuple[Entry, ...]:
    leg, slider = statement('leg_weight'), statement('slider_weight')
    config = drop.scenario.run.leg
    assert config is not None
    body = config.sheet.body
    links = body.mass_scale * sum(link.mass_kg for link in (body.hip, body.thigh, body.calf))
    standing = ground_force(drop)[drop.time > DROP_S - STANDING].mean()
    falling = leg.number + slider.number
    return (
        Entry.given('leg_weight', leg, links, as_printed(leg),
                    'approximately: half of the last printed digit'),
        Entry(name='falling_weight', source=INPUT, where=slider.where,
              paper='approximately 10.2 and 5 kg',
              ours=float(standing / STANDARD_GRAVITY), unit='kg',
              tolerance=around(falling, by=leg.half_digit),
              tolerance_source='half of the last digit of 10.2; ground force at rest'))


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
