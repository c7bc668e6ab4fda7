"""The quadruped on its power unit: columns from the account, and the page."""

from pathlib import Path

from isa_ros.analysis.studies import power_unit
from isa_ros.analysis.studies.power_unit import CHOSEN, PowerUnit, SuppliedTrot
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.units import LITRE
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load
import numpy as np
import pytest

DOCS = Path(__file__).parents[3] / 'docs'
SECONDS = 0.05
SMALL = PowerUnit(4.0, 3000.0, 0.05)


@pytest.fixture(scope='module')
def result() -> Result:
    """Return fifty ticks on another unit than the file's."""
    return power_unit.trot(SMALL, SECONDS)


@pytest.fixture(scope='module')
def found(result: Result) -> SuppliedTrot:
    """Return its numbers, means over all of it."""
    return power_unit.supplied(SMALL, result)


def test_the_columns_are_the_account_and_it_closes(found: SuppliedTrot, result: Result) -> None:
    """E12; peaks are no less than means."""
    unit, gas = result.accounts['unit'], result.accounts['unit/buffer']
    actuators = [result.accounts[own.name] for own in result.scenario.run.actuators]
    assert len(actuators) == 12 and found.gap < 1e-6
    assert found.power * SECONDS == pytest.approx(unit['pump (J)'], rel=1e-9, abs=0.0)
    assert found.flow * SECONDS == pytest.approx(
        sum(own['oil drawn (l)'] for own in actuators) * LITRE, rel=1e-9, abs=0.0)
    assert found.lost * SECONDS == pytest.approx(
        unit['relief (J)'] + unit['return (J)'] - gas['relief (J)'], rel=1e-9, abs=0.0)
    assert found.lost > 0.0
    assert found.valves * SECONDS == pytest.approx(
        sum(own['throttling (J)'] + own['valve leakage (J)'] for own in actuators),
        rel=1e-9, abs=0.0)
    assert found.peak_flow >= found.flow and found.peak_power >= found.power


def test_pressures_are_those_of_rail_and_manifolds(found: SuppliedTrot, result: Result) -> None:
    rail = result['unit/rail.pressure']
    assert found.sag == rail[-1] - rail.min() >= 0.0 and np.isnan(found.pushed_sag)
    assert found.lowest == min(
        result['unit/front.pressure'].min(), result['unit/hind.pressure'].min())


def test_an_open_account_is_seen(result: Result) -> None:
    account = dict(result.accounts['unit'])
    account['return (J)'] += 1e-3 * account['pump (J)']
    assert power_unit.gap_of(account) == pytest.approx(1e-3, rel=1e-4)


def test_a_unit_has_the_values_of_its_row_and_the_file_those_of_the_chosen(
        result: Result) -> None:
    def values(run: RunConfig) -> PowerUnit:
        parts = run.supplies[0].sheet.by_name
        return PowerUnit(parts['pump'].displacement_ml, parts['pump'].power_w,
                         parts['buffer'].gas_volume_l)
    assert values(result.scenario.run) == SMALL
    file = load(power_unit.RUN).configuration
    assert values(file) == CHOSEN in power_unit.UNITS
    assert file.supplies[0].sheet.by_name['pump'].speed_rpm == power_unit.SPEED_RPM
    assert {own.name for own in file.actuators} == set(file.supplies[0].feeds)


def test_whether_and_when_it_fell_is_in_its_row(
        found: SuppliedTrot, result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    assert power_unit.STUDY.as_text([found]).endswith('yes')
    assert power_unit.STUDY.as_tree([found])['outcomes'][0]['fell'] is None
    monkeypatch.setattr(power_unit, 'FALLEN', 1.0)      # above where it stands
    fallen = power_unit.supplied(SMALL, result)
    assert fallen.fell == 0.0 and power_unit.STUDY.as_text([fallen]).endswith('falls at 0.0 s')


def test_a_part_of_the_study_draws_no_conclusions(found: SuppliedTrot, tmp_path: Path) -> None:
    page, figure = power_unit.STUDY.write_page([found], tmp_path)
    assert figure.exists() and 'The pump must' not in page.read_text()
    assert 'gas at 12 MPa' in page.read_text()
    assert load(power_unit.RUN).configuration.supplies[0].sheet.by_name[
        'buffer'].precharge_mpa == 12.0


@pytest.mark.slow
def test_a_row_of_the_page_is_that_of_the_run(tmp_path: Path) -> None:
    """The chosen unit through trot and push."""
    one, = power_unit.results(units=(CHOSEN,))
    assert one.gap < 1e-6 and np.isnan(one.fell)
    page, _ = power_unit.STUDY.write_page([one], tmp_path)
    row, = (line for line in page.read_text().splitlines() if line.startswith('| **'))
    assert row in (DOCS / page.name).read_text().splitlines()
