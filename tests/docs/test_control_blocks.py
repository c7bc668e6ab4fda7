"""The example of docs/control_blocks.md is what it says."""

from pathlib import Path

from tests.docs.pages import example, run_of


def test_the_control_blocks_are_those_it_says(tmp_path: Path) -> None:
    run = run_of(example('control_blocks', 'actuators:'), tmp_path)
    kinds = {a.name: type(a.sheet.reu.force).__name__ for a in run.actuators}
    assert kinds == {'linearised': 'FeedbackLinearisation', 'scheduled': 'Pid', 'pressure': 'Off'}
    assert type(run.actuator('pressure').sheet.reu.pressure).__name__ == 'Pid'
