"""Controllers of a user: one in the lockstep, and one that follows /clock."""

import hashlib
from pathlib import Path
import signal

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.runs.run_file import load_run
from isa_ros.controller import Controller
from isa_ros.examples.sway import Sway
from isa_ros.replay.replay import replay
from isa_ros.run.output import packer_of
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
from msg_adapters import event
from msg_adapters.cdr_reader import decode
import pytest
from sensor_msgs.msg import JointState
from tests.ros.bags import sha256
from tests.ros.domains import held_domain
from tests.ros.in_millimetres import InMillimetres
from tests.ros.started import bringup, LEG, started, wait_for

pytestmark = pytest.mark.ros
SWAY = 'isa_ros.examples.sway'
BESIDE = 'isa_ros.examples.beside_the_clock'


def record(bag: Path, *options: str) -> str:
    """Run the leg with the controller ``sway`` and return the sha256 of the bag."""
    bag.parent.mkdir()
    with bringup(bag, '--controller', 'sway', *options) as run:
        assert run.exit_code() == 0, run.errors
    return sha256(bag)


@pytest.fixture(scope='module')
def swayed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the bag of 0.1 s with the controller, all in processes of their own."""
    directory = tmp_path_factory.mktemp('swayed')
    bag = directory / 'several' / 'bag'
    with pytest.MonkeyPatch.context() as patch, held_domain(patch), \
            started(directory / 'sway.log', SWAY):
        record(bag, '--duration', '0.1')
    return bag


def setpoints(bag: Path) -> list[tuple[int, float]]:
    """Return (tick of effect, position) of the setpoints applied to HFE."""
    return [(message.sequence - 1, decode(message.data, JointState).position[0])
            for message in Bag(bag).messages()
            if message.topic == '/hfe/applied_setpoint' and message.sequence]


def messages_from(bag: Path, t_ns: int) -> list[tuple]:
    return [message for message in Bag(bag).messages() if message.t_ns >= t_ns]


@pytest.mark.slow
def test_a_controller_in_the_lockstep_gives_the_same_bytes_every_time(swayed, domain, tmp_path):
    """In processes, in one process, and restored half-way; replay needs no controller."""
    bags = [swayed, *(tmp_path / name / 'bag' for name in ('one', 'half', 'rest'))]
    state = tmp_path / 'state.json'
    with started(tmp_path / 'sway.log', SWAY):
        assert record(bags[1], '--duration', '0.1', '--in-process') == sha256(swayed)
        record(bags[2], '--duration', '0.05', '--in-process', '--save', str(state))
        record(bags[3], '--duration', '0.1', '--restore', str(state))
    rest, whole = messages_from(bags[3], 0), messages_from(bags[0], 50_000_000)
    told = [message for message in rest if message not in whole]   # the state that it begins in
    assert {(message.t_ns, message.topic.rpartition('/')[2]) for message in told} == {
        (50_000_000, 'device'), (50_000_000, 'diagnostics')}
    assert [message for message in rest if message not in told] == whole
    # At tick 0 it receives t = 0, so its first setpoint is for tick 1.
    assert [tick for tick, _ in setpoints(bags[0])] == list(range(1, 100))
    assert setpoints(bags[0])[0] == (1, 0.038)
    for bag in bags:
        assert replay(Bag(bag)).is_equal


def simulated(n_ticks: int, controller: Controller) -> list[tuple[int, str, bytes]]:
    """Return (sequence, topic, data) of the leg with a controller in memory."""
    run = load_run(LEG)
    simulation, said = Simulation(idle(run), [controller]), []
    packer = packer_of(run, simulation.loop.rows.published)
    while True:
        packer.pack(simulation.t_ns, max(0, simulation.t_ns - run.step_ns), simulation.tuned)
        if simulation.ticks == n_ticks:
            packer.rare.diagnose()   # as a recorder gets it at the end of a run
        said += [(simulation.ticks, packer.topics[k].name, data)
                 for k, data in packer.all_messages()]
        if simulation.ticks == n_ticks:
            return said
        simulation.step()


def test_a_controller_in_memory_gives_the_bytes_of_one_in_the_lockstep(swayed):
    """Message by message: time, actuators, supply, leg, and what took effect when."""
    assert [(message.sequence, message.topic, message.data)
            for message in Bag(swayed).messages()] == simulated(100, Sway())


def test_a_request_beyond_the_range_is_refused_alike_in_processes_and_in_memory(domain, tmp_path):
    """Each tenth one is; the run's output has one line, and replay the same bytes."""
    bag = tmp_path / 'run' / 'bag'
    bag.parent.mkdir()
    with started(tmp_path / 'sway.log', 'tests.ros.in_millimetres'):
        with bringup(bag, '--controller', 'sway', '--duration', '0.05') as run:
            assert run.exit_code() == 0, run.errors
    line, = (line for line in run.errors.splitlines() if 'setpoint' in line)
    assert line.endswith(
        "t = 0.001 s: a controller's request, refused: hfe: setpoint position = 38 m, must be 0 "
        'to 0.1 m, the stroke; the key beyond_range: limit of the actuator limits it instead')
    assert [tick for tick, _ in setpoints(bag)] == [k for k in range(1, 50) if k % 10 != 1]
    assert replay(Bag(bag)).is_equal
    told = [message for message in Bag(bag).messages() if message.topic == event.TOPIC[0]]
    assert [(own.sequence, event.text(own.data)) for own in told] == [
        (1, line[line.index("a controller's"):])]
    with pytest.warns(UserWarning, match='hfe: setpoint position = 38 m'):
        assert [(message.sequence, message.topic, message.data) for message in Bag(bag).messages()
                if message.topic != event.TOPIC[0]] == simulated(50, InMillimetres())


def test_a_controller_that_is_not_there_is_named(domain, tmp_path):
    with bringup(tmp_path / 'bag', '--controller', 'sway', '--in-process',
                 '--join-timeout', '1') as run:
        assert run.exit_code() == 3
    assert run.errors.startswith('isa: sway: no answer before tick 0 after 1 s')
    assert not (tmp_path / 'bag').exists()


def test_a_killed_controller_ends_the_run_naming_it(domain, tmp_path):
    bag = tmp_path / 'bag'
    config = tmp_path / 'leg.yaml'
    text = Path('config/leg.yaml').read_text()
    config.write_text(text.replace('tick_timeout_s: 5.0', 'tick_timeout_s: 0.5')
                      + 'controllers: [sway]\n')
    with started(tmp_path / 'sway.log', SWAY) as sway:
        with bringup(bag, '--in-process', config=config) as run:
            wait_for(lambda: (bag / 'metadata.yaml').exists() or not run.is_running(), 'tick 0')
            sway.signal(signal.SIGKILL)
            assert run.exit_code() == 3
    assert run.errors.startswith('isa: sway: no answer to tick ')
    assert 'must come within 0.5 s' in run.errors
    assert replay(Bag(bag)).is_equal


@pytest.mark.slow
def test_a_controller_that_follows_the_clock_replays_exactly(domain, tmp_path):
    """Its setpoints take effect at the tick of their arrival, and are recorded with it."""
    bag = tmp_path / 'bag'
    with started(tmp_path / 'beside.log', BESIDE):
        with bringup(bag, '--in-process', '--real-time-factor', '1', '--duration', '3') as run:
            assert run.exit_code() == 0, run.errors
    applied = setpoints(bag)
    assert len(applied) > 20
    assert all(later[0] - tick >= 1 for (tick, _), later in zip(applied, applied[1:]))
    assert replay(Bag(bag)).is_equal


@pytest.mark.slow
def test_a_class_in_the_run_file_needs_no_node(domain, tmp_path):
    """In processes, in one and in Python: the same bytes."""
    bags = [tmp_path / name / 'bag' for name in ('several', 'one', 'python')]
    wanted = isa_ros.load('leg', changes={
        'controllers': {'sway': {'class': f'{SWAY}:Sway'}}}, duration=0.05)
    wanted.simulate().save(bags[2])
    for bag, way in zip(bags, ((), ('--in-process',))):
        bag.parent.mkdir()
        with bringup(bag, '--set', f'controllers.sway.class={SWAY}:Sway', '--duration', '0.05',
                     *way) as run:
            assert run.exit_code() == 0, run.errors
    several, one, python = (
        hashlib.sha256((bag / 'bag_0.mcap').read_bytes()).hexdigest() for bag in bags)
    assert several == one == python
    assert [tick for tick, _ in setpoints(bags[0])] == list(range(1, 50))
