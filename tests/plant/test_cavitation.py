"""Oil below the atmosphere and with air: pressures of densities, and what a step of volumes is."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.record import rows_of
from isa_ros.plant import cavitation, chambers
import numpy as np
import pytest
from scipy.integrate import quad
from tests.sheets import actuator_sheet

SHEET = actuator_sheet('isa_v5').plant
VAPOUR = 1e3 - ATMOSPHERE
PRESSURES = (VAPOUR, -9e4, -2e3, 0.0, 5e4, 3e6, 25e6, 90e6)


def oil(**values: float) -> np.record:
    return chambers.chambers_record(SHEET.drive, replace(SHEET.oil, **values))


SOUND, AIRY = oil(), oil(entrained_air=0.02)
EXTREMES = [
    oil(), oil(effective_bulk_modulus=2e9), oil(aeration_pressure_kpa=0.1),
    oil(aeration_pressure_kpa=100.0), oil(vapour_pressure_kpa=0.0), oil(vapour_pressure_kpa=50.0),
    oil(entrained_air=1e-6), oil(entrained_air=0.2),
    oil(entrained_air=0.2, vapour_pressure_kpa=0.0, aeration_pressure_kpa=0.1)]
BOTH = pytest.mark.parametrize('row', [SOUND, AIRY], ids=['sound', 'airy'])


@BOTH
@pytest.mark.parametrize('p', PRESSURES)
def test_density_is_the_integral_of_the_modulus(row, p):
    """C11: ln of the density is the integral of dp/beta, here by quadrature of C5 and C12."""
    points = [q for q in (0.0,) if VAPOUR < q < p]
    expected = sum(
        quad(lambda q: 1.0 / cavitation.modulus(q, row), low, high, epsabs=0.0, epsrel=1e-12,
             limit=400)[0] for low, high in zip([VAPOUR, *points], [*points, p]))
    assert math.log1p(cavitation.denser(p, row)) == pytest.approx(expected, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize('row', EXTREMES)
@pytest.mark.parametrize('p', PRESSURES)
@pytest.mark.parametrize('near', [-ATMOSPHERE, 0.0, 1e8])
def test_the_pressure_of_a_density_is_that_of_before(row, p, near):
    """
    Whatever Newton's method starts from; at the extremes of every parameter.

    The density has a rounding of 1, 2.2e-16 times the modulus of the oil; ten of them.
    """
    p = max(p, float(row.p_vapour))
    found = cavitation.pressure_of(1.0 + cavitation.denser(p, row), near, row)
    assert found == pytest.approx(p, rel=1e-13, abs=2.3e-15 * cavitation.modulus(p, row) + 1e-9)


@given(p=st.floats(-9e4, 5e7), cavity=st.floats(1e-12, 1e-5))
def test_a_lack_is_a_cavity_or_what_the_pressure_has_compressed(p, cavity):
    """C11: positive with a cavity, whatever the pressure; else below 0, and back again."""
    volume = 2e-5
    assert cavitation.lack(VAPOUR, cavity, volume, SOUND) == cavity
    assert cavitation.contents(cavity, volume, 1e6, SOUND) == (SOUND.p_vapour, 0.0, 0.0)
    lacking = cavitation.lack(p, 0.0, volume, SOUND)
    assert lacking < 0.0
    found, elastance, more = cavitation.contents(lacking, volume, 0.0, SOUND)
    assert found == pytest.approx(p, rel=1e-9, abs=1e-5)
    assert elastance == pytest.approx(cavitation.modulus(p, SOUND) / volume, rel=1e-6)
    assert more == pytest.approx(-lacking / volume, rel=1e-12, abs=0.0)


def test_oil_that_just_fills_its_chamber_is_at_the_vapour_pressure():
    """C11 is continuous where the cavity has closed."""
    for row in EXTREMES:
        below, *_ = cavitation.contents(-1e-25, 2e-5, 0.0, row)
        assert below == pytest.approx(cavitation.contents(0.0, 2e-5, 0.0, row)[0], abs=1e-4)


def test_oil_with_air_boils_at_1_kilopascal_at_the_latest():
    """C12: air of no pressure would fill any volume."""
    assert oil(vapour_pressure_kpa=0.0).p_vapour == -ATMOSPHERE
    assert oil(vapour_pressure_kpa=0.0, entrained_air=1e-3).p_vapour == VAPOUR
    assert oil(vapour_pressure_kpa=3.0, entrained_air=1e-3).p_vapour == 3e3 - ATMOSPHERE


def test_lack_rates_are_those_of_the_mass_in_both_chambers():
    """C11: with V - D the oil's volume at the vapour's density, d(V - D)/dt = e Q."""
    v, q_a, q_b, more_a, more_b = 0.3, 2e-5, -3e-5, 0.02, 0.005
    rate_a, rate_b = chambers.lack_rates(
        q_a - SOUND.area_a * v, q_b + SOUND.area_b * v, more_a, more_b, v, SOUND)
    assert SOUND.area_a * v - rate_a == pytest.approx((1.0 + more_a) * q_a, rel=1e-12, abs=0.0)
    assert -SOUND.area_b * v - rate_b == pytest.approx((1.0 + more_b) * q_b, rel=1e-12, abs=0.0)


class TestAStepIsOfVolumes:
    """Where an integration of pressures would lose oil; a step of pressures elsewhere."""

    ROW = chambers.chambers_record(SHEET.drive, SHEET.oil, SHEET.mechanics.inertia)

    def of(self, row: np.record, s: float = 0.05, v: float = 0.0, **values: float) -> bool:
        state = rows_of(1, chambers.CHAMBERS_STATE)[0]
        state.p_a = state.p_b = 5e6
        for name, value in values.items():
            setattr(state, name, value)
        return bool(chambers.is_of_volumes(2e-5, state, s, v, row))

    @pytest.mark.parametrize('side', 'ab')
    def test_below_the_atmosphere_and_with_a_cavity(self, side):
        assert not self.of(self.ROW) and not self.of(self.ROW, **{f'p_{side}': 0.0})
        assert self.of(self.ROW, **{f'p_{side}': -1e-3})
        assert self.of(self.ROW, **{f'cavity_{side}': 1e-12})

    def test_with_air(self):
        assert self.of(AIRY)

    @pytest.mark.parametrize(('s', 'v', 'expected'), [
        (0.0, 2.7, False), (0.0, 2.8, True), (0.0, -2.8, True), (0.1, 3.9, False),
        (0.1, 4.1, True), (0.1, -4.1, True), (0.05, 4.1, False)])
    def test_where_the_piston_sweeps_a_hundredth_of_a_chamber(self, s, v, expected):
        """At the ends: 2 ml over 363 and 250 mm2 are 5.5 and 8.0 mm; a hundredth in 20 us."""
        assert self.of(self.ROW, s, v) is expected

    @pytest.mark.parametrize(('dead_volume', 's', 'expected'), [
        (1.6, 0.0, False), (1.5, 0.0, True), (1.5, 0.05, False), (1.5, 0.1, False),
        (0.75, 0.1, False), (0.72, 0.1, True)])
    def test_where_the_oil_is_a_spring_of_a_fifth_of_a_radian_a_step(
            self, dead_volume, s, expected):
        """A_A^2 beta/(m V) = (0.2/20 us)^2 at 1.538 ml, on the rod's side 0.729 ml."""
        row = chambers.chambers_record(
            SHEET.drive, replace(SHEET.oil, dead_volume_ml=dead_volume), SHEET.mechanics.inertia)
        assert self.of(row, s) is expected


@pytest.mark.parametrize('row', [SOUND, AIRY], ids=['sound', 'airy'])
def test_compiled_equals_python(row):
    """Replay compares bytes."""
    for p in PRESSURES:
        for function, arguments in (
                (cavitation.denser, (p, row)), (cavitation.modulus, (p, row)),
                (cavitation.lack, (p, 0.0, 2e-5, row)),
                (cavitation.contents, (-1e-7, 2e-5, p, row))):
            assert function(*arguments) == function.py_func(*arguments)
