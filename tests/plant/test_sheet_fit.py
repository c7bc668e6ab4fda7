"""What `isa params` tells of a valve's sheet: each stated number, and the model's."""

from dataclasses import replace

from isa_ros.config.listing import describe
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.plant.plant import LinearPlant
from isa_ros.plant.sheet_fit import fits, SheetFit
from isa_ros.plant.spool import DataSheetSpool
from isa_ros.plant.stated_curves import SidesFlow, StatedLeakage
import pytest
from tests.sheets import actuator_sheet

RIG = 'rig_servo_valve.yaml'


@pytest.fixture(scope='module')
def plant() -> LinearPlant:
    """Return the plant of the valve's bench."""
    return load_run(find(RIG, CONFIG)).actuator('shut').sheet.plant


def by_name(found: list[SheetFit]) -> dict[str, SheetFit]:
    return {one.what.split(',')[0] if 'spool' not in one.what else one.what: one for one in found}


def test_every_stated_number_is_met(plant: LinearPlant) -> None:
    """But for the smoothing of 0.1 MPa, 4e-4 of the roots at 3.5 MPa."""
    stated = [one for one in fits(plant) if one.stated is not None]
    assert len(stated) == 7
    for one in stated:
        assert one.model == pytest.approx(one.stated, rel=5e-4), one.what


def test_what_follows_is_told_too(plant: LinearPlant) -> None:
    """Straight lines between two points of leakage have their largest total beside null."""
    found = by_name(fits(plant))
    largest = next(one for what, one in found.items() if what.startswith('largest leakage'))
    assert largest.stated is None and 1.9 < largest.model < 2.5
    slow = found['spool, -3 dB at 90 %']
    assert slow.stated is None and slow.model < found['spool, -90 deg at 90 %'].model


def test_what_hysteresis_adds_to_the_lag_is_told(plant: LinearPlant) -> None:
    """-90 degrees where docs/servo_valve.md measures them; the other frequency ends it."""
    found = by_name(fits(plant))
    behind = 'spool behind the hysteresis, -90 deg at 5 %'
    assert found[behind].model == pytest.approx(74.2, abs=0.05)
    entered = found['minus_90_deg_hz with which that is 80 Hz'].model
    assert entered == pytest.approx(86.67, abs=0.01)
    faster = replace(plant, spool=replace(plant.spool, minus_90_deg_hz=entered))
    assert by_name(fits(faster))[behind].model == pytest.approx(80.0, rel=1e-9)
    without = replace(plant.valve, hysteresis_percent=0.0, threshold_percent=0.0)
    assert behind not in by_name(fits(replace(plant, valve=without)))


def test_both_sides_are_told(plant: LinearPlant) -> None:
    valve = replace(plant.valve, flow=SidesFlow(
        current_ma=(0.0, 40.0), extending_lpm=(0.0, 38.0), retracting_lpm=(0.0, 30.0)))
    found = by_name(fits(replace(plant, valve=valve)))
    assert found['flow extending at 40 mA'].model == pytest.approx(38.0, rel=5e-4)
    assert found['flow retracting at 40 mA'].model == pytest.approx(30.0, rel=5e-4)


def test_the_regulated_flow_of_a_compensated_valve_is_told() -> None:
    """20 l/min at 3.5 MPa a land: 9.56 l/min at 0.8 MPa."""
    plant = actuator_sheet('cylinder').plant
    valve = replace(plant.valve, compensated_drop_mpa=0.8, leakage=StatedLeakage(
        pressure_mpa=14.0, current_ma=(0.0,), total_lpm=(0.4,), tare_lpm=0.4))
    found = by_name(fits(replace(plant, valve=valve)))
    assert found['flow behind the compensator'].model == pytest.approx(
        20.0 * (0.8 / 3.5) ** 0.5, rel=5e-3)
    assert found['flow extending at 10 mA'].stated is None


@pytest.mark.parametrize('at', ['minus_90_deg', 'minus_3_db'])
def test_a_response_of_one_point_has_the_other_one_as_it_follows(at: str) -> None:
    plant = actuator_sheet('cylinder').plant
    spool = plant.spool
    assert isinstance(spool, DataSheetSpool)
    found = by_name(fits(replace(plant, spool=replace(spool, at=at))))
    stated = [one for what, one in found.items() if what.startswith('spool') and one.stated]
    assert [one.model for one in stated] == [pytest.approx(100.0, rel=1e-9)]


def test_a_valve_of_curves_has_no_sheet() -> None:
    assert fits(actuator_sheet('isa_v5').plant) == []


def test_the_parameters_of_a_run_end_with_it() -> None:
    text = describe(RIG)
    assert text.count(': fitted\n') == 2
    assert 'pressure gain: load pressure at 1 % of the current  60' in text
