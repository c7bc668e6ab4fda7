"""Sheets and loads that stand in a resolved text: used where a model has none, and checked."""

from pathlib import Path
import re
from typing import Any

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.changes import replaced
from isa_ros.config.text.yaml_text import dump, parse
from isa_ros.errors import ConfigError
import pytest
from tests.config.rig_file import rig


def inline(tmp_path: Path, changes: dict[str, Any]) -> RunConfig:
    """Return the run of a resolved text with some values changed."""
    path = tmp_path / 'inline.yaml'
    path.write_text(load_run(rig(tmp_path)).to_yaml(), encoding='utf-8')
    return load_run(path, changes)


def test_of_an_inline_sheet_only_the_name_of_the_model_is_used(tmp_path: Path) -> None:
    """Values are replaced in the sheet itself or below parameters; a link of all applies."""
    plain = load_run(rig(tmp_path)).actuator('ram')
    ram = inline(tmp_path, {
        'actuators.ram.model': 'my_own', 'actuators.ram.sheet.plant.drive.bore_mm': 30.0,
        'actuators.ram.parameters': {'reu': {'force': {'kf': 0.0}}},
        'link': {'kind': 'can', 'loss': 0.1}}).actuator('ram')
    assert (ram.model, ram.preset, ram.load) == ('my_own', plain.preset, plain.load)
    assert (ram.sheet.plant.drive.bore_mm, ram.sheet.reu.force.kf) == (30.0, 0.0)
    assert ram.sheet.plant.oil == plain.sheet.plant.oil     # nothing scales
    link = ram.sheet.link
    assert (link.kind, link.loss, link.cycle_ms) == ('can', 0.1, 1.0)     # the tick


@pytest.mark.parametrize(('changes', 'expected'), [
    ({'step_ms': 2.0}, 'has step_ms and step_ns, must have only one of them'),
    ({'controller_offset_ms': 0.2}, 'has controller_offset_ms and controller_offset_ns, must'),
    ({'step_ns': 1_000_001}, 'step_ns = 1000001 ns, must be a multiple of 100000 ns'),
    ({'actuators.ram.initial_position_mm': 1.0},
     'actuators.ram has initial_position_mm and initial_position, must have only one of them'),
    ({'actuators.ram.initial_position': 0.101},
     'actuators.ram.initial_position = 0.101 m, must be <= 0.1 m (within the stroke)'),
    ({'actuators.ram.initial_position': -0.1}, 'initial_position = -0.1 m, must be >= 0 m'),
    ({'actuators.ram.load': {'kind': 'mass'}}, 'actuators.ram.load lacks inertia, force'),
    ({'actuators.ram.model': 5}, 'actuators.ram.model = 5, must be of type str'),
    ({'actuators.ram.mode': None}, 'actuators.ram.mode = None, must be of type str'),
    ({'link': {'kynd': 'can'}}, 'inline.yaml: link.kynd is unknown; did you mean kind?'),
    ({'actuators.ram.link': {'los': 0.1}}, 'actuators.ram.link.los is unknown; did you mean loss'),
    ({'actuators.ram.parameters': None}, 'actuators.ram.parameters = None, must be a section'),
    ({'actuators.ram.sheet': {}}, 'actuators.ram.sheet lacks spool_feedback, plant, reu'),
    ({'actuators.ram.sheet.reu.force.kp': 1.0}, 'actuators.ram: reu.force.kp = 1 m/N, must be'),
])
def test_an_inline_sheet_is_checked(
        tmp_path: Path, changes: dict[str, Any], expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        inline(tmp_path, changes)
    assert str(caught.value).startswith('inline.yaml: ') and expected in str(caught.value)


def test_an_inline_actuator_needs_a_load(tmp_path: Path) -> None:
    """Except in the text of a bag, which was checked when it was recorded."""
    text = dump(replaced(parse(
        load_run(rig(tmp_path)).to_yaml(), 't'), 'actuators.ram.load', None, 't'))
    text = text.replace('    load: null\n', '')
    path = tmp_path / 'inline.yaml'
    path.write_text(text)
    with pytest.raises(ConfigError, match='actuators.ram has no load and moves no joint of a '):
        load_run(path)
    assert run_of_text(text).actuator('ram').load is None


def test_what_does_not_fit_together_is_read_from_a_bag(tmp_path: Path) -> None:
    """Another version may have simulated what this one refuses."""
    text = load_run(rig(tmp_path)).to_yaml()
    wild, count = re.subn(r'kp: 8.0e-08', 'kp: 1.0', text, count=1)
    assert count == 1
    assert run_of_text(wild).actuator('ram').sheet.reu.force.kp == 1.0
