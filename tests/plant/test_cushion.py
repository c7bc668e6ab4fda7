"""C30 to C32, part by part: volumes, the flow at the spear, what a sheet may have."""

from collections.abc import Mapping
from dataclasses import replace
import math
from typing import Any

from hypothesis import given, strategies as st
import isa_ros
from isa_ros.actuator.sheet import refuse_wiring
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.plant import cushion
from isa_ros.plant.chambers import volumes
from isa_ros.plant.cushion_sheets import SpearCushion, trapped_area
from isa_ros.plant.linearised import LoadSide
from isa_ros.plant.plant import plant_record, PLANT_STATE
from isa_ros.plant.step_limits import refuse_too_fast
import numpy as np
import pytest
from tests.sheets import actuator_sheet, override

SHEET = override(
    actuator_sheet('cylinder', 'default', 'cushioned'), 'plant.cushion_a.restriction_lpm', 3.0)
PLANT = row_record(plant_record(SHEET.plant))
OWN = SHEET.plant.cushion_a
LPM = 1e-3 / 60.0
DROP = st.floats(-30e6, 80e6)


def own_cushion(**values: float) -> np.record:
    """Return the record of the retracted end of the model, with some values replaced."""
    sheet = replace(OWN, **values)
    return cushion.cushion_record(sheet, trapped_area(sheet, SHEET.plant.drive.bore_mm))


def test_the_trapped_side_is_the_ring_around_the_spear():
    """40 mm bore, 20 mm spear; a sleeve of 32 mm around the rod of 25 mm."""
    for own, spear in ((PLANT.cushion_a, 0.020), (PLANT.cushion_b, 0.032)):
        assert float(own.area) == pytest.approx(
            math.pi / 4.0 * (0.040**2 - spear**2), rel=1e-12, abs=0.0)


@pytest.mark.parametrize('end', [-1.0, 0.0, 1.0])
def test_both_sides_make_up_the_chamber(end):
    """C30: port and trapped side are C1's volume; the trapped one is V_0 at its end."""
    s = 0.013 if end < 0.0 else 0.190
    v_a, v_b = cushion.port_volumes(end, s, PLANT)
    all_a, all_b = volumes(s, PLANT.chambers)
    trapped = (0.0 if end == 0.0 else 1.5e-6 + float(PLANT.cushion_a.area) * 0.013 if end < 0.0
               else 1.5e-6 + float(PLANT.cushion_b.area) * 0.010)
    assert all_a - v_a == pytest.approx(trapped if end < 0.0 else 0.0, rel=1e-9, abs=1e-18)
    assert all_b - v_b == pytest.approx(trapped if end > 0.0 else 0.0, rel=1e-9, abs=1e-18)


def test_a_stop_that_yields_leaves_a_tenth_of_the_trapped_oil():
    assert cushion.trapped_volume(-1e-3, PLANT.cushion_a) == pytest.approx(
        1.5e-6 - 1e-3 * float(PLANT.cushion_a.area), rel=1e-12, abs=0.0)
    assert cushion.trapped_volume(-10e-3, PLANT.cushion_a) == pytest.approx(
        0.15e-6, rel=1e-12, abs=0.0)


@pytest.mark.parametrize(('d', 'port'), [
    (20e-3, 300.0), (18e-3, 75.0), (16e-3, 0.0), (15e-3, 0.0), (0.0, 0.0)])
def test_the_port_closes_over_the_entry_and_the_restriction_stays(d, port):
    """C31: 3 l/min at 7 MPa, and of 300 l/min a quarter half-way through the entry."""
    flow, _ = cushion.outflow(7e6, d, PLANT.cushion_a)
    assert flow == pytest.approx((3.0 + port) * LPM, rel=1e-4, abs=0.0)    # delta of V5


def test_the_check_valve_opens_beyond_its_drop_and_lets_its_flow_in():
    """C31: 30 l/min at 7 MPa beyond 50 kPa; nothing of it below."""
    flow, _ = cushion.outflow(-7.05e6, 0.0, PLANT.cushion_a)
    restricted = cushion.outflow(7.05e6, 0.0, PLANT.cushion_a)[0]
    assert -flow - restricted == pytest.approx(30.0 * LPM, rel=1e-4, abs=0.0)
    assert cushion.outflow(-49e3, 0.0, PLANT.cushion_a)[0] == pytest.approx(
        -cushion.outflow(49e3, 0.0, PLANT.cushion_a)[0], rel=1e-12, abs=0.0)


@pytest.mark.parametrize(('fault', 'out', 'back'), [
    ({'check_stuck': 1.0}, 3.0, 3.0), ({'check_stuck': 2.0}, 33.0, 33.0),
    ({'restriction_blocked': 0.25}, 2.25, 32.25), ({'restriction_blocked': 1.0}, 0.0, 30.0),
    ({'restriction_blocked': 1.0, 'check_stuck': 1.0}, 0.0, 0.0)])
def test_faults_change_what_passes_each_way(fault: Mapping[str, float], out, back):
    """In l/min at 7 MPa, without the opening of the check valve."""
    own = own_cushion(**fault, check_opening_kpa=0.0)
    assert cushion.outflow(7e6, 0.0, own)[0] == pytest.approx(out * LPM, rel=1e-4, abs=0.0)
    assert -cushion.outflow(-7e6, 0.0, own)[0] == pytest.approx(back * LPM, rel=1e-4, abs=0.0)


@given(dp=DROP, d=st.floats(0.0, 0.02))
def test_the_slope_is_that_of_the_flow(dp, d):
    """By central differences over 1 Pa; S has no kink but where the check valve opens."""
    if abs(dp + 50e3) < 10.0:
        return
    (high, _), (low, _) = (cushion.outflow(dp + h, d, PLANT.cushion_a) for h in (1.0, -1.0))
    slope = cushion.outflow(dp, d, PLANT.cushion_a)[1]
    assert slope == pytest.approx(0.5 * (high - low), rel=1e-5, abs=1e-14 * abs(high))


def test_an_eased_flow_keeps_the_drop_at_rest_and_decays_at_the_fastest_rate():
    """C32: at the drop at which both sides stay it is C31's; away from it d(dp)/dt = -r_max."""
    own, d = PLANT.cushion_a, 20e-3
    per_c, per_p, gained = 4e14, 6e13, -2e-4
    flow, slope = cushion.outflow(20e3, d, own)
    assert slope * (per_c + per_p) > 5.0 * FASTEST_RATE

    def rate(dp: float, into: float) -> float:
        passed = cushion.eased_outflow(dp, d, into, per_c, gained, per_p, own)
        return float(per_c * (into - passed) - per_p * (gained + passed))
    steady = (flow * (per_c + per_p) + per_p * gained) / per_c     # in, at which 20 kPa stay
    assert rate(20e3, steady) == pytest.approx(0.0, abs=1e-9 * per_c * flow)
    assert (rate(20e3 + 1.0, steady) - rate(20e3 - 1.0, steady)) / 2.0 == pytest.approx(
        -FASTEST_RATE, rel=1e-2)      # S curves within 20 kPa of 0 by 1e-2


def test_a_check_valve_alone_lets_nothing_out_however_it_is_eased():
    own = own_cushion(restriction_blocked=1.0, restriction_lpm=3.0, check_lpm=1e4)
    assert cushion.eased_outflow(-60e3, 0.0, 1e-2, 4e14, 0.0, 6e13, own) == 0.0
    assert cushion.eased_outflow(-60e3, 0.0, -1e-2, 4e14, 0.0, 6e13, own) < 0.0
    assert cushion.eased_outflow(60e3, 0.0, 1e-2, 4e14, 0.0, 6e13, own) == 0.0


@pytest.mark.parametrize('end', [-1.0, 1.0])
def test_a_spear_is_in_over_its_length(end):
    """C30: 20 mm in this model, at both ends; a nanometre on either side of it."""
    length = (PLANT.cushion_a if end < 0.0 else PLANT.cushion_b).length
    assert length == pytest.approx(20e-3, rel=1e-12, abs=0.0)
    for d, found in ((length - 1e-9, end), (length + 1e-9, 0.0)):
        y = rows_of(1, PLANT_STATE)[0]
        y.mechanics.position = d if end < 0.0 else float(PLANT.chambers.stroke) - d
        cushion.divide.py_func(y, PLANT)
        assert y.cushion.end == found


@pytest.mark.parametrize('drop', [-3e6, 3e6], ids=['in', 'out'])
def test_what_passes_the_spear_is_as_dense_as_where_it_comes_from(drop):
    """C32: of a piston at rest, the trapped side lacks the mass that left it."""
    own, oil, d, p = PLANT.cushion_a, PLANT.chambers, 5e-3, 6e6
    y, rates = (rows_of(1, cushion.CUSHION_STATE)[0] for _ in 'yr')
    volume = cushion.trapped_volume(d, own)
    y.p, y.cavity = p + drop, cushion.lack(p + drop, 0.0, volume, oil)
    _, per_c, more_c = cushion.contents(y.cavity, volume, y.p, oil)
    more = 0.02     # of the port's side
    gained, _, _, _ = cushion.pass_spear.py_func(
        y, d, 0.0, p, 1e13, more, 0.0, oil, own, rates)
    flow = cushion.eased_outflow(drop, d, 0.0, per_c, 0.0, 1e13, own)
    mass = flow * (1.0 + (more_c if drop > 0.0 else more))
    # pressures come back from volumes to 1e-9 of them
    assert rates.cavity == pytest.approx(mass, rel=1e-6, abs=0.0)
    assert gained == pytest.approx(mass / (1.0 + more), rel=1e-6, abs=0.0)


@given(dp=DROP, d=st.floats(-1e-3, 0.02), v=st.floats(-1.0, 1.0))
def test_compiled_kernels_equal_python(dp, d, v):
    """Bit for bit, of the spear in a step of volumes."""
    found = []
    for passed in (cushion.pass_spear, cushion.pass_spear.py_func):
        y, rates = (rows_of(1, cushion.CUSHION_STATE)[0] for _ in 'yr')
        volume = cushion.trapped_volume(d, PLANT.cushion_a)
        y.cavity = cushion.lack(5e6 + dp, 0.0, volume, PLANT.chambers)
        found.append((*passed(y, d, v, 5e6, 2e13, 0.01, 1e-4, PLANT.chambers, PLANT.cushion_a,
                              rates), float(rates.cavity)))
    assert found[0] == found[1]


REFUSED: list[tuple[str, Mapping[str, Any], str]] = [
    ('cushion_a', {'spear_mm': 40.0}, r'plant.cushion_a.spear_mm = 40 mm, must be < '
     r'plant.drive.bore_mm = 40 mm'),
    ('cushion_b', {'spear_mm': 25.0}, r'plant.cushion_b.spear_mm = 25 mm, must be > 25 mm'),
    ('cushion_a', {'entry_mm': 21.0}, r'entry_mm = 21 mm, must be <= length_mm = 20 mm'),
    ('cushion_b', {'trapped_ml': 12.57}, r'trapped_ml = 12.57 ml, must be < '
     r'plant.oil.dead_volume_ml = 12.57 ml'),
    ('cushion_b', {'length_mm': 180.0}, r'= 200 mm together, must be < plant.drive.stroke_mm')]


@pytest.mark.parametrize(('name', 'values', 'message'), REFUSED)
def test_a_cushion_that_does_not_fit_is_refused(name, values, message):
    own = replace(getattr(SHEET.plant, name), **values)
    with pytest.raises(ParameterError, match=message):
        refuse_wiring(override(SHEET, f'plant.{name}', own))
    refuse_wiring(SHEET)


@pytest.mark.parametrize('name', [
    'length_mm', 'spear_mm', 'entry_mm', 'port_lpm', 'trapped_ml'])
def test_sizes_must_be_positive(name):
    with pytest.raises(ParameterError, match=f'SpearCushion.{name} = 0'):
        SpearCushion(**{**vars(OWN), name: 0.0})


@pytest.mark.parametrize(('name', 'least'), [('cushion_a', 0.016), ('cushion_b', 0.0037)])
def test_too_little_trapped_oil_for_the_step_is_refused_by_name(name, least):
    """With m w^2 = beta A^2/V about w h = 2.8, at which RK4 no longer damps: 1.94 kg."""
    sheet = override(SHEET.plant, f'{name}.trapped_ml', 0.5 * least)
    with pytest.raises(ParameterError, match=rf'plant.{name}.trapped_ml = .*, must be >= '):
        refuse_too_fast(plant_record(sheet)[0], sheet, LoadSide())
    sheet = override(SHEET.plant, f'{name}.trapped_ml', 1.3 * least)
    refuse_too_fast(plant_record(sheet)[0], sheet, LoadSide())
    refuse_too_fast(plant_record(SHEET.plant)[0], SHEET.plant, LoadSide())


@pytest.mark.parametrize(('trapped_ml', 'least'), [(0.001, '0.0428'), (0.01, '0.0428')])
def test_too_little_trapped_oil_is_the_first_cause(trapped_ml: float, least: str) -> None:
    """Though somewhat less of another change would do."""
    with pytest.raises(ConfigError) as refused:
        isa_ros.load('press').replace(
            {'actuators.slide.parameters.plant.cushion_a.trapped_ml': trapped_ml})
    said = str(refused.value).partition('actuators.slide: ')[2]
    assert said.startswith(
        f'plant.cushion_a.trapped_ml = {trapped_ml:g} ml, must be >= {least} ml; or plant.mech')
