"""
The basis of the numbers of all other groups: the plant's fixed step and the leg's linkages.

The plant is compared with scipy's DOP853 of the same equations, at a tolerance of 1e-12
(`isa_ros.analysis.accuracy.agreement`); the valve-driven cylinder of the same kernels
(`isa_ros.analysis.accuracy.cylinder`) with a solution known to twelve digits; lever and
extension of the knees with the table of the published linkages. The paper gives no such
numbers.
"""

from collections.abc import Iterable
import math

from isa_ros.analysis.accuracy import agreement, cylinder
from isa_ros.analysis.accuracy.agreement import compare, Difference, LOADS, Piece
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import MILLI
from isa_ros.plant.chambers import volumes
from isa_ros.surroundings.linkage import actuator_coordinate
from isa_ros.surroundings.linkage_sheet import linkage_record
from isa_ros.validation.entry import at_most, Entry, Findings, OWN
from isa_ros.validation.sheets import plant_of

MODELS = ('smart_manifold', 'isa_v2', 'isa_v5')
SMOOTH, SINE, STEPS = agreement.PIECES
STATES = ('plant.chambers.p_a', 'plant.chambers.p_b', 'plant.mechanics.position',
          'load.position')
OTHER = 'independent integration'
NOTHING = 'no accuracy of its solver'
LEAST_SMOOTH = 4e-10   # (p_c h)^4/120 of 0.4 of the current, over 10 ms
FINER = 0.1            # of the step
SECONDS = (1, 5, 10)
SOLUTION = {'x': -1.30241237753e-3, 'p_a': 5452872.548, 'p_b': 8386667.199}  # m, Pa, Pa
REACH = {'x': ('m', 1e-9), 'p_a': ('Pa', 1.0), 'p_b': ('Pa', 1.0)}
PUBLISHED = 'public model of the robot'
HALF_DIGIT = 0.05      # mm
ROUNDED = 'half of the last printed digit'
# Joint angle in deg; extension between the pins (None: not in the table) and lever in mm.
KNEES: dict[str, tuple[tuple[float, float | None, float], ...]] = {
    'rig_knee': (
        (-38.4, 65.6, 24.9), (-60.0, 55.4, 29.4), (-80.0, 44.5, 32.7), (-100.0, 32.7, 34.6),
        (-110.0, 26.6, 34.7), (-120.0, 20.6, 34.1), (-140.0, 9.2, 30.6), (-158.7, 0.1, 24.6)),
    'hyq_leg': (
        (-20.0, None, 22.5), (-60.0, None, 41.3), (-80.0, None, 44.9), (-120.0, None, 35.6),
        (-140.0, None, 22.5))}
SHORTEST_KNEE = 313.1  # mm, pin to pin at extension 0 of the table


def numerics() -> Findings:
    """Compare plant, cylinder and linkages with independent results."""
    return Findings((
        *(entry for model in MODELS for entry in _plant(model)), *_cylinder(),
        *(entry for config in KNEES for entry in _knee(config))))


def kink(model: str) -> float:
    """
    Return the allowed error of a step at a kink of the flow, relative to the supply pressure.

    A slope that jumps by J within a step h causes an error J h^2/8: here the whole slope of one
    land under half the supply pressure, at the spool's largest speed in the sine, into the
    smaller chamber at mid stroke.
    """
    plant = plant_of(model)
    oil, valve = plant.chambers, plant.valve
    largest = max(SINE.currents)     # A through coils in parallel, 10 Hz
    spool_rate = 2.0 * math.pi * 10.0 * largest / plant.coil.parallel * valve.k_spool
    flow = max(valve.k_low, valve.k_high) * valve.per_root_drop * math.sqrt(
        0.5 * agreement.SUPPLY) * spool_rate   # m3/s2
    jump = flow * oil.beta / min(volumes(0.5 * oil.stroke, oil))
    return float(jump * PLANT_STEP * PLANT_STEP / 8.0 / agreement.SUPPLY)


def worst(found: Iterable[Difference], states: tuple[str, ...] = ()) -> float:
    """Return the largest relative difference; only that of ``states``, if given."""
    return max(each.relative for each in found if not states or each.state in states)


def _differences(model: str, piece: Piece, h: float = PLANT_STEP) -> list[Difference]:
    return [found for load in LOADS for found in compare(model, load, piece, h)]


def _plant(model: str) -> tuple[Entry, ...]:
    coarse, fine = (worst(_differences(model, STEPS, h)) for h in (
        PLANT_STEP, FINER * PLANT_STEP))
    return (
        Entry(name=f'{model}_smooth', source=OWN, where=OTHER, paper=NOTHING, unit='1',
              ours=worst(_differences(model, SMOOTH), STATES), tolerance=at_most(LEAST_SMOOTH),
              tolerance_source='(p_c h)^4/120 of a current that jumps by 0.4, over 10 ms'),
        Entry(name=f'{model}_sine', source=OWN, where=OTHER, paper=NOTHING, unit='1',
              ours=worst(_differences(model, SINE), STATES), tolerance=at_most(kink(model)),
              tolerance_source='a slope of the flow that jumps by J within a step: J h^2/8'),
        Entry(name=f'{model}_finer_steps', source=OWN, where=OTHER, paper=NOTHING, unit='1',
              ours=fine / coarse, tolerance=at_most(FINER),
              tolerance_source='steps of 5 mA in a tenth of the plant step: a jump leaves h'))


def _cylinder() -> Iterable[Entry]:
    states = cylinder.simulate(round(max(SECONDS) / cylinder.HOLD))
    for name, (unit, reach) in REACH.items():
        column = cylinder.STATES.index(name)
        apart = max(abs(float(states[round(t / cylinder.HOLD), column]) - SOLUTION[name])
                    for t in SECONDS)
        yield Entry(
            name=f'cylinder_{name}', source=OWN, where=OTHER,
            paper=f'solution {SOLUTION[name]:.12g}',
            ours=apart, unit=unit, tolerance=at_most(reach),
            tolerance_source='the valve-driven cylinder after 1, 5 and 10 s')


def _knee(config: str) -> Iterable[Entry]:
    leg = load_run(find(config, CONFIG)).leg
    assert leg is not None
    row = linkage_record(leg.sheet.kfe)
    levers, extensions = [], []
    for angle, extension, lever in KNEES[config]:
        place, arm, _ = actuator_coordinate(math.radians(angle), row)
        levers.append(abs(arm / MILLI - lever))
        if extension is not None:
            length = (place + row['retracted_length']) / MILLI - SHORTEST_KNEE
            extensions.append(abs(length - extension))
    for name, apart in (('lever', levers), ('extension', extensions)):
        if apart:
            yield Entry(
                name=f'{config}_{name}', source=OWN, where=PUBLISHED,
                paper=f'{len(apart)} places of a table',
                ours=float(max(apart)), unit='mm', tolerance=at_most(HALF_DIGIT + 1e-9),
                tolerance_source=ROUNDED)
