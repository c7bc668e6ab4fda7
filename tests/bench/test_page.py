"""The page, the JSON and the figure, as files."""

import json

from benchmarks import growth
from isa_ros.bench.host import Machine
from isa_ros.bench.page import as_lines, as_tree, Report, Section, write_page
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim, Row
from isa_ros.text.json_file import write_tree
import pytest
from tests.bench.artificial import ran

MACHINE = Machine('A processor @ 1 GHz', 2, 8.0, '6.0', '3.11.7', 0.5)


@pytest.fixture
def report() -> Report:
    """Return a report with a missed aim, one reached, and something not installed."""
    rows = (
        Row.of('leg, processes', [1000.0, 1200.0, 1100.0], 'ticks/s').aiming(Aim(1500.0)).noting(
            'of a tick of 909 us: actuators 700 us'),
        Row.of('start', [3.0], 's').aiming(Aim(4.0, is_most=True)),
        Row('a tick', 909.0, 'us', part_of='leg, processes'),
        Row('HELICS', None, 'ticks/s', note='not installed: requirements-bench.txt'))
    outcomes = Outcomes({spec: [ran(3000.0 / int(spec.plant))]
                         for spec in growth.IN_ONE_PROCESS + growth.IN_PROCESSES})
    return Report(MACHINE, (
        Section('leg', 'The leg', rows),
        Section('growth', 'Growth', (), growth.drawing(outcomes))), outcomes)


def test_the_page_names_machine_aims_and_limits(report, tmp_path):
    page, figure = write_page(report, tmp_path / 'docs')
    text = page.read_text(encoding='utf-8')
    assert 'A processor @ 1 GHz, 2 cores' in text
    assert ('| leg, processes | >= 1500 | 1100 (1000 to 1200) ticks/s | **not reached** |'
            in text)
    assert '| start | <= 4 | 3 s | reached |' in text
    assert '- leg, processes: of a tick of 909 us: actuators 700 us.' in text
    assert '| &emsp;a tick | 909 | us |' in text
    assert '| HELICS | - | ticks/s |  | not installed: requirements-bench.txt |' in text
    assert figure.read_bytes().startswith(b'\x89PNG')
    assert f'](figures/{figure.name})' in text


def test_the_json_holds_every_row_and_every_run(report, tmp_path):
    path = tmp_path / 'bench.json'
    write_tree(as_tree(report), path)
    tree = json.loads(path.read_text(encoding='utf-8'))
    assert tree['machine']['cores'] == 2
    assert [(row['group'], row['is_reached']) for row in tree['rows']] == [
        ('leg', False), ('leg', True), ('leg', None), ('leg', None)]
    assert len(tree['runs']) == len(growth.IN_ONE_PROCESS + growth.IN_PROCESSES)
    assert tree['runs'][0]['spec']['plant'] == '1'
    assert tree['runs'][0]['ticks_per_s'] == 3000.0


def test_a_terminal_shows_the_limit_below_its_row(report):
    lines = as_lines(report.sections[0])
    assert lines[1].endswith('aim >= 1500: not reached')
    assert lines[2].strip() == 'of a tick of 909 us: actuators 700 us'


def test_a_group_without_a_drawing_has_no_figure(report, tmp_path):
    empty = Report(report.machine, report.sections[:1], Outcomes({}))
    assert write_page(empty, tmp_path) == [tmp_path / 'bench.md']
