"""The examples of the README can be run as printed."""

from dataclasses import replace
from pathlib import Path
import re
from typing import get_args

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.recording import RecordConfig
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.errors import ConfigError
from isa_ros.run.local_run import LocalRun
from isa_ros.scenario.scenario import idle, load_scenario
from isa_ros.simulation import Simulation
from isa_ros.surroundings.return_line import ReturnLine
from isa_ros.surroundings.supply import SupplySheet
import pytest

ROOT = Path(__file__).parents[2]
README = (ROOT / 'README.md').read_text()
BLOCKS = re.findall(r'```yaml\n(.*?)```', README, re.DOTALL)
FIGURES = [
    (config, scenario, figures)
    for figures, configs, scenario in re.findall(
        r'^\| ([\w. ]+) \| (`\w+`(?:, or `\w+`)?) \| `(\w+)` \|', README, re.MULTILINE)
    for config in re.findall(r'\w+(?=`)', configs)]


def run_of(actuators: str, tmp_path: Path) -> RunConfig:
    """Return the first run file of the README, with other actuators in it."""
    head = next(block for block in BLOCKS if block.startswith('name: my_ram'))
    path = tmp_path / 'my_run.yaml'
    path.write_text(head[:head.index('actuators:')] + actuators)
    return load_run(path)


def test_the_run_file_and_its_scenario_fit(tmp_path: Path) -> None:
    head = next(block for block in BLOCKS if block.startswith('name: my_ram'))
    path = tmp_path / 'my_step.yaml'
    path.write_text(next(block for block in BLOCKS if block.startswith('name: my_step')))
    run = run_of(head[head.index('actuators:'):], tmp_path)
    assert load_scenario(path, run).duration_s == 1.0


def test_the_own_cylinder_has_its_ratings(tmp_path: Path) -> None:
    """A_A P_S of 40 mm at 14 MPa, which is also the shipped example."""
    path = tmp_path / 'my_cylinder.yaml'
    path.write_text(next(block for block in BLOCKS if block.startswith('name: my_cylinder')))
    run = load_run(path)
    assert run.actuators == load_run(find('rig_cylinder', CONFIG)).actuators
    assert run.actuators[0].sheet.reu.position.force_out == pytest.approx(17593.0, rel=1e-4)


def test_the_section_record_fits_the_run_file(tmp_path: Path) -> None:
    head = next(block for block in BLOCKS if block.startswith('name: my_ram'))
    section = next(block for block in BLOCKS if block.startswith('record:'))
    run = run_of(head[head.index('actuators:'):] + section, tmp_path)
    run.record.refuse_misfits(
        [topic.name for topic in LocalRun(replace(run, record=RecordConfig())).topics],
        run.source)
    assert (run.record.storage.compression, run.record.thins) == ('zstd', True)


def test_the_control_blocks_are_those_it_says(tmp_path: Path) -> None:
    run = run_of(next(block for block in BLOCKS if block.startswith('actuators:')), tmp_path)
    kinds = {a.name: type(a.sheet.reu.force).__name__ for a in run.actuators}
    assert kinds == {'linearised': 'FeedbackLinearisation', 'scheduled': 'Pid', 'pressure': 'Off'}
    assert type(run.actuator('pressure').sheet.reu.pressure).__name__ == 'Pid'


def test_its_supplies_are_of_every_kind(tmp_path: Path) -> None:
    """Which can all be read, and simulated with an actuator on each."""
    supplies = next(block for block in BLOCKS if block.startswith('supplies:'))
    names = [name for feeds in re.findall(r'feeds: \[(.*)\]', supplies)
             for name in feeds.split(', ')]
    head = next(block for block in BLOCKS if block.startswith('name: my_ram'))
    path = tmp_path / 'my_run.yaml'
    path.write_text(head[:head.index('supply:')] + supplies + 'actuators:\n' + ''.join(
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
    command, shown = re.search(
        r'`\./isa bringup (config/bad/\w+\.yaml)`:\n\n    isa: (.*)\n', README).groups()
    with pytest.raises(ConfigError) as refused:
        load_run(ROOT / command)
    assert str(refused.value) == shown


def test_every_file_it_links_to_is_there() -> None:
    links = set(re.findall(r'\]\((?!http|#)([^)#]+)', README))
    assert len(links) > 8
    assert [link for link in links if not (ROOT / link).exists()] == []


@pytest.mark.parametrize('config, scenario, figure', FIGURES)
def test_a_figure_of_the_table_has_a_scenario_that_names_it(
        config: str, scenario: str, figure: str) -> None:
    """A scenario that fits its rig, with a figure that the report can draw."""
    fitted = load_scenario(find(scenario, SCENARIOS), load_run(find(config, CONFIG)))
    assert fitted.figure is not None and fitted.duration_s is not None


def test_the_table_has_every_figure_of_the_paper_with_measurements() -> None:
    """Figures 1 to 3, 7 and 9 to 11 are drawings and pictures, 16 is a photograph."""
    named = {int(figure) for *_, figure in FIGURES if figure.isdigit()}
    assert named == {4, 5, 6, 8, 12, 13, 14, 15, 17, 18, 19, 20}


def test_what_a_controller_is_shown_is_named_as_it_is() -> None:
    """Every `state.` of the page is a field of the state of the shipped leg."""
    shown: list[State] = []

    class Look(Controller):
        def step(self, state: State) -> dict[str, Setpoint]:
            shown.append(state)
            return {}

    Simulation(idle(load_run(find('leg.yaml', CONFIG))), [Look()]).step()
    names = set(re.findall(r"\bstate\.[a-z_]+(?:\['\w+'\])?(?:\.[a-z_]+)?", README))
    assert names >= {'state.body', "state.supplies['supply'].pressure", "state.actuators['hfe']"}
    for name in names:
        assert eval(name, {'state': shown[0]}) is not None
