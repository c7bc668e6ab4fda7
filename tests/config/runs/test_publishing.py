"""The section `publish`: its key, refused values, and what it does not change."""

from pathlib import Path

from isa_ros.config.runs.publishing import PublishConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.core.topic import KEPT, Topic
from isa_ros.errors import ConfigError
from isa_ros.run.options import Request
from isa_ros.run.session import prepare
import pytest
from tests.config.runs.test_recording import with_record

SECTION = 'publish:\n  decimate: {/rotor/valve: 10, "*": 2}\n'
TYPE = 'std_msgs/msg/Float64'


def test_the_section_is_read_and_in_the_resolved_text(tmp_path: Path):
    run = load_run(with_record(tmp_path, SECTION))
    assert run.publish == PublishConfig((('/rotor/valve', 10), ('*', 2)))
    assert run_of_text(run.to_yaml(), 'text').publish == run.publish


def test_it_changes_no_signal_and_without_it_nothing_of_the_text(tmp_path: Path):
    plain = load_run(with_record(tmp_path, ''))
    thinned = load_run(with_record(tmp_path, SECTION))
    assert plain.digest == thinned.digest
    assert 'publish' not in plain.to_yaml()
    assert plain.publish == PublishConfig()


@pytest.mark.parametrize(('topic', 'period'), [
    (Topic('/rotor/valve', TYPE), 10), (Topic('/clock', TYPE), 2),
    (Topic('/rotor/device', TYPE, KEPT), 1), (Topic('/coordinator/events', TYPE), 1),
    (Topic('/rotor/applied_setpoint', TYPE), 1)])
def test_the_first_pattern_counts_and_what_stays_in_force_is_whole(topic, period):
    assert PublishConfig((('/rotor/valve', 10), ('*', 2))).period(topic) == period


def test_without_patterns_every_tick_counts():
    assert PublishConfig().period(Topic('/rotor/valve', TYPE)) == 1


@pytest.mark.parametrize(('text', 'expected'), [
    ('publish: {decimat: {}}', 'publish.decimat is unknown; did you mean decimate?'),
    ('publish: {decimate: {/rotor/valve: 1}}',
     'publish.decimate./rotor/valve = 1, must be a whole number of ticks >= 2 and <= 10000'),
    ('publish: {decimate: {valve: 2}}', "publish.decimate = 'valve', must be a topic like"),
    ('publish: 3', 'publish = 3, must be a section')])
def test_a_wrong_value_is_refused_in_one_line(tmp_path: Path, text: str, expected: str):
    with pytest.raises(ConfigError) as error:
        load_run(with_record(tmp_path, text + '\n'))
    assert expected in str(error.value) and '\n' not in str(error.value)


@pytest.mark.parametrize(('pattern', 'expected'), [
    ('/rotor/valv', "rig.yaml: publish.decimate = '/rotor/valv' matches no topic; valid: /clock"),
    ('/*/applied_*', "rig.yaml: publish.decimate = '/*/applied_*' decimates "
     '/coordinator/applied_parameters, of which every message counts'),
    ('/coordinator/events', 'decimates /coordinator/events, of which every message counts')])
def test_a_pattern_that_does_nothing_is_refused_before_the_run(tmp_path, pattern, expected):
    path = with_record(tmp_path, f'publish: {{decimate: {{{pattern!r}: 5}}}}\n')
    with pytest.raises(ConfigError) as error:
        prepare(Request(config=path, out=tmp_path / 'bag'))
    assert expected in str(error.value)


def test_robots_share_the_section_of_their_run(tmp_path: Path):
    path = tmp_path / 'pair.yaml'
    path.write_text('name: pair\nrobots: {r1: {file: leg}, r2: {file: leg}}\n'
                    'publish: {decimate: {/r1/*: 5}}\n')
    assert load_run(path).publish == PublishConfig((('/r1/*', 5),))


def test_a_pattern_may_also_fit_topics_that_are_whole(tmp_path: Path):
    path = with_record(tmp_path, 'publish: {decimate: {"/rotor/*": 5}}\n')
    session = prepare(Request(config=path, out=tmp_path / 'bag'))
    assert session.run.publish.decimate == (('/rotor/*', 5),)


def test_a_section_in_which_the_files_of_robots_agree_is_that_of_the_run(tmp_path: Path):
    with_record(tmp_path, 'publish: {decimate: {"*": 3}}\n')
    path = tmp_path / 'pair.yaml'
    path.write_text('name: pair\nrobots: {r1: {file: rig.yaml}, r2: {file: rig.yaml}}\n')
    assert load_run(path).publish == PublishConfig((('*', 3),))
