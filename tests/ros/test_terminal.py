"""`isa echo`, `isa set` and `isa command`, with an actuator alone in another process."""

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
import re

from isa_ros.cli import talk
from isa_ros.cli.main import main
from isa_ros.core.device import REFERENCES
from isa_ros.core.signals import GAINS_OF_COMMAND
from isa_ros.errors import ConfigError
from isa_ros.nodes.terminal.echo import message_text, message_type
from isa_ros.nodes.terminal.parameters import change_of, ParameterChange
from isa_ros.nodes.terminal.setpoints import GivenSetpoint, is_new, REQUESTS
from isa_ros.nodes.terminal.visitor import visiting
import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tests.ros.domains import held_domain
from tests.ros.started import Started, started, wait_for
import yaml

pytestmark = pytest.mark.ros


@pytest.fixture(scope='module')
def ram(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the name of an ISA v5 in a namespace, which runs in another process."""
    log = tmp_path_factory.mktemp('ram') / 'log'
    with pytest.MonkeyPatch.context() as patch, held_domain(patch), \
            started(log, 'isa_ros.programs.actuator', '--ros-args', '-r', '__node:=ram', '-r',
                    '__ns:=/lab', '-p', 'model:=isa_v5') as process:
        wait_for(lambda: 'ready at' in process.errors)
        yield 'lab/ram'


def printed(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> str:
    """Return what a command prints; its errors, if it is to end with another code than 0."""
    assert main(list(arguments)) == code
    out, errors = capsys.readouterr()
    return errors if code > 1 else out


def test_a_command_moves_the_actuator(ram: str, capsys: pytest.CaptureFixture[str]) -> None:
    """What took effect is printed; the encoder follows."""
    text = printed(capsys, 'command', ram, '0.03', '--stiffness', '2e5')
    assert re.fullmatch(
        r'/lab/ram: impedance: position 0.03, velocity 0, effort 0, stiffness 200000, '
        r'damping 4000, from t = \d+\.\d{6} s on\n', text)

    def has_arrived() -> bool:
        message = yaml.safe_load(
            printed(capsys, 'echo', f'{ram}/joint_states', '--count', '1').partition('---')[0])
        return abs(message['position'][0] - 0.03) < 1e-3
    wait_for(has_arrived, 'the arrival')


def test_a_setpoint_that_is_rejected_is_2_with_the_reason(
        ram: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(capsys, 'command', ram, '0.9', code=2)
    assert text.startswith('isa: /lab/ram: setpoint rejected: ram: setpoint position = 0.9 m, ')


@pytest.mark.parametrize('processes', [['--in-process'], []])
def test_a_run_gives_the_reason_of_a_rejection_too(
        tmp_path: Path, domain: int, processes: list[str],
        capsys: pytest.CaptureFixture[str]) -> None:
    with started(tmp_path / 'log', 'isa_ros', 'bringup', 'rig_linear', *processes,
                 '--real-time-factor', '1', '--out', str(tmp_path / 'bag')):
        text = printed(capsys, 'command', 'ram', '0.9', '--timeout', '60', code=2)
    assert text.startswith('isa: /ram: setpoint rejected: ram: setpoint position = 0.9 m, ')


def test_a_request_that_the_device_declines_is_1(
        ram: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert 'clear_fault needs fault' in printed(capsys, 'command', ram, '--clear-fault', code=1)
    assert ': disabled from t = ' in printed(capsys, 'command', ram, '--disable')
    assert printed(capsys, 'command', ram, '0.03', code=1).endswith(
        ' s on, not followed: the device is not enabled\n')
    assert ': enabled from t = ' in printed(capsys, 'command', ram, '--enable')


def test_parameters_are_set_at_once_and_shown(
        ram: str, capsys: pytest.CaptureFixture[str]) -> None:
    before = printed(capsys, 'set', ram, 'reu.force.kp').split()
    assert before[0] == 'reu.force.kp:'
    text = printed(capsys, 'set', ram, 'reu.force.kp=3e-06', 'reu.force.kd')
    assert text == f'reu.force.kp: {before[1]} -> 3e-06\nreu.force.kd: 0.0\n'
    assert printed(capsys, 'set', ram, 'reu.force.kp') == 'reu.force.kp: 3e-06\n'


@pytest.mark.parametrize('change, expected', [
    ('reu.force.kp=-3', 'isa: /lab/ram: reu.force.kp = -3, must be 0 to 3.64544e-05: prop'),
    ('reu.force.kp=abc', 'isa: /lab/ram: reu.force.kp = abc, must be a number: '),
    ('reu.force.kpp=3', 'parameter reu.force.kpp is unknown; did you mean reu.force.kp'),
    ('plant.drive.bore_mm=50', 'parameter plant.drive.bore_mm does not change during a run'),
    ('plant.drive.bore=50', 'parameter plant.drive.bore is unknown'),
    ('plant.drive', 'parameter plant.drive is unknown'),
    ('=3', "'=3': must be KEY=VALUE, or KEY to read it"),
    ('reu.force.kp=', 'isa: /lab/ram: reu.force.kp = nothing, must be a number: '),
    ('reu.force.kp={a: 1}', 'isa: reu.force.kp = {a: 1}: not a value of a parameter'),
])
def test_a_parameter_that_cannot_be_set_is_2(
        ram: str, change: str, expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(capsys, 'set', ram, change, code=2)
    assert expected in text and text.count('\n') == 1


NOT_THERE = {
    'topic': (['echo', 'lab/ram/joint_state'],
              'topic /lab/ram/joint_state not found within 3 s; '
              'did you mean /lab/ram/joint_states'),
    'actuator': (['command', 'lab/rum', '0.02'],
                 'actuator /lab/rum not found within 3 s; did you mean /lab/ram?'),
    'device': (['command', 'lab/rum', '--enable'],
               'actuator /lab/rum not found within 3 s; did you mean'),
    'node': (['set', 'lab/rum', 'reu.force.kp'],
             'node /lab/rum not found within 3 s; did you mean /lab/ram?')}


@pytest.fixture(scope='module')
def searching(ram: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Started]]:
    """Return the commands about what is not there, which wait at the same time."""
    folder = tmp_path_factory.mktemp('searching')
    with ExitStack() as stack:
        yield {name: stack.enter_context(
            started(folder / name, 'isa_ros', *arguments, '--timeout', '3'))
            for name, (arguments, _) in NOT_THERE.items()}


@pytest.mark.parametrize('name', NOT_THERE)
def test_what_is_not_there_is_3_with_what_is(searching: dict[str, Started], name: str) -> None:
    assert searching[name].exit_code() == 3
    text = searching[name].errors
    assert NOT_THERE[name][1] in text and text.count('\n') == 1


def test_without_a_topic_all_are_listed(ram: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert '/lab/ram/load_cell  geometry_msgs/msg/WrenchStamped\n' in printed(capsys, 'echo')


def test_so_many_messages_are_printed(ram: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(capsys, 'echo', f'{ram}/valve', '--count', '3')
    documents = [each for each in yaml.safe_load_all(text) if each]
    assert [each['name'] for each in documents] == [['ram/spool', 'ram/supply']] * 3
    stamps = [each['header']['stamp'] for each in documents]
    assert len({(stamp['sec'], stamp['nanosec']) for stamp in stamps}) == 3


def test_kept_messages_are_echoed_too(ram: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Of a publisher that is silent since: its device's status."""
    assert 'ram' in printed(capsys, 'echo', f'{ram}/applied_setpoint', '--count', '1')


def test_of_messages_that_are_kept_the_last_ones_are_printed(
        ram: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Whatever the device does with them: of those before nothing is shown."""
    for position in ('0.0311', '0.0312', '0.0313'):
        main(['command', ram, position])
    capsys.readouterr()
    for count, expected in (('1', [0.0313]), ('2', [0.0312, 0.0313])):
        told = yaml.safe_load_all(
            printed(capsys, 'echo', f'{ram}/applied_setpoint', '--count', count))
        assert [own['position'][0] for own in told if own] == expected


def test_an_empty_domain_says_so(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    with held_domain(monkeypatch):
        text = printed(capsys, 'command', 'ram', '0.02', '--timeout', '0.3', code=3)
    assert 'there is none: is a run going on in this ROS_DOMAIN_ID?' in text


@pytest.mark.parametrize('arguments', [
    [], ['--stiffness', '3'], ['0.02', '--enable'], ['--enable', '--spool', '1e-4']])
def test_a_command_is_a_setpoint_or_a_request(
        arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(capsys, 'command', 'ram', *arguments, code=2)
    assert text.startswith('isa: needs either a setpoint (POSITION, ')


def test_discovery_that_is_off_is_refused(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'OFF')
    with pytest.raises(ConfigError, match='OFF'), visiting(1.0):
        pass


def test_a_setpoint_has_the_entries_of_what_was_given() -> None:
    wanted = GivenSetpoint(0.4, None, 70.0, {'damping': 8.0}, {})
    assert wanted.message('a/b') == JointState(
        name=['a/b', 'a/b/damping'], position=[0.4, 8.0], effort=[70.0])
    assert GivenSetpoint(None, None, None, {}, {'spool': 3e-4}).message('b') == JointState(
        name=['b/spool'], position=[3e-4])
    effort_alone = GivenSetpoint(None, 0.2, 5.0, {}, {}).message('b')
    assert list(effort_alone.velocity) == [0.2] and effort_alone.position[0] != (
        effort_alone.position[0])


@pytest.mark.parametrize('changed, expected', [(1, True), (64, True), (66, True), (2, False)])
def test_a_change_of_the_device_is_no_setpoint(changed: int, expected: bool) -> None:
    message = JointState(name=['b', 'b/changed'], position=[0.0, float(changed)])
    assert is_new(message) is expected


def test_the_words_of_the_command_line_are_those_of_the_nodes() -> None:
    """It has them without importing numba or ROS."""
    assert talk.REFERENCES == tuple(REFERENCES) and talk.GAINS == GAINS_OF_COMMAND
    assert talk.REQUESTS == tuple(REQUESTS)


def test_a_text_of_a_message_does_nothing_to_the_terminal() -> None:
    assert '\x1b' not in message_text(String(data='\x1b[2J red'))
    assert message_type('std_msgs/msg/String') is String
    with pytest.raises(ConfigError, match='no_msgs/msg/No: not installed'):
        message_type('no_msgs/msg/No')


def test_a_change_may_hold_an_equals_sign() -> None:
    assert change_of('a.b=c=d') == ParameterChange('a.b', 'c=d')
    assert change_of('a.b') == ParameterChange('a.b', None)
    assert change_of('a.b=') == ParameterChange('a.b', '')
