"""C30 to C32: the oil behind a spear, against a model of masses, and what its account says."""

from dataclasses import replace
import math
from typing import Any

from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.signals import MEASURED
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.plant.cushion import divide
from isa_ros.plant.cushion_sheets import SpearCushion
from isa_ros.reu.plausibility import EVIDENCE_STATE, unexplained_force
import numpy as np
import pytest
from tests.actuator.closed_cylinder import ClosedCylinder
from tests.actuator.cushion_masses import EASE, FILLED, MASS, masses, OfMasses, OPENS, SPEED
from tests.actuator.energy import account, CLOSES, remainder
from tests.sheets import actuator_sheet, override, setpoint, smart_actuator

CONSERVED = 1e-9        # of the mass in a chamber
FROM_END = 20.5e-3              # m, half a millimetre in front of the spear
SPEAR = SpearCushion(
    length_mm=20.0, spear_mm=28.0, entry_mm=4.0, port_lpm=300.0, restriction_lpm=4.0,
    check_lpm=30.0, check_opening_kpa=50.0, rated_drop_mpa=7.0, trapped_ml=1.5)
SIDES = {'a': -1.0, 'b': 1.0}   # the end that the piston moves to


def thrown(side: str, cushion: SpearCushion = SPEAR, speed: float = SPEED) -> ClosedCylinder:
    """Return a closed cylinder whose free mass is thrown at the cushion of a side."""
    cylinder = ClosedCylinder(
        'cylinder', 0.1, FILLED, free=True, mechanics__inertia=MASS,
        **{f'cushion_{side}': cushion})
    cylinder.plant.relief.p_open, cylinder.plant.relief.slope = OPENS, EASE
    stroke = float(cylinder.plant.chambers.stroke)
    moving = cylinder.own.mechanics
    moving.position = cylinder.state.load.position = (
        FROM_END if side == 'a' else stroke - FROM_END)
    moving.velocity = SIDES[side] * speed
    return cylinder


CASES = {
    'sound': {}, 'check valve shut': {'check_stuck': 1.0},
    'check valve open': {'check_stuck': 2.0, 'check_lpm': 2.0},
    'restriction half blocked': {'restriction_blocked': 0.5},
    'restriction blocked': {'restriction_blocked': 1.0}}
STARTS = {'in': (FROM_END, -SPEED, FILLED), 'out': (3e-3, 0.1, 10e6)}
"""Distance to the end, its rate, and the pressure of that chamber: thrown in, or pushed out."""


@pytest.mark.parametrize('case', CASES)
@pytest.mark.parametrize('start', STARTS)
@pytest.mark.parametrize('side', SIDES)
def test_a_mass_moves_in_a_cushion_as_one_system_of_masses_says(side, start, case):
    """
    For 50 ms: in, stopped and thrown back; or pushed out by the port's oil.

    The kernels divide and join the chamber up to one step late: nothing is further from what it
    should be than it moves in two steps where it is fastest.
    """
    cushion = SpearCushion(**{**vars(SPEAR), **CASES[case]})
    cylinder, steps = thrown(side, cushion), 2500
    model, own = OfMasses(cylinder, side, cushion), cylinder.own
    stroke = cylinder.plant.chambers.stroke
    d, rate, filled = STARTS[start]
    sign = 1.0 if side == 'a' else -1.0
    own.mechanics.position = d if side == 'a' else stroke - d
    own.mechanics.velocity = sign * rate
    setattr(own.chambers, f'p_{side}', filled)
    divide(own, cylinder.plant)
    expected = model.solved(
        [float(own.mechanics.position), sign * rate, *masses(cylinder, model)],
        steps * PLANT_STEP, steps + 1, start == 'out')
    found, far = [], 'b' if side == 'a' else 'a'
    for _ in range(steps + 1):
        found.append([float(own.mechanics.position), float(own.mechanics.velocity),
                      float(getattr(own.chambers, f'p_{side}')), float(own.cushion.p),
                      float(getattr(own.chambers, f'p_{far}'))])
        cylinder.move()
    rows = np.array(found)
    out = (rows[:, 3] == 0.0) | (expected[:, 3] == 0.0)
    rows[out, 3] = expected[out, 3] = np.nan
    steps_of = np.nanmax(np.abs(np.diff(expected, axis=0)), axis=0)
    assert np.nanmax(expected[:, 3]) > 3e6 and np.mean(out) < 0.7
    assert (np.nanmax(np.abs(rows - expected), axis=0) < 2.0 * steps_of).all()


@pytest.mark.parametrize('is_shut', [0.0, 1.0], ids=['sound', 'shut'])
@pytest.mark.parametrize('side', SIDES)
def test_a_sealed_cylinder_keeps_its_mass_through_a_cushion(side, is_shut):
    """Thrown in and out again, or torn out of a shut cushion, whose oil boils."""
    cushion = replace(SPEAR, check_stuck=is_shut, restriction_blocked=is_shut)
    cylinder = thrown(side, cushion, speed=-0.3 if is_shut else 0.3)
    if is_shut:
        moving = cylinder.own.mechanics
        moving.position += SIDES[side] * 12e-3
        divide(cylinder.own, cylinder.plant)
    cylinder.plant.relief.p_open = math.inf
    model, before, ends, widest = OfMasses(cylinder, side, cushion), None, set(), 0.0
    for _ in range(300):
        near, trapped, far = masses(cylinder, model)
        before = before or (near + trapped, far)
        ends.add(float(cylinder.own.cushion.end))
        widest = max(widest, float(cylinder.own.cushion.cavity))
        assert abs((near + trapped) / before[0] - 1.0) < CONSERVED
        assert abs(far / before[1] - 1.0) < CONSERVED
        cylinder.move(10)
    assert ends == {SIDES[side]} | (set() if is_shut else {0.0})
    assert is_shut == (widest > 1e-9)


@pytest.mark.parametrize('side', SIDES)
def test_the_energy_of_a_thrown_mass_is_accounted_for(side):
    """E2, E3, E6: it is throttled at the spear, goes to the outside, or is stored in the oil."""
    cylinder = thrown(side)
    cylinder.plant.relief.p_open, cylinder.plant.chambers.leaks_out = math.inf, 1.0
    cylinder.plant.chambers[f'c_le_{side}'] = 1e-10
    before = 0.5 * MASS * SPEED * SPEED
    cylinder.move(1000)
    moving, found = cylinder.own.mechanics, cylinder.state.totals.energies
    left = 0.5 * MASS * float(moving.velocity) ** 2
    parts = [float(found[name]) for name in found.dtype.names]
    assert float(found.throttling) > 0.1 * before and left < 0.5 * before
    remainder = left - before + sum(parts)
    print('remainder', remainder / (before + sum(map(abs, parts))))
    assert abs(remainder) < CLOSES * (before + sum(map(abs, parts)))


def cushioned(**values: float) -> Any:
    """Return the actuator `cylinder` with cushions and 170 kg, told to run into its end."""
    sheet = actuator_sheet('cylinder', 'default', 'cushioned')
    for path, value in values.items():
        sheet = override(sheet, path.replace('__', '.'), value)
    found = smart_actuator('cylinder', 'mass', sheet=sheet, position=0.16)
    found.accept(setpoint(position=0.199, stiffness=3e5, damping=5e3))
    return found


def test_a_cushion_lessens_the_impact_and_its_pressure_is_in_the_sample():
    """The same command without cushions ends in the stop; the account closes over the spear."""
    peaks, speeds = [], []
    for variant in ('cushioned', ''):
        found = cushioned() if variant else smart_actuator('cylinder', 'mass', position=0.16)
        found.accept(setpoint(position=0.215, stiffness=3e5, damping=1e3))
        arrived, peak = 0.0, 0.0
        for _ in range(4000):
            found.tick()
            own = found.memory.continuous[0]['plant']
            assert float(found.sample.cushion_pressure) == float(own['cushion']['p'])
            peak = max(peak, float(found.sample.cushion_pressure))
            if float(own['mechanics']['position']) > 0.2 and arrived == 0.0:
                arrived = float(own['mechanics']['velocity'])
        peaks.append(peak)
        speeds.append(arrived)
    assert peaks[0] > 8e6 and peaks[1] == 0.0
    assert speeds[0] < 0.5 * speeds[1]


def test_the_account_of_an_actuator_closes_through_its_cushion():
    found = cushioned()
    for position in (0.195, 0.15, 0.199, 0.15):
        found.accept(setpoint(position=position))
        for _ in range(2000):
            found.tick()
    assert remainder(account(found)) < CLOSES


def test_a_snapshot_in_a_cushion_continues_byte_for_byte():
    found, twin = cushioned(), cushioned()
    for own in (found, twin):
        for _ in range(1500):
            own.tick()
    assert float(found.sample.cushion_pressure) > 1e5
    other = smart_actuator('cylinder', 'mass', position=0.1, sheet=actuator_sheet(
        'cylinder', 'default', 'cushioned'))
    other.restore(found.snapshot())
    for own in (other, twin):
        for _ in range(200):
            own.tick()
    assert other.snapshot() == twin.snapshot() != found.snapshot()


def test_an_actuator_that_starts_in_a_cushion_is_divided_from_the_start():
    sheet = actuator_sheet('cylinder', 'default', 'cushioned')
    found = smart_actuator('cylinder', 'blocked', sheet=sheet, position=0.01)
    own = found.memory.continuous[0]['plant']
    assert own['cushion']['end'] == -1.0 and own['cushion']['p'] == own['chambers']['p_a']


@pytest.mark.parametrize(('place', 'is_trusted'), [
    (0.019, False), (0.022, True), (0.179, True), (0.181, False)])
def test_in_a_cushion_no_force_contradicts_the_pressures(place, is_trusted):
    """R14, and the error of the force: the spear takes a part that no sensor measures."""
    own = actuator_record(actuator_sheet('cylinder', 'default', 'cushioned'), 0)
    evidence = row_record(own).reu.protection.evidence
    state = rows_of(1, EVIDENCE_STATE)[0]
    measured = rows_of(1, MEASURED)[0]
    measured.position, measured.pressure_a = place, 10e6
    found = unexplained_force(measured, 0.0, 0.2, evidence, state)
    assert (found > 1e3) == is_trusted and (found == 0.0) != is_trusted
