"""docs/protection.md says what the code declares."""

from pathlib import Path
import re

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.conditions import REACTIONS
from scripts import write_protection
from scripts.measure_leg_stops import LEG_SITUATIONS
from scripts.measure_robot_stops import ROBOTS
from scripts.measure_valve_faults import ALONE, KNEE
from scripts.write_stops import situations

ROOT = Path(__file__).parents[2]
PAGE = write_protection.PAGE.read_text(encoding='utf-8')


def test_its_tables_are_those_of_the_code() -> None:
    """`python scripts/write_protection.py` after a change of the conditions or a model."""
    assert write_protection.page(PAGE) == PAGE


def test_a_changed_level_is_noticed() -> None:
    changed = PAGE.replace('> 1.1', '> 1.2', 1)
    assert changed != PAGE and write_protection.page(changed) == PAGE


def test_every_reaction_is_explained_from_the_weakest_to_the_strongest() -> None:
    named = re.findall(r'^\| `(\w+)` \| (?:[^|]*) \| (?:[^|]*)\|$', PAGE, re.MULTILINE)
    assert [name for name in named if name in REACTIONS] == list(REACTIONS)


def test_its_example_can_be_run(tmp_path: Path) -> None:
    """In place of the actuators of the shipped file."""
    [example] = re.findall(r'```yaml\n(.*?)```', PAGE, re.DOTALL)
    shipped = find('rig_linear', CONFIG).read_text(encoding='utf-8')
    path = tmp_path / 'rig.yaml'
    path.write_text(shipped[:shipped.index('actuators:')] + example)
    protection = load_run(path).actuators[0].sheet.reu.protection
    assert (protection.setpoint_timeout_ms, protection.end_of_stroke.trip) == (100.0, 0.02)


def test_every_file_it_names_exists() -> None:
    paths = re.findall(r'`((?:isa_ros|tests|scripts)/[a-z_/]+\.py)', PAGE)
    assert len(paths) > 5
    assert all((ROOT / path).exists() for path in paths)


def test_every_situation_of_a_stop_has_its_row() -> None:
    """Else `python -m scripts.write_stops`; how far stops go: tests/actuator/test_stops.py."""
    names = [one.name for one in situations()] + [*LEG_SITUATIONS, *ROBOTS, *ALONE]
    assert len(set(names)) == len(names)
    for name in names:
        assert PAGE.count(f'\n| {name} |') == 1, name
    for name in KNEE:   # to both sides
        assert PAGE.count(f'\n| {name} |') == 2, name
