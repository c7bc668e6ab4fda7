"""The terms of the plant's rates, one by one: each with numbers of its own."""

from dataclasses import replace

from isa_ros.plant import rates as of
from isa_ros.plant.energy import no_powers
from isa_ros.plant.plant import plant_record, PLANT_STATE
from isa_ros.plant.rates import plant_rates
from isa_ros.plant.relief import relief_flow
from isa_ros.plant.return_spring import CoilSpring, spring_record
from isa_ros.plant.spool import spool_rates
import numpy as np
import pytest
from tests.sheets import actuator_sheet, plant_row

SPRING = CoilSpring(preload=800.0, stiffness=6e3, open_to='tank')


def states() -> tuple[np.record, np.record]:
    """Return a state and its rates, zeros."""
    y, rates = np.zeros(2, PLANT_STATE).view(np.recarray)
    return y, rates


def sprung(open_to: str) -> np.record:
    """Return the plant of a cylinder with a spring in B, which is open."""
    plant = plant_record(actuator_sheet('cylinder').plant)[0]
    plant.spring = spring_record(replace(SPRING, open_to=open_to))
    return plant


@pytest.mark.parametrize('half', [0.0, 3e-4])
def test_the_spool_gets_the_series_current_behind_its_play_with_its_bias(half: float) -> None:
    """V1, V12, V24: i/parallel, less half of the play, and the null bias of both pressures."""
    plant, (y, rates) = plant_row('isa_v5'), states()
    assert plant.coil.parallel == 2.0
    plant.spool.bias, plant.spool.bias_s, plant.spool.bias_t = 1e-4, 2e-11, 3e-10
    plant.spool.p_s_ref = 15e6
    plant.hysteresis.is_on, plant.hysteresis.half = float(half > 0.0), half
    y.coil.current, y.spool.position = 4e-3, 1e-5
    of.valve_rates(y, 4e-3, 20e6, 1e6, plant, rates)
    expected = states()[1]
    current = 2e-3 - half + (1e-4 + 2e-11 * 5e6 + 3e-10 * 1e6)
    spool_rates(y.spool, current, plant.valve.k_spool, plant.spool, expected.spool)
    for name in rates.spool.dtype.names:
        assert rates.spool[name] == pytest.approx(expected.spool[name], rel=1e-9, abs=0.0)
    assert max(abs(rates.spool[name]) for name in rates.spool.dtype.names) > 1e-3


def test_a_play_that_is_not_there_has_no_part() -> None:
    """V24 only with hysteresis: its plays may be anything."""
    plant, (y, rates), other = plant_row('isa_v5'), states(), states()[1]
    y.coil.current = 4e-3
    of.valve_rates(y, 4e-3, 20e6, 0.0, plant, rates)
    plant.hysteresis.half = 3e-4
    of.valve_rates(y, 4e-3, 20e6, 0.0, plant, other)
    assert rates.tobytes() == other.tobytes()


def test_both_chambers_refill_from_the_return_and_ease_to_it() -> None:
    """C6: below the return's pressure in, above the opening out; nothing is pushed or kept."""
    plant = plant_row('isa_v5')
    found = of.outlets(0.03, 0.1, 1e6, (0.9e6, 1e9, 0.0, 0.0), (22.1e6, 1e9, 0.0, 0.0), 5.0, 7.0,
                       plant)
    into, out = relief_flow(0.9e6, 1e6, plant.relief), relief_flow(22.1e6, 1e6, plant.relief)
    assert into < 0.0 < out
    assert found == (into, out, 1e6, out, 5.0, 7.0)
    # against no pressure of the return it is not below it
    assert of.outlets(0.03, 0.1, 0.0, (0.9e6, 1e9, 0.0, 0.0), (1e6, 1e9, 0.0, 0.0), 0.0, 0.0,
                      plant)[0] == 0.0


@pytest.mark.parametrize(('open_to', 'vent', 'share'), [
    ('tank', 0.4e6, 1.0), ('breather', 0.0, 0.0)])
def test_an_open_chamber_gives_what_it_gains_and_its_spring_pulls(
        open_to: str, vent: float, share: float) -> None:
    """C33 and M5, at its own pressure: all surplus leaves, to the tank if it is open to that."""
    plant = sprung(open_to)
    _, out_b, found, returned, push, kept = of.outlets(
        0.1, -0.2, 0.4e6, (5e6, 1e12, 0.0, 0.0), (vent, 1e12, 0.0, 3e-5), 50.0, 7.0, plant)
    assert (out_b, found, returned) == (3e-5, vent, share * 3e-5)
    assert push == pytest.approx(50.0 - 1400.0, rel=1e-12)
    assert kept == pytest.approx(7.0 - 0.2 * 1400.0, rel=1e-12)


def test_the_piston_has_the_sum_of_all_forces() -> None:
    """M4: oil, what a spear and a spring push, friction, sensor and stop, over its inertia."""
    plant, (_, rates) = plant_row('isa_v5'), states()
    s, v, z = -2e-5, -0.03, 1e-6        # in the stop at the retracted end
    sensor, rubs, stop = of.moving_rates(
        s, v, z, s - 3e-6, -0.02, 4e6, 2e6, 0.75, 123.0, plant, rates)
    own = plant.mechanics
    assert sensor == pytest.approx(own.k_s * 3e-6 + own.d_s * -0.01, rel=1e-9)
    assert stop == pytest.approx(own.k_stop * 2e-5 + own.d_stop * 0.03, rel=1e-9)
    oil = 4e6 * plant.chambers.area_a - 2e6 * plant.chambers.area_b
    assert rates.mechanics.position == v
    assert rates.mechanics.velocity * own.inertia == pytest.approx(
        0.75 * oil + 123.0 - rubs - sensor + stop, rel=1e-12)
    assert rubs < 0.0 and rates.friction.bristle != 0.0


def test_the_powers_of_the_oil_are_those_of_its_flows() -> None:
    """E3 and E6, beside what the lands have lost; the vent has a pressure of its own."""
    plant, powers = plant_row('isa_v5'), no_powers()
    powers.throttling = 1000.0
    of.count_oil(6e6, 2e6, 0.3e6, 0.1e6, 5e-5, 7e-5, 2e-5, 3e-5, 11.0, 13.0, plant, powers)
    assert powers.throttling == 1011.0
    assert powers.relief == pytest.approx(5.7e6 * 2e-5 + 1.9e6 * 3e-5, rel=1e-12)
    assert powers.compression == pytest.approx(6e6 * 3e-5 + 2e6 * 4e-5 + 13.0, rel=1e-12)
    assert powers.cross_port == pytest.approx(
        plant.chambers.c_li * 16e12, rel=1e-12, abs=0.0)


def test_the_powers_of_the_moving_part_are_those_of_its_forces() -> None:
    """E4 and E5: work at the load's speed, the sensor's damping at their difference."""
    plant, powers = plant_row('isa_v5'), no_powers()
    of.count_moving(0.3, 0.25, 900.0, 60.0, -40.0, plant.mechanics, powers)
    assert powers.friction == pytest.approx(18.0, rel=1e-12)
    assert powers.work == pytest.approx(225.0, rel=1e-12)
    assert powers.damping == pytest.approx(plant.mechanics.d_s * 0.0025 + 12.0, rel=1e-9)


def test_what_leaves_b_for_the_air_is_not_returned() -> None:
    """The return gets B's oil with a spring that is open to the tank, and none of it else."""
    found = []
    for open_to in ('tank', 'breather'):
        plant, (y, rates) = sprung(open_to), states()
        y.chambers.p_a, y.mechanics.position, y.mechanics.velocity = 5e6, 0.1, 0.2
        _, _, q_t = plant_rates(
            y, 0.1, 0.2, 0.0, 20e6, 0.0, plant, False, rates, True, no_powers())
        found.append(q_t)
    swept = 0.2 * plant.chambers.area_b
    assert found[0] - found[1] == pytest.approx(swept, rel=0.05)
