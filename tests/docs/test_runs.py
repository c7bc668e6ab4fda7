"""The examples of docs/runs.md can be run as printed."""

from pathlib import Path
import re
from typing import get_args

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError
from isa_ros.scenario.scenario import idle, load_scenario
from isa_ros.simulation import Simulation
from isa_ros.surroundings.return_line import ReturnLine
from isa_ros.surroundings.supply import SupplySheet
import pytest
from tests.docs.pages import actuators, example, head, ROOT, run_of, text_of


def test_the_run_file_and_its_scenario_fit(tmp_path: Path) -> None:
    path = tmp_path / 'my_step.yaml'
    path.write_text(example('runs', 'name: my_step'))
    assert load_scenario(path, run_of(actuators(), tmp_path)).duration_s == 1.0


def test_the_own_cylinder_has_its_ratings(tmp_path: Path) -> None:
    """A_A P_S of 40 mm at 14 MPa, which is also the shipped example."""
    path = tmp_path / 'my_cylinder.yaml'
    path.write_text(example('runs', 'name: my_cylinder'))
    run = load_run(path)
    assert run.actuators == load_run(find('rig_cylinder', CONFIG)).actuators
    assert run.actuators[0].sheet.reu.position.force_out == pytest.approx(17593.0, rel=1e-4)


def test_its_supplies_are_of_every_kind(tmp_path: Path) -> None:
    """Which can all be read, and simulated with an actuator on each."""
    supplies = example('runs', 'supplies:')
    names = [name for feeds in re.findall(r'feeds: \[(.*)\]', supplies)
             for name in feeds.split(', ')]
    path = tmp_path / 'my_run.yaml'
    path.write_text(head()[:head().index('supply:')] + supplies + 'actuators:\n' + ''.join(
        f'  {name}: {{model: isa_v5, load: {{kind: blocked}}}}\n' for name in names))
    run = load_run(path)
    assert {type(supply.sheet) for supply in run.supplies} == set(get_args(SupplySheet))
    assert {type(supply.sheet.return_line) for supply in run.supplies} == set(
        get_args(ReturnLine))
    simulation = Simulation(idle(run))
    for _ in range(10):
        simulation.step()
    front, rear, station = (
        simulation.supply_samples[supply.name].pressure for supply in run.supplies)
    assert front == 20.7e6 > rear > 20e6
    assert 20e6 < station < 20.7e6


def test_the_refusal_it_shows_is_that_of_the_file() -> None:
    found = re.search(
        r'`\./isa bringup (config/bad/\w+\.yaml)`:\n\n    isa: (.*)\n', text_of('runs'))
    assert found is not None
    with pytest.raises(ConfigError) as refused:
        load_run(ROOT / found[1])
    assert str(refused.value) == found[2]
