"""
Layouts for Lichtblick and PlotJuggler: as these read them, and of what a bag really has.

Nothing of the scripts names the series here: a bag is recorded, read by a foreign reader, and its
messages are unfolded as the tools do it.
"""

from collections.abc import Iterator
import json
from pathlib import Path
import re
from typing import Any
from xml.etree import ElementTree

from isa_ros.bag.writer import BagWriter
from isa_ros.config.paths import CONFIG, find, SCENARIOS, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.run.local_run import LocalRun
from isa_ros.run.provenance import provenance_of
from isa_ros.scenario.scenario import load_scenario
from isa_ros.tick.source import ScheduledSource
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
import pytest
from scripts import write_layouts
from scripts.layouts import lichtblick, plotjuggler
from scripts.layouts.content import pages_of

RUNS = {'leg': 'drop', 'rig_rotary': 'step', 'quadruped': 'quadruped_stand'}
TICKS = 40


@pytest.fixture(scope='module')
def messages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """Return the last message of each topic of a bag of each run, by the run's name."""
    return {name: dict(recorded(name, tmp_path_factory.mktemp(name))) for name in RUNS}


def recorded(name: str, folder: Path) -> Iterator[tuple[str, Any]]:
    """Record a run, and yield its topics with their messages."""
    scenario = load_scenario(
        find(RUNS[name], SCENARIOS), load_run(find(name, CONFIG)))
    local = LocalRun(scenario.run)
    with BagWriter(folder / 'bag', local.topics, provenance_of(scenario)) as bag:
        local.simulate(TICKS, ScheduledSource(scenario.commands), bag)
    with (folder / 'bag' / 'bag_0.mcap').open('rb') as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for channel in reader.get_summary().channels.values():
            yield channel.topic, None
        for _, channel, _, message in reader.iter_decoded_messages():
            yield channel.topic, message


def unfolded(message: Any, path: str = '') -> Iterator[str]:
    """Yield the numbers of a message as PlotJuggler's parser of ROS messages names them."""
    names = getattr(message, '__slots__', None)
    if names is None:
        if isinstance(message, (int, float)):
            yield path
    elif {'name', 'effort'} <= set(names):  # sensor_msgs/JointState has a parser of its own
        for array in ('position', 'velocity', 'effort'):
            for entry, _ in zip(message.name, getattr(message, array)):
                yield f'/{entry}/{array}'
    else:
        for name in names:
            yield from unfolded(getattr(message, name), f'{path}/{name}')


def curves(name: str, version: int) -> list[ElementTree.Element]:
    root = ElementTree.parse(write_layouts.LAYOUTS / f'{name}.pj{version}.xml').getroot()
    found = root.findall('./tabbed_widget/Tab/Container/DockSplitter/DockArea/plot/curve')
    assert len(found) == len(list(root.iter('curve'))) > 9
    return found


def panels(name: str) -> dict[str, dict[str, Any]]:
    path = write_layouts.LAYOUTS / f'{name}.lichtblick.json'
    return json.loads(path.read_text(encoding='utf-8'))['configById']


def value_of(message: Any, path: str) -> Any:
    """Return what Lichtblick's path finds: names, and places in arrays."""
    for name, place in re.findall(r'\.(\w+)(?:\[(\d+)\])?', path):
        message = getattr(message, name)
        message = message[int(place)] if place else message
    return message


@pytest.mark.parametrize('name', RUNS)
def test_each_curve_of_plotjuggler_is_in_the_bag(
        name: str, messages: dict[str, dict[str, Any]]) -> None:
    fields = {topic: set(unfolded(message)) for topic, message in messages[name].items()}
    series = {topic + field for topic, found in fields.items() for field in found}
    assert [curve.get('name') for curve in curves(name, 3)
            if curve.get('name') not in series] == []
    assert [curve.attrib for curve in curves(name, 4)
            if curve.get('field') not in fields.get(curve.get('topic'), ())] == []


@pytest.mark.parametrize('name', RUNS)
def test_each_path_of_lichtblick_is_a_value_of_the_bag(
        name: str, messages: dict[str, dict[str, Any]]) -> None:
    n = 0
    for identity, panel in panels(name).items():
        wanted = str if identity.startswith('StateTransitions!') else float
        for path in panel.get('paths', ()):
            topic = path['value'].partition('.')[0]
            value = value_of(messages[name][topic], path['value'].removeprefix(topic))
            assert isinstance(value, wanted), path
            n += 1
        if 'topicToRender' in panel:
            assert panel['topicToRender'] in messages[name]
    assert n > 10


@pytest.mark.parametrize('name', RUNS)
def test_the_state_is_the_word_for_it(name: str, messages: dict[str, dict[str, Any]]) -> None:
    paths = panels(name)['StateTransitions!states']['paths']
    assert [path['label'] for path in paths] == [
        own.name for own in load_run(find(name, CONFIG)).actuators]
    for path in paths:
        status = messages[name][path['value'].partition('.')[0]]
        assert path['value'].endswith('.values[0].value') and status.values[0].key == 'state'


@pytest.mark.parametrize('name', RUNS)
def test_a_reference_is_beside_what_it_is_of(name: str) -> None:
    """Its diagram has one unit: the name of the reference is that of the diagram."""
    run = load_run(find(name, CONFIG))
    pages = {page.title: page for page in pages_of(run)}
    for own in run.actuators:
        units = ('rad', 'Nm') if own.sheet.is_rotary else ('m', 'N')
        titles = [diagram.title for diagram in pages[own.name].diagrams]
        assert titles == [f'position, {units[0]}', f'force, {units[1]}', 'pressure, Pa',
                          'spool, m', 'current, A']
        for title, diagram in zip(titles, pages[own.name].diagrams):
            assert [curve.field for curve in diagram.curves if 'references' in curve.topic] == (
                [] if 'pressure' in title
                else [f'/{own.name}/{title.partition(",")[0]}/position'])


@pytest.mark.parametrize('name', RUNS)
def test_plotjuggler_can_restore_the_docks(name: str) -> None:
    """Version 3 reads as many sizes as its count says, without a look at their number."""
    for version in (3, 4):
        root = ElementTree.parse(write_layouts.LAYOUTS / f'{name}.pj{version}.xml').getroot()
        assert root.tag == 'root'
        assert root.attrib == ({} if version == 3 else {
            'format': 'PlotJuggler', 'pj4_version': '4', 'binding': 'generic'})
        widget, = root.findall('tabbed_widget')
        assert widget.attrib == {'parent': 'main_window', 'name': 'Main Window'}
        for splitter in root.iter('DockSplitter'):
            assert splitter.get('orientation') == '-'
            sizes = [float(size) for size in splitter.attrib['sizes'].split(';')]
            assert int(splitter.attrib['count']) == len(sizes) == len(splitter)
            assert sum(sizes) == pytest.approx(1.0, abs=1e-5)  # six digits each
            assert {area.tag for area in splitter} == {'DockArea'}
        assert {plot.get('mode') for plot in root.iter('plot')} == {'TimeSeries'}
        ids = [element.get('id') for element in root.iter() if element.get('id')]
        assert len(ids) == len(set(ids)) == (0 if version == 3 else sum(
            len(list(root.iter(tag))) for tag in ('Tab', 'DockArea', 'plot')))


@pytest.mark.parametrize('name', RUNS)
def test_lichtblick_takes_the_layout(name: str) -> None:
    """What its `validateLayoutData` asks for, and each panel in the tree of panels once."""
    path = write_layouts.LAYOUTS / f'{name}.lichtblick.json'
    layout = json.loads(path.read_text(encoding='utf-8'))
    assert isinstance(layout['configById'], dict) and isinstance(layout['globalVariables'], dict)
    assert layout['playbackConfig'] == {'speed': 1} and layout['version'] == 1
    tabs = layout['configById']['Tab!pages']['tabs']
    shown = [*leaves(layout['layout']), *(leaf for tab in tabs for leaf in leaves(tab['layout']))]
    assert sorted(shown) == sorted(layout['configById'])
    assert {panel.partition('!')[0] for panel in shown} == {
        'Tab', 'Plot', 'StateTransitions', 'RosOut', 'DiagnosticSummary'}
    assert [tab['title'] for tab in tabs] == [
        'machine', *(own.name for own in load_run(find(name, CONFIG)).actuators)]


@pytest.mark.parametrize('key', ['lichtblickPanelTitle', 'foxglovePanelTitle'])
def test_each_panel_but_the_tabs_has_a_title_of_its_own(key: str) -> None:
    """By the key that each program reads: the bar of an untitled one says `Plot`."""
    path = write_layouts.LAYOUTS / 'leg.lichtblick.json'
    panels = json.loads(path.read_text(encoding='utf-8'))['configById']
    titles = [panel[key] for name, panel in panels.items() if name != 'Tab!pages']
    assert len(set(titles)) == len(titles) == len(panels) - 1
    assert panels['Plot!kfe-1'][key] == 'kfe: force, N'
    assert [panels[name][key] for name in (
        'StateTransitions!states', 'RosOut!events', 'DiagnosticSummary!diagnostics')] == [
            'device states', 'events', 'diagnostics']


def leaves(tree: Any) -> Iterator[str]:
    if isinstance(tree, str):
        yield tree
    else:
        assert set(tree) == {'direction', 'splitPercentage', 'first', 'second'}
        assert tree['direction'] in ('row', 'column') and 0 < tree['splitPercentage'] < 100
        yield from leaves(tree['first'])
        yield from leaves(tree['second'])


@pytest.mark.parametrize('name', write_layouts.SHIPPED)
def test_the_shipped_files_are_written_by_the_script(name: str) -> None:
    assert set(RUNS) == set(write_layouts.SHIPPED)
    for file, text in write_layouts.texts(name):
        assert (write_layouts.LAYOUTS / file).read_text(encoding='utf-8') == text, file


def test_panels_share_the_height() -> None:
    assert lichtblick._stack(['a', 'b', 'c', 'd']) == {
        'direction': 'column', 'splitPercentage': 25.0, 'first': 'a', 'second': {
            'direction': 'column', 'splitPercentage': 100 / 3, 'first': 'b', 'second': {
                'direction': 'column', 'splitPercentage': 50.0, 'first': 'c', 'second': 'd'}}}


def test_a_run_of_ones_own_has_layouts(tmp_path: Path) -> None:
    own = tmp_path / 'my_press.yaml'
    own.write_text(find('rig_rotary', CONFIG).read_text().replace('rotor:', 'my_ram:'))
    assert write_layouts.main([str(own), '--out', str(tmp_path)]) == 0
    written = tmp_path / 'my_press.pj3.xml'
    assert '"/my_ram/joint_states/my_ram/position"' in written.read_text()
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        'my_press.lichtblick.json', 'my_press.pj3.xml', 'my_press.pj4.xml', 'my_press.yaml']


def test_several_supplies_have_colours_of_their_own() -> None:
    page = pages_of(load_run(find('pump_station', CONFIG)))[0]
    curves = next(own for own in page.diagrams if own.title == 'supply, Pa').curves
    assert len(curves) > 2 and len({curve.colour for curve in curves}) == len(curves)
    root = ElementTree.fromstring(plotjuggler.text([page], 3))
    assert {curve.colour for curve in curves} <= {
        curve.get('color') for curve in root.iter('curve')}


def test_pressures_and_temperatures_have_diagrams_of_their_own() -> None:
    found = set()
    for path in shipped(CONFIG).values():
        for diagram in pages_of(load_run(path))[0].diagrams:
            if diagram.title.startswith('supply'):
                for curve in diagram.curves:
                    kind = curve.topic.rpartition('_')[2]
                    found.add((diagram.title, kind, curve.path))
    assert found == {('supply, Pa', 'pressure', 'fluid_pressure'),
                     ('supply, degrees Celsius', 'temperature', 'temperature')}


@pytest.mark.parametrize('arguments, line, code', [
    (['no_run'], 'write_layouts: no_run: no such file; shipped: ', 2),
    (['leg', '--out', 'none/where'], 'write_layouts: none/where: No such file or directory', 3)])
def test_bad_input_is_one_line(
        arguments: list[str], line: str, code: int, capsys: pytest.CaptureFixture[str]) -> None:
    assert write_layouts.main(arguments) == code
    error = capsys.readouterr().err
    assert error.startswith(line) and error.count('\n') == 1
