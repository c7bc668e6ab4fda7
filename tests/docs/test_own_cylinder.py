"""The how-to of an own cylinder can be run as printed, and names every quantity."""

from pathlib import Path
import re

from isa_ros.actuator.scales import SCALES
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.plant.valve_sheets import PointsFlow
import pytest

PAGE = (Path(__file__).parents[2] / 'docs' / 'own_cylinder.md').read_text()
FILE, DETAILS = re.findall(r'```yaml\n(.*?)```', PAGE, re.DOTALL)


def test_the_file_is_the_shipped_one(tmp_path: Path) -> None:
    path = tmp_path / 'rig_cylinder.yaml'
    path.write_text(FILE)
    assert load_run(path) == load_run(find('rig_cylinder', CONFIG))


def test_the_details_of_the_valve_fit_the_file(tmp_path: Path) -> None:
    """The compensation that is printed is that of the curve: 1.25 over 2.1875 l/min/mA."""
    path = tmp_path / 'detailed.yaml'
    path.write_text(FILE[:FILE.index('        valve:')] + DETAILS.partition('plant:\n')[2])
    sheet = load_run(path).actuators[0].sheet
    assert isinstance(sheet.plant.valve.flow, PointsFlow)
    assert sheet.plant.valve.bend == pytest.approx((2.0, 1.25 / 2.1875), rel=1e-12, abs=0.0)
    assert (sheet.reu.force.compensation.knee, sheet.reu.force.compensation.slope) == (
        2.0 * 1e-3, round(1.25 / 2.1875, 2))


def test_every_quantity_is_on_the_page() -> None:
    named = set(re.findall(r'`(\w+)`', PAGE))
    missing = set(SCALES) - named
    assert missing <= {'per_valve_current', 'spool_travel', 'valve_speed'}
