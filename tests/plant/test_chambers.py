"""Chambers: volumes, continuity, stall forces, oil stiffness."""

from dataclasses import replace
import re

from hypothesis import given, strategies as st
from isa_ros.errors import ParameterError
from isa_ros.plant import cavitation, chambers
import numpy as np
import pytest
from tests.sheets import actuator_sheet, plant_row

SUPPLY = 20.7e6  # Pa

MANIFOLD = plant_row('smart_manifold').chambers
ISA_V5 = plant_row('isa_v5').chambers
BOTH = pytest.mark.parametrize('oil', [MANIFOLD, ISA_V5], ids=['manifold', 'v5'])

fractions = st.floats(0.0, 1.0)
flows = st.floats(-2e-4, 2e-4)
pressures = st.floats(0.0, 22.5e6)


def test_areas_are_table_2():
    """Bore 21.5 and rod 12 mm: 363.05 and 249.95 mm2, physics.md section 2."""
    areas = actuator_sheet('isa_v5').plant.drive.areas
    assert areas == pytest.approx((363.05e-6, 249.95e-6), rel=2e-5, abs=0.0)


@pytest.mark.parametrize(('model', 'stroke'), [
    ('isa_v2', 0.080), ('isa_v5', 0.100), ('smart_manifold', 1.745)])
def test_strokes_are_those_of_the_tables(model, stroke):
    """Tables 2 and 5: 80 and 100 mm, 100 deg printed as 1.745 rad; a product with 1e-3."""
    assert plant_row(model).chambers.stroke == pytest.approx(stroke, rel=2.3e-16, abs=0.0)


@pytest.mark.parametrize('values, message', [
    ({'aeration_pressure_kpa': 7e-5}, 'aeration_pressure_kpa = 7e-05 kPa, must be >= 7.19e-05'),
    ({'aeration_pressure_kpa': 1e-9}, 'or the oil never boils'),
    ({'effective_bulk_modulus': 1e3}, 'effective_bulk_modulus = 1000 Pa, must be > 1003.25 Pa'),
    ({'vapour_pressure_kpa': 0.0, 'aeration_pressure_kpa': 7.3e-5}, 'must be >= 7.33e-05 kPa')])
def test_oil_that_would_never_boil_is_refused(values, message):
    """C5 to the vapour pressure is 100: 100.325 kPa (1 + 100.325/(2 p_air))/beta_eff."""
    oil = actuator_sheet('isa_v5').plant.oil
    with pytest.raises(ParameterError, match=re.escape(message)):
        replace(oil, **values)
    replace(oil, aeration_pressure_kpa=7.2e-5)


@pytest.mark.parametrize('rod_mm', [21.5, 30.0])
def test_a_rod_as_thick_as_its_piston_is_refused(rod_mm):
    """The rod would leave no piston area, which is a divisor."""
    with pytest.raises(ParameterError, match=f'rod_mm = {rod_mm:g} mm, must be < bore_mm = 21.5'):
        replace(actuator_sheet('isa_v5').plant.drive, rod_mm=rod_mm)


@pytest.mark.parametrize(('oil', 'out', 'back'), [
    (MANIFOLD, 177.8, 177.8), (ISA_V5, 7515.0, 5174.0)], ids=['manifold', 'v5'])
def test_hydraulic_stall(oil, out, back):
    """C3, errata 15: supply against return; 0.5 % is physics.md's acceptance."""
    assert chambers.hydraulic_force(SUPPLY, 0.0, oil) == pytest.approx(out, rel=0.005)
    assert chambers.hydraulic_force(0.0, SUPPLY, oil) == pytest.approx(-back, rel=0.005)


@BOTH
def test_each_swept_volume_counts_once(oil):
    """C1, errata 16: the volumes at the ends are dead volume and dead plus swept volume."""
    start, end = chambers.volumes(0.0, oil), chambers.volumes(oil.stroke, oil)
    # one product and one sum, each rounded once; a volume is 1e-6 m3 and more
    assert start == pytest.approx(
        (oil.dead_volume, oil.dead_volume + oil.area_b * oil.stroke), rel=1e-14, abs=0.0)
    assert end == pytest.approx(
        (oil.dead_volume + oil.area_a * oil.stroke, oil.dead_volume), rel=1e-14, abs=0.0)


@given(fraction=fractions, q_a=flows, q_b=flows, p_a=pressures, p_b=pressures,
       v=st.floats(-1.0, 1.0))
def test_oil_is_conserved(fraction, q_a, q_b, p_a, p_b, v):
    """C2: V dP/beta is inflow minus swept volume; the leakage from A enters B."""
    for oil in (MANIFOLD, ISA_V5):
        s = fraction * oil.stroke
        v_a, v_b = chambers.volumes(s, oil)
        rate_a, rate_b = chambers.pressure_rates(q_a, q_b, p_a, p_b, s, v, oil)
        stored = (rate_a * v_a + rate_b * v_b) / oil.beta
        entered = q_a + q_b - (oil.area_a - oil.area_b) * v
        # ten roundings of terms no larger than the flows and the swept volumes
        scale = 4e-4 + oil.area_a * abs(v) + 2.0 * oil.c_li * abs(p_a - p_b)
        assert stored == pytest.approx(entered, abs=1e-14 * scale)


@BOTH
def test_aerated_oil_is_soft_and_continuous(oil):
    """C5: beta_eff at that of the atmosphere, half of it one aeration pressure below."""
    assert cavitation.stiffening(0.0, oil) == oil.beta
    assert cavitation.stiffening(-oil.p_air, oil) == pytest.approx(0.5 * oil.beta)


@BOTH
def test_oil_stiffness_is_the_linearised_force(oil):
    """C4: trapped oil has the stiffness k_oil for a small displacement (integral of C2)."""
    s, step = 0.4 * oil.stroke, 1e-9
    rate_a, rate_b = chambers.pressure_rates(0.0, 0.0, 10e6, 10e6, s, 1.0, oil)
    force = chambers.hydraulic_force(rate_a * step, rate_b * step, oil)
    assert -force / step == pytest.approx(chambers.oil_stiffness(s, oil), rel=1e-9)


@given(fraction=fractions, q_a=flows, q_b=flows, p_a=st.floats(-1e5, 22e6),
       p_b=st.floats(-1e5, 22e6), v=st.floats(-1.0, 1.0))
def test_compiled_rates_equal_their_python_source(fraction, q_a, q_b, p_a, p_b, v):
    """Replay compares bytes, so the compiler may not reorder."""
    args = (q_a, q_b, p_a, p_b, fraction * ISA_V5.stroke, v, ISA_V5)
    compiled = np.array(chambers.pressure_rates(*args))
    assert compiled.tobytes() == np.array(chambers.pressure_rates.py_func(*args)).tobytes()
