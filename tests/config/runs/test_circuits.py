"""Circuits in run files: what they feed, their rows of samples, namespaces, resolved texts."""

from pathlib import Path

from isa_ros.config.differences import configuration_differences, key_differences
from isa_ros.config.listing import describe
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_config import RUN, RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.sections import Place
from isa_ros.errors import ConfigError
from isa_ros.scripting.run import load
import pytest

STATION = load_run(find('pump_station', CONFIG))


def of(tmp_path: Path, old: str = '', new: str = '') -> RunConfig:
    """Return the run of the pump station's file with another text."""
    text = find('pump_station', CONFIG).read_text(encoding='utf-8')
    assert old in text
    path = tmp_path / 'station.yaml'
    path.write_text(text.replace(old, new, 1), encoding='utf-8')
    return load_run(path)


def test_each_manifold_feeds_the_actuators_it_names() -> None:
    supply, = STATION.supplies
    assert supply.feeds == ('left', 'right', 'clamp')
    assert supply.places == ('press', 'press', 'tool')
    assert [supply.sampled_at(name) for name in ('right', 'clamp')] == [
        'station/press', 'station/tool']
    assert STATION.alone(STATION.actuator('clamp')).supplies[0].places == ('tool',)


def test_its_text_is_free_of_loss() -> None:
    text = STATION.to_yaml()
    again = run_of_text(text)
    assert again == STATION and again.to_yaml() == text and again.digest == STATION.digest
    assert list(key_differences(RUN.tree(STATION), Place('bag'))) == []


def test_differences_have_the_key_and_unit_of_the_part(tmp_path: Path) -> None:
    other = of(tmp_path, 'length_m: 3.0', 'length_m: 4.0')
    found = configuration_differences(RUN.tree(STATION), RUN.tree(other))
    assert ('supplies.station.parts.press_hose.length_m', 3.0, 4.0, 'm') in [
        tuple(own) for own in found]


def test_every_part_has_its_row_and_manifolds_have_a_topic() -> None:
    rows = {own.name: own.published for own in STATION.sampled_supplies}
    parts = list(STATION.supplies[0].sheet.by_name)
    assert list(rows) == ['station', *(f'station/{part}' for part in parts)]
    assert rows['station'] == rows['station/press'] == ('pressure',)
    assert rows['station/pump'] == rows['station/tank'] == ()


def test_a_circuit_with_one_manifold_feeds_all_from_it(tmp_path: Path) -> None:
    """Also as the only supply; others say which."""
    path = tmp_path / 'one.yaml'
    path.write_text("""
name: one
supply:
  kind: circuit
  parts:
    tank: {kind: tank}
    pump: {kind: pump, inlet: tank, outlet: block, pressure_mpa: 20.7, displacement_ml: 10.0,
           speed_rpm: 1450.0}
    block: {kind: manifold, oil_volume_l: 0.5}
actuators:
  hip: {model: isa_v5, load: {kind: blocked}}
""", encoding='utf-8')
    supply, = load_run(path).supplies
    assert (supply.feeds, supply.places) == (('hip',), ('block',))


@pytest.mark.parametrize(('old', 'new', 'said'), [
    ('{press: [left, right], tool: [clamp]}', '[left, right, clamp]',
     'supplies.station.feeds: the circuit has 6 manifolds, must be lists by manifold, of gallery'),
    ('tool: [clamp]}', 'tol: [clamp]}',
     'supplies.station.feeds.tol is not a manifold; did you mean tool'),
    ('tool: [clamp]}', 'pump: [clamp]}', 'supplies.station.feeds.pump is not a manifold'),
    ('tool: [clamp]}', 'tool: [left]}', "'left' is already fed by station"),
    ('tool: [clamp]}', 'tool: []}', "'clamp' is not fed"),
    ('tool: [clamp]}', 'tool: clamp}', 'supplies.station.feeds.tool'),
    ('tool: [clamp]}\n', 'tool: [clamp]}\n    part: 1\n', 'supplies.station.part is unknown')])
def test_feeds_that_cannot_be_are_refused(
        tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(ConfigError) as refused:
        of(tmp_path, old, new)
    assert said in str(refused.value)


def test_a_supply_without_manifolds_has_no_lists_by_manifold(tmp_path: Path) -> None:
    text = 'name: x\nsupplies: {main: {kind: constant, pressure_mpa: 20.0, ' \
        'return_pressure_mpa: 0.0, feeds: {block: [hip]}}}\n' \
        'actuators: {hip: {model: isa_v5, load: {kind: blocked}}}\n'
    (tmp_path / 'x.yaml').write_text(text, encoding='utf-8')
    with pytest.raises(ConfigError, match='only a circuit has manifolds'):
        load_run(tmp_path / 'x.yaml')


def test_robots_have_circuits_of_their_own_or_share_one() -> None:
    """In their namespace, or one beside them that feeds some of them by manifold."""
    own = load({'name': 'two', 'robots': {
        'a': {'file': 'pump_station'}, 'b': {'file': 'pump_station'}}}).configuration
    assert [supply.name for supply in own.supplies] == ['a/station', 'b/station']
    assert own.supplies[1].feeds == ('b/left', 'b/right', 'b/clamp')
    assert own.supplies[1].places == ('press', 'press', 'tool')
    low = {'kind': 'constant', 'pressure_mpa': 10.0, 'return_pressure_mpa': 0.0,
           'feeds': ['a/left']}
    shared = load({'name': 'two', 'robots': {'a': {'file': 'pump_station'}},
                   'supplies': {'low': low}}).configuration
    assert [(supply.name, supply.feeds) for supply in shared.supplies] == [
        ('low', ('a/left',)), ('a/station', ('a/right', 'a/clamp'))]
    crane = load('crane_circuit').configuration
    assert crane.supplies[0].feeds == ('crane/lift', 'crane/tilt')


def test_its_parts_are_listed_with_range_and_meaning() -> None:
    """In `isa params`."""
    listed = describe('pump_station.yaml')
    row, = (line for line in listed.splitlines() if line.startswith('parts.pump.displacement_ml'))
    assert row.split()[1:3] == ['28', 'ml'] and '> 0, <= 1000' in row
    row, = (line for line in listed.splitlines() if line.startswith('parts.press.returns_to'))
    assert row.split()[1] == 'drain'
