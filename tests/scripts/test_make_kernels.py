"""The script that makes the libraries of kernels."""

from concurrent.futures import Future, ProcessPoolExecutor
import io
from multiprocessing import get_context
from types import SimpleNamespace

from isa_ros.core.bound import run_rounds
from isa_ros.core.elf import symbols
from isa_ros.core.objects import own_target, TARGETS
import pytest
from scripts import make_kernels
from scripts.kernel_rehearsal import ALONE, rehearsals, rehearse, Wanted
from scripts.make_kernels import link, Made, main, make, Making, PERIOD_S, Progress

OWN = own_target()


def rehearsed(name):
    """Return what a rehearsal asks for, in a process that has asked for nothing."""
    with ProcessPoolExecutor(1, get_context('spawn')) as process:
        return process.submit(rehearse, name).result()


@pytest.fixture(scope='module')
def alone():
    """Return what actuators without a run ask for, by name."""
    return {wanted.name: wanted for wanted in rehearsed(ALONE)}


def test_every_configuration_is_rehearsed():
    names = rehearsals()
    assert names[0] == ALONE and {'leg.yaml', 'crane.yaml', 'quadruped.yaml'} < set(names)


def test_actuators_ask_for_their_tick(alone):
    tick, divide = alone['group_tick'], alone['divide']
    assert (tick.is_called, divide.is_called) == (False, True)
    assert tick.size > 150 > divide.size > 3
    assert tick.entry.symbol == tick.symbol
    assert tick.entry.kernel.__module__ == 'isa_ros.actuator.ticking'


@pytest.mark.slow
def test_a_leg_asks_for_all_that_its_run_needs():
    found = rehearsed('leg.yaml')
    names = {(wanted.name, wanted.is_called) for wanted in found}
    assert {('leg_terms', True), ('fill_ports', False), ('record', False), ('watch', False),
            ('keep', False), ('answer_ticks', False), ('receive_answers', False),
            ('append', True), ('run_rounds', False)} <= names
    rounds, = (wanted for wanted in found if wanted.name == 'run_rounds')
    assert rounds.entry.kernel is run_rounds
    assert len({wanted.symbol for wanted in found}) == len(found)


@pytest.mark.slow
def test_controllers_of_scenarios_ask_for_their_kernels():
    """The trot swings its feet after half a second."""
    names = {wanted.name for wanted in rehearsed('quadruped.yaml')}
    assert {'update_legs', 'share_wrench', 'limit_forces', 'swing_feet'} <= names


def test_objects_of_an_entry(alone):
    wanted = alone['oil_stiffness']
    made = make(wanted, list(TARGETS))
    assert made.refused == {} and list(made.objects) == list(TARGETS)
    for code in made.objects.values():
        seen = {symbol.name for symbol in symbols(code) if not symbol.is_local}
        assert {wanted.symbol, f'{wanted.symbol}_result'} <= seen


def test_a_target_that_cannot_have_an_entry_says_why(alone, monkeypatch):
    def refuse(entries, target):
        if target.name == 'x86-64':
            raise make_kernels.ConfigError('object of merge_0: undefined sin, must have none')
        return b'code'
    monkeypatch.setattr(make_kernels, 'object_of', refuse)
    assert make(alone['merge'], ['x86-64-v3', 'x86-64']) == Made(
        {'x86-64-v3': b'code'}, {'x86-64': 'undefined sin, must have none'})


def test_progress_says_how_many_and_the_time_left():
    times, said = iter([100.0, 100.0 + PERIOD_S, 106.0, 106.1, 108.0]), io.StringIO()
    progress = Progress(said, lambda: next(times))
    progress.left, progress.total = 40, 5
    progress.show(['tick'])
    progress.made, progress.done, progress.left = 2, 30, 10
    progress.show(['tick', 'merge'])
    progress.show(['merge'])
    progress.made = 5
    progress.show([], is_last=True)
    assert said.getvalue().splitlines() == [
        'kernels: 0 of 5, 2 s, beginning: tick', 'kernels: 2 of 5, 6 s, 2 s left: tick, merge',
        'kernels: 5 of 5, 8 s, finished']


class Now:
    """Futures of work that is done at once."""

    def __init__(self, processes, context):
        self.processes = processes

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def submit(self, work, *arguments):
        future = Future()
        future.set_result(work(*arguments))
        return future


def test_the_largest_are_made_first_and_each_once(monkeypatch):
    order = []

    def rehearsed(name):
        order.append(name)
        return [Wanted('m', name, None, False, symbol, size)
                for symbol, size in {'leg': [('a', 9), ('b', 90)], 'arm': [('b', 90), ('c', 20)],
                                     ALONE: [('tick', 200)]}[name]]

    def made(wanted, targets):
        order.append(wanted.symbol)
        return Made({targets[0]: wanted.symbol.encode()}, {})
    monkeypatch.setattr(make_kernels, 'rehearsals', lambda: ['leg', ALONE, 'arm'])
    monkeypatch.setattr(make_kernels, 'rehearse', rehearsed)
    monkeypatch.setattr(make_kernels, 'make', made)
    monkeypatch.setattr(make_kernels, 'ProcessPoolExecutor', Now)
    monkeypatch.setattr(
        make_kernels, 'wait', lambda futures, *_: SimpleNamespace(done=list(futures)))
    said = io.StringIO()
    progress = Progress(said)
    making = Making(['v3'], progress)
    making.run(1)
    assert (progress.left, progress.done) == (0, 3 * 30 + 200 + 90 + 20 + 9)
    assert order == [ALONE, 'tick', 'arm', 'b', 'leg', 'c', 'a']
    assert {symbol: own.objects for symbol, own in making.made.items()} == {
        symbol: {'v3': symbol.encode()} for symbol in ('tick', 'b', 'c', 'a')}
    assert said.getvalue().splitlines()[-1] == 'kernels: 4 of 4, 0 s, finished'


def test_a_library_of_what_was_made(tmp_path, alone):
    several = [make(alone[name], [OWN.name]) for name in ('merge', 'oil_stiffness')]
    line = link(OWN, [*several, Made({}, {OWN.name: 'undefined sin'})], tmp_path)
    path = tmp_path / f'{OWN.name}.so'
    assert line == f'{path}: 2 of 3 kernels, {path.stat().st_size / 2 ** 20:.1f} MiB'
    assert [own.name for own in tmp_path.iterdir()] == [path.name]


def test_without_a_linker_a_target_is_left_out(tmp_path, monkeypatch):
    monkeypatch.setattr(make_kernels.shutil, 'which', lambda name: None)
    other = TARGETS['aarch64' if OWN.name != 'aarch64' else 'x86-64']
    linker = 'aarch64-linux-gnu-ld' if other.name == 'aarch64' else 'x86_64-linux-gnu-ld'
    assert link(other, [], tmp_path) == (
        f'{other.name}: left out, there is no {linker} to link it with')
    assert link(OWN, [], tmp_path) == f'{OWN.name}: left out, there is no cc to link it with'
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_target_is_refused(capsys):
    with pytest.raises(SystemExit) as ended:
        main(['z80'])
    assert ended.value.code == 2
    assert 'target z80: unknown, valid: x86-64-v3, x86-64, aarch64' in capsys.readouterr().err
