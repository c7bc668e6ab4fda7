"""C11: oil is neither made nor lost while a cavity opens and closes, however fast and wherever."""

import math

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.loads.sheets import Mass
import numpy as np
import pytest
from tests.actuator.closed_cylinder import by_scipy, ClosedCylinder
from tests.sheets import smart_actuator

CONSERVED = 1e-9        # of the mass in a chamber
FILLED = 7e6            # Pa, before the stroke
DURATIONS = (0.01, 0.05, 0.2, 1.0)      # s, of a stroke out or back
EXTREMES: list[dict[str, float]] = [
    {'oil__effective_bulk_modulus': 2e9}, {'oil__effective_bulk_modulus': 1e7},
    {'oil__aeration_pressure_kpa': 1e-3}, {'oil__aeration_pressure_kpa': 100.0},
    {'oil__aeration_pressure_kpa': 7.3e-5},
    {'oil__vapour_pressure_kpa': 0.0}, {'oil__vapour_pressure_kpa': 50.0},
    {'oil__dead_volume_ml': 0.1}, {'oil__dead_volume_ml': 1000.0},
    {'oil__entrained_air': 1e-4}, {'oil__entrained_air': 0.2},
    {'oil__entrained_air': 0.01, 'oil__aeration_pressure_kpa': 1e-3,
     'oil__vapour_pressure_kpa': 0.0},
    {'oil__dead_volume_ml': 0.1, 'oil__effective_bulk_modulus': 2e9},
    {'mechanics__inertia': 1e3}, {'mechanics__inertia': 0.2}]


def stroke(cylinder: ClosedCylinder, travel: float, duration: float) -> tuple[float, float]:
    """
    Move the load out by ``travel`` and back, each in ``duration`` s; return what was worst.

    The largest change of a chamber's mass, relative, and the widest cavity, m3: eight looks.
    """
    steps = round(duration / PLANT_STEP / 4)
    acceleration = travel / (2 * steps * PLANT_STEP) ** 2
    masses = [chamber.mass for chamber in cylinder.chambers]
    lost = widest = 0.0
    for sign in (1, 1, -1, -1, -1, -1, 1, 1):
        cylinder.move(steps, sign * acceleration)
        for chamber, mass in zip(cylinder.chambers, masses):
            lost = max(lost, abs(chamber.mass / mass - 1.0))
            widest = max(widest, chamber.cavity)
    return lost, widest


@pytest.mark.parametrize('duration', DURATIONS)
@pytest.mark.parametrize(('model', 'place', 'travel'), [
    ('isa_v5', 0.05, 12e-3), ('isa_v5', 0.05, -12e-3), ('isa_v5', 0.0, 40e-3),
    ('isa_v2', 0.04, 12e-3), ('smart_manifold', 0.8, 0.2)])
def test_a_sealed_stroke_out_and_back_keeps_the_mass(model, place, travel, duration):
    """The chamber that is torn open and the other, compressed to 160 MPa."""
    cylinder = ClosedCylinder(model, place, FILLED)
    lost, widest = stroke(cylinder, travel, duration)
    area = cylinder.plant.chambers.area_a if travel > 0.0 else cylinder.plant.chambers.area_b
    # not all of the travel: the oil of 7 MPa and its air expand, sensor and piston yield
    assert widest > 0.6 * area * abs(travel)
    assert lost < CONSERVED


@pytest.mark.parametrize('duration', [0.01, 0.2])
def test_a_sealed_stroke_out_and_back_returns_to_its_pressure(duration):
    """Of the oil that is left alone: p_0 + beta ln(V_0/V), friction holds the piston aside."""
    cylinder = ClosedCylinder('isa_v5', 0.05, FILLED)
    before = cylinder.volumes(0.05)
    stroke(cylinder, 12e-3, duration)
    after = cylinder.volumes(float(cylinder.own.mechanics.position))
    beta = float(cylinder.plant.chambers.beta)
    for chamber, first, last in zip(cylinder.chambers, before, after):
        assert chamber.cavity == 0.0 and 6e6 < chamber.pressure < 8e6
        assert chamber.pressure == pytest.approx(
            FILLED + beta * math.log(first / last), abs=CONSERVED * beta)


@pytest.mark.parametrize('place', [0.0, 0.05])
@pytest.mark.parametrize('values', EXTREMES, ids=lambda values: ', '.join(
    f'{name.split("__")[1]} {value:g}' for name, value in values.items()))
def test_the_mass_is_kept_at_the_extremes_of_the_parameters(values, place):
    """At mid stroke, and from the end, where the chamber is next to nothing."""
    lost, _ = stroke(ClosedCylinder('isa_v5', place, FILLED, **values), 12e-3, 0.01)
    assert lost < CONSERVED


@pytest.mark.parametrize('refill', [False, True], ids=['sealed', 'refilled'])
def test_a_thrown_piston_moves_as_scipy_says(refill):
    """
    A free piston of 2 m/s between two springs of oil that boil in turn, ten cavities in 6 ms.

    The slope of a pressure jumps by at most beta A v/V where its oil begins to boil, and where
    its cavity closes: one step misses no more than a twenty-fourth of that, times h^2 A/m, of the
    speed. Twenty of them; the pressures follow by the springs.
    """
    speed, steps = 2.0, 300
    cylinder = ClosedCylinder('isa_v5', 0.05, 2e6, refill=refill, free=True)
    expected = by_scipy(cylinder, speed, np.arange(steps + 1) * PLANT_STEP)
    cylinder.own.mechanics.velocity = speed
    rows = []
    for _ in range(steps + 1):
        a, b = cylinder.chambers
        rows.append((float(cylinder.own.mechanics.position),
                     float(cylinder.own.mechanics.velocity),
                     a.pressure, a.cavity, b.pressure, b.cavity))
        cylinder.move()
    oil, inertia = cylinder.plant.chambers, float(cylinder.plant.mechanics.inertia)
    volume, area = min(cylinder.volumes(0.05)), float(oil.area_a)
    slope = float(oil.beta) * area * speed / volume
    fast = 20.0 * slope * PLANT_STEP**2 / 24.0 * area / inertia     # m/s
    stiffness = float(oil.beta) * area / volume                     # Pa/m
    ring = math.sqrt(area * stiffness / inertia)                    # rad/s
    assert expected[:, 3].max() > 0.05e-6 and (refill or expected[:, 5].max() > 0.02e-6)
    apart = np.abs(np.array(rows) - expected).max(axis=0)
    assert apart[1] < fast and apart[0] < fast / ring
    assert max(apart[2], apart[4]) < stiffness * fast / ring
    assert max(apart[3], apart[5]) < area * fast / ring


def test_a_sample_has_exact_pressures_and_cavities():
    """Where the sensor reads 0: at the vapour pressure, and the widest cavity of any tick."""
    actuator = smart_actuator('isa_v5', Mass(inertia=50.0, force=8000.0), position=0.02)
    sample, widest, lowest = actuator.sample, 0.0, 0.0
    returned = drawn = 0.0
    for _ in range(1000):
        actuator.tick()
        own = actuator.memory.continuous[0]['plant']['chambers']
        for side in 'ab':
            assert sample[f'chamber_pressure_{side}'] == own[f'p_{side}']
            assert sample[f'cavity_{side}'] == own[f'cavity_{side}']
        widest = max(widest, float(own['cavity_a']), float(own['cavity_b']))
        lowest = min(lowest, float(sample.chamber_pressure_a))
        if sample.cavity_a > 0.0:
            assert sample.pressure_a < 1e4
        returned += float(actuator.reply.return_volume)
        drawn += float(actuator.reply.supply_volume)
    assert lowest == 1e3 - ATMOSPHERE
    assert sample.largest_cavity == widest > float(sample.cavity_a) + 1e-7
    assert float(sample.return_volume) == pytest.approx(returned, rel=1e-12, abs=0.0)
    assert float(sample.supply_volume) == pytest.approx(drawn, rel=1e-12, abs=0.0)
