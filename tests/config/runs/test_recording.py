"""The section `record`: its keys, refused values, and options of the command line."""

from pathlib import Path

from isa_ros.bag.storage import Storage
from isa_ros.cli.main import main
from isa_ros.config.runs.recording import RECORD, RecordConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.core.topic import Topic
from isa_ros.errors import ConfigError
from isa_ros.run.options import Request
from isa_ros.run.session import prepare
from isa_ros.run.thinning import Thinning
import pytest

RIG = Path(__file__).parents[3] / 'config' / 'rig_rotary.yaml'
TOPICS = ['/clock', '/coordinator/events', '/rotor/applied_setpoint', '/rotor/references',
          '/rotor/valve']
ALL = """record:
  compression: zstd
  split_mb: 20
  leave_out: [/*/references]
  decimate: {/rotor/valve: 10, "*": 2}
"""


def record(text: str) -> RecordConfig:
    found: RecordConfig = RECORD.read(parse(text, 'x.yaml')['record'], Place('x.yaml', 'record'))
    return found


def with_record(tmp_path: Path, text: str) -> Path:
    path = tmp_path / 'rig.yaml'
    path.write_text(RIG.read_text() + text)
    return path


def test_every_key_is_optional() -> None:
    assert record('record: {}') == RecordConfig()
    assert record('record: {split_mb: 5}').storage == Storage(compression='none', split_mb=5.0)


def test_section_says_what_is_written() -> None:
    assert record(ALL) == RecordConfig(
        Storage(compression='zstd', split_mb=20.0), ('/*/references',),
        (('/rotor/valve', 10), ('*', 2)))
    assert record(ALL).storage.split_bytes == 20_000_000


@pytest.mark.parametrize('text, expected', [
    ('record: {compress: zstd}', 'x.yaml: record.compress is unknown; did you mean compression?'),
    ('record: {compression: rar}',
     "x.yaml: record.compression = 'rar', must be one of none, lz4, zstd"),
    ('record: {split_mb: -1}', 'record.split_mb = -1 MB, must be >= 0 MB'),
    ('record: {split_mb: many}', "record.split_mb = 'many', must be a number in MB"),
    ('record: zstd', "record = 'zstd', must be a section"),
    ('record: {leave_out: /a}', "record.leave_out = '/a', must be a list of topics"),
    ('record: {leave_out: [a]}', "record.leave_out = 'a', must be a topic like /hip/valve"),
    ('record: {leave_out: [1]}', 'record.leave_out = 1, must be a topic'),
    ('record: {decimate: {/a: 1}}', 'record.decimate./a = 1, must be a whole number of ticks'),
    ('record: {decimate: {/a: 2.5}}', 'record.decimate./a = 2.5, must be a whole number'),
    ('record: {decimate: {/a: true}}', 'record.decimate./a = True, must be a whole number'),
    ('record: {decimate: {/a: 10001}}', 'must be a whole number of ticks >= 2 and <= 10000'),
    (f'record: {{leave_out: [{", ".join(["/a"] * 101)}]}}', '101 patterns, must be <= 100'),
    (f'record: {{leave_out: [/{"a" * 256}]}}', 'of <= 256 characters'),
])
def test_malformed_section_is_refused_by_key(text: str, expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        record(text)
    assert expected in str(caught.value)


def test_period_is_that_of_the_first_pattern_that_fits() -> None:
    """The inputs of a replay are complete for any patterns."""
    thinned = record(ALL)
    assert {topic: thinned.period(topic) for topic in TOPICS} == {
        '/clock': 2, '/coordinator/events': 1, '/rotor/applied_setpoint': 1,
        '/rotor/references': 0, '/rotor/valve': 10}


@pytest.mark.parametrize('text, expected', [
    ('{leave_out: [/rotor/applied_setpoint]}',
     "x.yaml: record.leave_out = '/rotor/applied_setpoint' leaves out /rotor/applied_setpoint, "
     'which a replay needs'),
    ('{leave_out: [/rotor/*]}', "'/rotor/*' leaves out /rotor/applied_setpoint, which a replay"),
    ('{leave_out: [/coordinator/events]}', 'leaves out /coordinator/events, which a replay'),
    ('{leave_out: [/knee/valve]}',
     "x.yaml: record.leave_out = '/knee/valve' matches no topic; valid: /clock, "),
    ('{decimate: {/knee/valve: 3}}', "record.decimate = '/knee/valve' matches no topic"),
    ('{decimate: {/rotor/applied_*: 3}}',
     "record.decimate = '/rotor/applied_*' decimates /rotor/applied_setpoint, of which a replay"),
])
def test_pattern_that_does_not_fit_the_run_is_refused(text: str, expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        record(f'record: {text}').refuse_misfits(TOPICS, 'x.yaml')
    assert expected in str(caught.value)
    assert '\n' not in str(caught.value)


def test_section_is_part_of_the_resolved_configuration(tmp_path: Path) -> None:
    run = load_run(with_record(tmp_path, ALL))
    assert run.record == record(ALL)
    assert run_of_text(run.to_yaml()) == run


def test_how_a_run_is_recorded_is_no_part_of_what_it_is(tmp_path: Path) -> None:
    """A state saved with one section continues under another."""
    assert load_run(with_record(tmp_path, ALL)).digest == load_run(
        with_record(tmp_path, '')).digest


def test_configuration_from_before_the_section_records_everything() -> None:
    run = load_run(RIG)
    text = run.to_yaml()
    start = text.index('record:')
    without = text[:start] + text[text.index('actuators:'):]
    assert run_of_text(without) == run


def test_command_line_wins_and_is_recorded(tmp_path: Path) -> None:
    path = with_record(tmp_path, ALL)
    session = prepare(Request(config=path, out=tmp_path / 'bag', compression='lz4', split_mb=0.0))
    assert session.run.record.storage == Storage(compression='lz4', split_mb=0.0)
    assert session.run.record.leave_out == ('/*/references',)
    assert run_of_text(session.run.to_yaml()).record == session.run.record
    assert prepare(Request(config=path, out=tmp_path / 'bag')).run.record == record(ALL)


@pytest.mark.parametrize('options, expected', [
    (('--compression', 'rar'), "invalid choice: 'rar'"),
    (('--split-mb', '-1'), "'-1' must be a number >= 0"),
    (('--split-mb', '1e9'), 'split_mb = 1e+09 MB, must be <= 1e+06 MB'),
])
def test_wrong_option_is_refused_in_one_line(tmp_path, capsys, options, expected) -> None:
    try:
        code = main(['bringup', str(RIG), '--out', str(tmp_path / 'bag'), *options])
    except SystemExit as end:
        code = end.code
    printed = capsys.readouterr()
    assert code == 2 and printed.err.count('\n') == 1
    assert expected in printed.err
    assert not (tmp_path / 'bag').exists()


def test_pattern_is_refused_before_anything_starts(tmp_path, capsys) -> None:
    path = with_record(tmp_path, 'record: {leave_out: [/rotor/applied_setpoint]}\n')
    assert main(['bringup', str(path), '--out', str(tmp_path / 'bag')]) == 2
    assert 'rig.yaml: record.leave_out = ' in capsys.readouterr().err
    assert not (tmp_path / 'bag').exists()


class Recorded:
    """Keeps the ticks it receives."""

    def __init__(self) -> None:
        self.ticks: list[tuple[int, list[tuple[int, bytes]]]] = []

    def write_tick(self, t_ns, sequence, messages) -> None:
        self.ticks.append((sequence, list(messages)))


def test_recorder_gets_what_is_kept_under_its_new_index() -> None:
    topics = [Topic(name, 'std_msgs/msg/Empty') for name in TOPICS]
    thinning = Thinning(record(ALL), topics)
    assert [topic.name for topic in thinning.topics] == [
        '/clock', '/coordinator/events', '/rotor/applied_setpoint', '/rotor/valve']
    sink = Recorded()
    recorder = thinning.recorder(sink)
    for tick in (9, 10, 11):
        recorder.write_tick(tick, tick, [(k, bytes([k])) for k in range(5)])
    assert sink.ticks == [
        (9, [(1, b'\1'), (2, b'\2')]),
        (10, [(0, b'\0'), (1, b'\1'), (2, b'\2'), (3, b'\4')]),
        (11, [(1, b'\1'), (2, b'\2')])]


def test_recorder_of_everything_is_the_recorder_itself() -> None:
    sink = Recorded()
    topics = [Topic(name, 'std_msgs/msg/Empty') for name in TOPICS]
    assert Thinning(RecordConfig(), topics).recorder(sink) is sink
