"""The resolved text: read back as it was written, older texts as well, differences by key."""

from dataclasses import replace
from pathlib import Path
import re

from isa_ros.bag.storage import Storage
from isa_ros.config.differences import key_differences, modern
from isa_ros.config.runs.emergency_stops import EmergencyStopConfig
from isa_ros.config.runs.publishing import PublishConfig
from isa_ros.config.runs.recording import RecordConfig
from isa_ros.config.runs.run_config import RUN, RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.config.text.keys import InText, KeyDifference
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import dump, parse
from isa_ros.errors import ConfigError
import pytest
from tests.runs import ACCUMULATOR, hip_and_knee, RETURN_LINE

CONFIG = Path(__file__).parents[3] / 'config'
LEG = load_run(CONFIG / 'leg.yaml')
TWO = replace(hip_and_knee([
    SupplyConfig('main', replace(ACCUMULATOR, return_line=RETURN_LINE), ('knee',)),
    SupplyConfig('low', ACCUMULATOR, ('hip',))]), start_time_s=2_000_000_000, accept='scenario',
    emergency_stops=(EmergencyStopConfig('both', ('hip', 'knee')),),
    publish=PublishConfig((('/clock', 7),)))
FULL = replace(
    LEG, emergency_stops=(EmergencyStopConfig('legs', ('haa', 'kfe'), ('block',)),),
    controllers=('sway', 'gait'), accept='scenario', start_time_s=1, record=RecordConfig(
        Storage(compression='zstd', split_mb=12.5), ('/*/references',), (('/*/valve', 10),)),
    publish=PublishConfig((('/*/valve', 3),)))


@pytest.mark.parametrize('run', [LEG, TWO, FULL], ids=['leg', 'two supplies', 'all keys'])
def test_the_resolved_text_is_read_back_as_it_was_written(run: RunConfig) -> None:
    """Every value bit for bit, and the same text of it."""
    text = run.to_yaml()
    assert run_of_text(text) == run
    assert run_of_text(text).to_yaml() == text
    assert list(key_differences(parse(text, 'text'), Place('text'))) == []


def test_the_keys_stand_in_their_declared_order() -> None:
    keys = [key.name for key in RUN.keys
            if key.in_text is not InText.NEVER and key.name != 'bodies']     # it has one: `body`
    assert list(parse(FULL.to_yaml(), 'text')) == keys
    assert list(parse(TWO.to_yaml(), 'text')) == [key for key in keys if key != 'body']


def older(run: RunConfig) -> str:
    """Return the text as it was with one supply for all, and the leg at the top."""
    tree = dict(parse(run.to_yaml(), 'text'))
    supply = dict(tree.pop('supplies')['supply'])
    del supply['feeds']
    tree['supply'] = supply
    leg = dict(tree.pop('body'))
    assert leg.pop('kind') == 'leg'
    return dump(tree | {'leg': leg})


def test_an_older_text_with_one_supply_and_a_leg_is_read() -> None:
    """Byte for byte the run it was; nothing is missing in it."""
    text = older(LEG)
    assert re.search(r'^supply:$', text, re.MULTILINE)
    assert re.search(r'^leg:$', text, re.MULTILINE)
    again = run_of_text(text)
    assert again == LEG and again.digest == LEG.digest
    assert list(key_differences(parse(text, 'text'), Place('text'))) == []


def test_a_text_with_both_forms_is_refused() -> None:
    """An older key beside the newer one is not read as if it were not there."""
    supply = parse(older(LEG), 'text')['supply']
    leg = parse(older(LEG), 'text')['leg']
    for key, value, message in (('supply', supply, 'has supply and supplies, must have only one'),
                                ('leg', leg, 'has leg and body, must have one')):
        text = dump(dict(parse(LEG.to_yaml(), 'text')) | {key: value})
        with pytest.raises(ConfigError, match=f'old.yaml: {message}'):
            run_of_text(text, 'old.yaml')


def test_a_modern_tree_is_left_alone() -> None:
    """And the given tree is never changed."""
    tree = parse(LEG.to_yaml(), 'text')
    assert modern(tree) == tree
    old = parse(older(LEG), 'text')
    before = dump(old)
    assert modern(old) != old
    assert dump(old) == before


def differences(run: RunConfig, pattern: str, replacement: str) -> list[KeyDifference]:
    """Return what differs once one place of the text is another."""
    text, count = re.subn(pattern, replacement, run.to_yaml(), count=1, flags=re.MULTILINE)
    assert count == 1
    return list(key_differences(parse(text, 'text'), Place('t.yaml')))


@pytest.mark.parametrize(('pattern', 'replacement', 'text', 'is_obstacle'), [
    (r'^(name: .*)$', r'\1\nmagic: 1', 'magic is unknown here', True),
    (r'^step_ns: .*\n', '', 'step_ns is missing in the bag', True),
    (r'^controllers:.*\n', '', 'controllers is missing in the bag, none is meant', False),
    (r'^record:\n(?: .*\n)*', '', 'record is missing in the bag, everything is meant', False),
    (r'^(record:\n)', r'\1  mode: 1\n', 'record.mode is unknown here', True),
    (r'^( +)precharge_mpa: .*$', r'\1precharge: 1.0',
     'supplies.main.precharge is unknown here', True),
    (r'^ +pump_lag_s: .*\n', '', 'supplies.main.pump_lag_s is missing in the bag', True),
    (r', tank_lpm_per_mpa: [0-9.]+', '',
     'supplies.main.return_line.tank_lpm_per_mpa is missing in the bag', True),
    (r'^    feeds:.*\n', '', 'supplies.main.feeds is missing in the bag', True),
    (r'^( +)kind: accumulator$', r'\1kind: pump',
     "supplies.main: the kind 'pump' is unknown here", True),
    (r'^    model: smart_manifold\n', '', 'actuators.hip.model is missing in the bag', True)])
def test_a_key_that_differs_is_named(
        pattern: str, replacement: str, text: str, is_obstacle: bool) -> None:
    """With the word whether the run can be simulated without it."""
    found = differences(TWO, pattern, replacement)
    assert KeyDifference(f't.yaml: {text}', is_obstacle) in found
    assert all(own.is_obstacle for own in found if own.text != f't.yaml: {text}')


def test_the_keys_of_a_body_that_differ_are_named() -> None:
    """Those of a kind that is not known here cannot be told."""
    assert differences(LEG, r'^  kind: leg$', '  kind: arm') == [
        KeyDifference("t.yaml: body: the kind 'arm' is unknown here", True)]
    assert differences(LEG, 'release_s: ', 'release: ') == [
        KeyDifference('t.yaml: body.start.release is unknown here', True),
        KeyDifference('t.yaml: body.start.release_s is missing in the bag', True)]


def test_a_text_from_before_return_lines_is_read_and_said() -> None:
    """They stayed at the pressure of the tank."""
    run = replace(TWO, supplies=(
        replace(TWO.supplies[1], feeds=('hip', 'knee')),))
    text, count = re.subn(r'^ +return_line:.*\n', '', run.to_yaml(),
                          flags=re.MULTILINE)
    assert count == 1
    assert run_of_text(text) == run
    assert list(key_differences(parse(text, 'text'), Place('t.yaml'))) == [KeyDifference(
        't.yaml: supplies.low.return_line is missing in the bag, held is meant', False)]


@pytest.mark.parametrize(('pattern', 'replacement', 'message'), [
    (r'^step_ns: .*$', 'step_ns: 1.5', r'step_ns = 1.5, must be of type int'),
    (r'^    feeds:.*\n', '', r'supplies.main lacks feeds'),
    (r'\[knee\]', '[ankle]', "'ankle' is not an actuator"),
    (r'^( +)kind: accumulator$', r'\1kind: pump', "kind = 'pump', must be one of")])
def test_a_damaged_text_is_refused(pattern: str, replacement: str, message: str) -> None:
    text, count = re.subn(pattern, replacement, TWO.to_yaml(), count=1, flags=re.MULTILINE)
    assert count == 1
    with pytest.raises(ConfigError, match=rf'^t.yaml.*{message}'):
        run_of_text(text, 't.yaml')
