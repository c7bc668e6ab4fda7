"""Runs with external bodies: their ports are recorded, and are inputs of a replay."""

from dataclasses import replace
from functools import partial
import math
from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.errors import BagError, ConfigError
from isa_ros.replay.replay import recorded_inputs, replay
from isa_ros.run.options import Request
from isa_ros.run.session import prepare
from isa_ros.run.without_ros import run_without_ros
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
import pytest
from sensor_msgs.msg import JointState
from tests.bag.golden import rewrite
from tests.surroundings.mass_on_spring import MassOnSpring, OFFSETS

TICKS = 30
CONFIG = """\
name: spring
supply: {kind: constant, pressure_mpa: 20.7, return_pressure_mpa: 0.0}
body: {kind: external, actuators: [back, out], class: 'tests.surroundings.mass_on_spring:Turned'}
actuators:
  out: {model: isa_v5, initial_position_mm: 60.0}
  other: {model: isa_v5, load: {kind: blocked}}
  back: {model: isa_v5, initial_position_mm: 40.0}
"""
SCENARIO = """\
name: push
duration_s: 0.03
tracks:
  out:
    - {t_s: 0.0, position: 0.06, effort: -300.0, stiffness: 1.0e5, damping: 1.0e3}
    - {t_s: 0.01, effort: 900.0, position: 0.06, stiffness: 1.0e5, damping: 1.0e3}
"""


@pytest.fixture(scope='module')
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the run file and the scenario."""
    folder = tmp_path_factory.mktemp('spring')
    (folder / 'spring.yaml').write_text(CONFIG)
    (folder / 'push.yaml').write_text(SCENARIO)
    return folder


@pytest.fixture(scope='module')
def result(files: Path) -> isa_ros.Result:
    """Return the run in memory, its body given by the caller."""
    return isa_ros.load(files / 'spring.yaml', files / 'push.yaml').simulate(body=MassOnSpring)


@pytest.fixture(scope='module')
def bag(files: Path, result: isa_ros.Result) -> Path:
    """Return its bag."""
    return result.save(files / 'bag')


def run_files(files: Path, out: Path, **options: object) -> Path:
    """Run the file without ROS, its body made by its class, and return the bag."""
    run_without_ros(prepare(Request(
        config=files / 'spring.yaml', scenario=files / 'push.yaml', out=out, **options,
        )), None, lambda: False)
    return out


def test_a_sample_has_the_port_of_the_tick_that_it_ends(result: isa_ros.Result) -> None:
    """That of t = 0 has place and force at rest; rows in the order of the body's list."""
    assert result['body.port_x0'][0].tolist() == OFFSETS.tolist()
    assert result['body.port_x0'][1].tolist() == OFFSETS.tolist()
    assert not result['body.port_inverse_mass'][0].any()
    assert result['body.port_inverse_mass'][1] == pytest.approx([1 / 40.0, 0.25 / 40.0], rel=1e-8)
    assert (result['body.port_x0'][2:, 0] == result['body.back_position'][1:-1]).all()
    assert (result['body.port_v0'][2:, 1] == result['body.out_velocity'][1:-1]).all()
    assert (result['body.port_force'][:, 1] == result['body.out_force']).all()
    assert abs(result['body.out_velocity']).max() > 1e-3
    assert result.units['body.port_jerk'] == 'm/s3 | rad/s3'


def test_a_bag_replays_without_the_body(
        bag: Path, result: isa_ros.Result, capsys: pytest.CaptureFixture[str],
        monkeypatch: pytest.MonkeyPatch) -> None:
    """A line says what is not simulated again, and by what it was simulated."""
    def fail(mounting: isa_ros.Mounting) -> None:
        raise AssertionError('a replay makes no body')
    monkeypatch.setattr('tests.surroundings.mass_on_spring.Turned', fail)
    assert main(['replay', str(bag)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == ('the external body (simulator by hand 1.0): its load ports are inputs '
                        'of this replay, it is not simulated again')
    assert lines[-1].startswith(f'equal: {TICKS + 1} ticks, ')
    inputs = recorded_inputs(Bag(bag), result.scenario.run)
    assert sorted(inputs.ports['body']) == list(range(TICKS + 1))
    assert inputs.ports['body'][7]['jerk'].tolist() == result['body.port_jerk'][7].tolist()


def test_every_way_of_running_gives_the_same_bytes(
        files: Path, bag: Path, tmp_path: Path) -> None:
    own = run_files(files, tmp_path / 'bag')
    assert (own / 'bag_0.mcap').read_bytes() == (bag / 'bag_0.mcap').read_bytes()


def test_a_run_that_goes_on_from_a_saved_state_replays(files: Path, tmp_path: Path) -> None:
    """Body and actuators go on as if it had not been interrupted."""
    whole = Bag(run_files(files, tmp_path / 'whole'))
    first = run_files(files, tmp_path / 'first', duration_s=0.012, save=tmp_path / 'state.json')
    second = run_files(files, tmp_path / 'second', restore=tmp_path / 'state.json')
    assert replay(Bag(first)).is_equal and replay(Bag(second)).is_equal
    later = {(one.topic, one.sequence): one.data for one in Bag(second).messages()}
    for message in whole.messages():
        if message.sequence > 12 and '/events' not in message.topic:
            assert later[message.topic, message.sequence] == message.data, message.topic


def altered(topic: str, sequence: int, data: bytes, *, by: int, at: int) -> bytes:
    """Change the last byte but ``by`` of a load port."""
    if topic != '/out/load_port' or sequence != at:
        return data
    place = len(data) - by
    return data[:place] + bytes([data[place] ^ 1]) + data[place + 1:]


def test_another_port_gives_another_run(bag: Path, tmp_path: Path) -> None:
    """1/m_eff with its smallest bits changed acts in its own tick; x0 too."""
    rewrite(Bag(bag), tmp_path / 'changed', partial(altered, by=6, at=20))
    difference = replay(Bag(tmp_path / 'changed')).report.difference
    assert difference is not None and difference.tick == 20
    assert difference.topic.startswith('/out/')


def test_a_bag_without_a_port_is_refused(
        files: Path, bag: Path, result: isa_ros.Result, tmp_path: Path) -> None:
    rewrite(Bag(bag), tmp_path / 'lost', lambda topic, sequence, data: (
        None if topic.endswith('load_port') and sequence == 9 else data))
    with pytest.raises(BagError, match='has no load ports of tick 8'):
        replay(Bag(tmp_path / 'lost'))
    rewrite(Bag(bag), tmp_path / 'none', lambda topic, sequence, data: (
        None if topic.endswith('load_port') else data))
    with pytest.raises(BagError, match='has no load ports of the external body$'):
        recorded_inputs(Bag(tmp_path / 'none'), result.scenario.run)


@pytest.mark.parametrize(('at', 'number', 'message'), [
    ('position', math.nan, 'stiffness = nan, must be finite'),
    ('effort', -math.inf, 'inverse_mass = -inf, must be finite'),
    ('velocity', None, '2 numbers, must be 3: v0, jerk, damping')])
def test_a_port_that_cannot_be_is_refused_with_its_place(
        bag: Path, result: isa_ros.Result, tmp_path: Path, at: str, number: float | None,
        message: str) -> None:
    def broken(topic: str, sequence: int, data: bytes) -> bytes:
        if topic != '/back/load_port' or sequence != 9:
            return data
        port = decode(data, JointState)
        values = [*getattr(port, at)[:2], *([] if number is None else [number])]
        setattr(port, at, values)
        return encode(port)
    rewrite(Bag(bag), tmp_path / 'broken', broken)
    with pytest.raises(BagError, match=rf'/back/load_port, tick 9 \(t = 0.009000 s\): {message}'):
        recorded_inputs(Bag(tmp_path / 'broken'), result.scenario.run)


@pytest.mark.parametrize(('record', 'message'), [
    ({'leave_out': ['/*/load_port']}, 'leaves out /back/load_port, which a replay needs'),
    ({'decimate': {'/out/load_port': 5}}, 'decimates /out/load_port, of which a replay needs')])
def test_ports_are_recorded_whole(files: Path, record: dict[str, object], message: str) -> None:
    run = isa_ros.load(files / 'spring.yaml', files / 'push.yaml').configuration
    thinned = isa_ros.load(files / 'spring.yaml', changes={'record': record}).configuration
    topics = [f'/{name}/load_port' for name in ('back', 'out')]
    with pytest.raises(ConfigError, match=message):
        thinned.record.refuse_misfits(topics, run.source)


@pytest.mark.parametrize(('maker', 'message'), [
    ('crane', "body.class = 'crane', must be module:factory"),
    ('1crane:it', 'must be module:factory'),
    ('crane.:it', 'must be module:factory')])
def test_a_class_that_is_none_is_refused(files: Path, maker: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        isa_ros.load(files / 'spring.yaml', changes={'body.class': maker})


@pytest.mark.parametrize(('maker', 'message'), [
    ('no_such_crane:it',
     "spring.yaml: body.class = no_such_crane:it: No module named 'no_such_crane'"),
    ('math:crane', 'body.class = math:crane: math has no function crane'),
    ('math:pi', 'pi is of type float, must be a function')])
def test_a_class_that_cannot_be_made_ends_before_the_run(
        files: Path, tmp_path: Path, maker: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        prepare(Request(config=files / 'spring.yaml', out=tmp_path / 'bag',
                        changes=(f'body.class={maker}',)))
    assert not (tmp_path / 'bag').exists()


def test_a_module_of_the_current_folder_is_found(
        files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / 'own_spring_body.py').write_text(
        'from tests.surroundings.mass_on_spring import Turned as make\n')
    monkeypatch.chdir(tmp_path)
    run = isa_ros.load(files / 'spring.yaml', changes={'body.class': 'own_spring_body:make'})
    assert 'body.out_position' in run.simulate(0.002)


def test_the_class_is_part_of_the_configuration(files: Path) -> None:
    run = isa_ros.load(files / 'spring.yaml').configuration
    assert run_of_text(run.to_yaml()) == run
    body, = run.bodies
    assert replace(body, maker=None) != body and body.maker.endswith(':Turned')
