"""The script that makes the libraries of kernels."""

from concurrent.futures import Future, ProcessPoolExecutor
from ctypes import CDLL
import io
from multiprocessing import get_context
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
from types import SimpleNamespace
import warnings

from isa_ros.core.bound import run_rounds
from isa_ros.core.elf import symbols
from isa_ros.core.kernel_library import address_in
from isa_ros.core.objects import own_target, TARGETS
import pytest
from scripts import kernel_rehearsal, make_kernels
from scripts.kernel_objects import Objects
from scripts.kernel_rehearsal import ALONE, rehearsals, rehearse, WantedKernel
from scripts.make_kernels import KernelProgress, link, lower_long, main, make, Making, PERIOD_S
from tests.text.terminal import Terminal

ROOT = Path(__file__).parents[2]
OWN = own_target()


@pytest.fixture(scope='module')
def objects(tmp_path_factory):
    """Return where objects of all targets are made."""
    return Objects(tmp_path_factory.mktemp('objects'), tuple(TARGETS))


def in_lowering(work, *arguments):
    """Return what work gives in a process that lowers kernels and has asked for nothing."""
    with ProcessPoolExecutor(1, get_context('spawn'), initializer=lower_long) as process:
        return process.submit(work, *arguments).result()


def rehearsed(name, objects):
    """Return what a rehearsal asks for."""
    return in_lowering(rehearse, name, objects._replace(targets=()))


@pytest.fixture(scope='module')
def alone(objects):
    """Return what actuators without a run ask for, by name."""
    return {wanted.name: wanted for wanted in rehearsed(ALONE, objects)}


def test_a_rehearsal_is_silent(monkeypatch, recwarn):
    """What shipped runs warn of is nothing of the user's."""
    monkeypatch.setattr(kernel_rehearsal, '_ticks_of', lambda name: warnings.warn(name))
    kernel_rehearsal._run('leg.yaml')
    assert not recwarn.list


def test_every_configuration_is_rehearsed():
    names = rehearsals()
    assert names[0] == ALONE and {'leg.yaml', 'crane.yaml', 'quadruped.yaml'} < set(names)


def test_actuators_ask_for_their_tick(alone):
    tick, divide = alone['group_tick'], alone['divide']
    assert (tick.is_called, divide.is_called) == (False, True)
    assert tick.size > 150 > divide.size > 3
    assert tick.entry.symbol == tick.symbol
    assert tick.entry.kernel.__module__ == 'isa_ros.actuator.ticking'
    assert in_lowering(make_kernels.tick) == tick


def test_what_a_rehearsal_calls_is_made(alone, objects):
    """Once: it needs no second time, and bound kernels are left to others."""
    path = objects.path(alone['divide'].symbol, OWN.name)
    assert path.read_bytes()[:4] == b'\x7fELF'
    assert not objects.path(alone['group_tick'].symbol, OWN.name).exists()
    made = path.stat().st_mtime_ns
    assert make(alone['divide'], objects._replace(targets=())) == {}
    assert path.stat().st_mtime_ns == made


@pytest.mark.slow
def test_a_leg_asks_for_all_that_its_run_needs(objects):
    found = rehearsed('leg.yaml', objects)
    names = {(wanted.name, wanted.is_called) for wanted in found}
    assert {('leg_terms', True), ('fill_ports', False), ('record', False), ('watch', False),
            ('keep', False), ('answer_ticks', False), ('receive_answers', False),
            ('append', True), ('run_rounds', False)} <= names
    rounds, = (wanted for wanted in found if wanted.name == 'run_rounds')
    assert rounds.entry.kernel is run_rounds
    assert len({wanted.symbol for wanted in found}) == len(found)


@pytest.mark.slow
def test_controllers_of_scenarios_ask_for_their_kernels(objects):
    names = {wanted.name for wanted in rehearsed('quadruped.yaml', objects)}
    assert {'update_legs', 'share', 'swing'} <= names


@pytest.mark.slow
def test_circuits_ask_for_their_kernels(objects):
    """They run, as zeros would be refused."""
    names = {wanted.name for wanted in rehearsed('crane_circuit.yaml', objects)}
    assert {'advance', 'fill_manifolds', 'fill_pressures', 'show_rows'} <= names


def test_objects_of_an_entry(alone, objects):
    wanted = alone['oil_stiffness']
    assert in_lowering(make, wanted, objects) == {}
    for name in TARGETS:
        code = objects.path(wanted.symbol, name).read_bytes()
        seen = {symbol.name for symbol in symbols(code) if not symbol.is_local}
        assert {wanted.symbol, f'{wanted.symbol}_result'} <= seen


def test_progress_says_how_many_and_the_time_left():
    times, said = iter([100.0, 100.0 + PERIOD_S, 106.0, 106.1, 108.0]), io.StringIO()
    progress = KernelProgress(said, lambda: next(times))
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


@pytest.mark.parametrize(('done', 'rest'), [(0, 'beginning'), (39, 'beginning'), (40, '3 s left')])
def test_no_time_is_foretold_by_the_first_jobs(done, rest):
    """They compile what the others share, so that their sizes foretell a multiple of the time."""
    times, said = iter([50.0, 52.0]), io.StringIO()
    progress = KernelProgress(said, lambda: next(times))
    progress.total, progress.done, progress.left = 7, done, 100 - done
    progress.show(['tick'])
    assert said.getvalue() == f'kernels: 0 of 7, 2 s, {rest}: tick\n'


def test_progress_on_a_terminal_is_one_line():
    times, said = iter([0.0, 2.0, 4.0, 5.0]), Terminal()
    progress = KernelProgress(said, lambda: next(times))
    progress.total, progress.left, progress.done, progress.made = 3, 20, 40, 2
    progress.show(['tick'])
    progress.show(['merge'])
    progress.show([], is_last=True)
    assert [text.replace('\033[K', '') for text in said.getvalue().split('\r')] == [
        '', 'kernels: 2 of 3, 2 s, 1 s left: tick', 'kernels: 2 of 3, 4 s, 2 s left: merge',
        'kernels: 2 of 3, 5 s, finished\n']


@pytest.mark.slow
def test_ctrl_c_ends_all_at_once(tmp_path):
    """One line, and no process or object is left; in the background of a script it is ignored."""
    making = subprocess.Popen(
        [sys.executable, '-m', 'scripts.make_kernels', '--out', str(tmp_path)], cwd=ROOT,
        env={**os.environ, 'PYTHONPATH': str(ROOT)}, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    assert making.stdout is not None
    assert re.match(r'kernels: 0 of \d+, ', making.stdout.readline())
    os.killpg(making.pid, signal.SIGINT)
    said, errors = making.communicate(timeout=60.0)     # until all have closed the pipes
    assert (making.returncode, errors) == (
        130, '\nkernels: interrupted, they are compiled at their first use\n')
    assert list(tmp_path.iterdir()) == []


class Now:
    """Futures of work that is done at once."""

    def __init__(self, processes, context, initializer):
        assert initializer is lower_long
        assert context.get_start_method() == 'fork'     # numba is imported once

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def submit(self, work, *arguments):
        future = Future()
        future.set_result(work(*arguments))
        return future


def test_the_largest_are_made_first_and_each_once(monkeypatch, tmp_path):
    order = []
    objects = Objects(tmp_path, ('v3',))

    def wanted(symbol, size):
        return WantedKernel('m', symbol, None, False, symbol, size)

    def rehearsed(name, own):
        order.append((name, own))
        return [wanted(*each) for each in {
            'leg': [('a', 9), ('b', 90)], 'arm': [('b', 90), ('c', 20)],
            ALONE: [('tick', 200), ('d', 8)]}[name]]

    def made(own, given):
        order.append((own.symbol, given))
        return {'v3': 'undefined sin'} if own.symbol == 'b' else {}
    monkeypatch.setattr(make_kernels, 'declare', lambda: order.append('declared'))
    monkeypatch.setattr(make_kernels, 'tick', lambda: wanted('tick', 200))
    monkeypatch.setattr(make_kernels, 'rehearsals', lambda: ['leg', ALONE, 'arm'])
    monkeypatch.setattr(make_kernels, 'rehearse', rehearsed)
    monkeypatch.setattr(make_kernels, 'make', made)
    monkeypatch.setattr(make_kernels, 'ProcessPoolExecutor', Now)
    monkeypatch.setattr(
        make_kernels, 'wait', lambda futures, *_: SimpleNamespace(done=list(futures)))
    said = io.StringIO()
    progress = KernelProgress(said)
    making = Making(objects, progress)
    assert progress.total == 1
    making.run(1)
    assert (progress.left, progress.done) == (0, 3 * 30 + 200 + 90 + 20 + 9 + 8)
    assert order == ['declared', *((name, objects) for name in (
        'tick', ALONE, 'arm', 'b', 'leg', 'c', 'a', 'd'))]
    assert making.refused == {
        'tick': {}, 'd': {}, 'b': {'v3': 'undefined sin'}, 'c': {}, 'a': {}}
    assert said.getvalue().splitlines()[-1] == 'kernels: 5 of 5, 0 s, finished'


def test_a_library_of_what_was_made(tmp_path, alone, objects):
    names = ('merge', 'oil_stiffness', 'group_tick')    # the last one is not made
    for name in names[:2]:
        assert in_lowering(make, alone[name], objects) == {}
    line = link(OWN, [alone[name].symbol for name in names], objects, tmp_path)
    path = tmp_path / f'{OWN.name}.so'
    assert line == f'{path}: 2 of 3 kernels, {path.stat().st_size / 2 ** 20:.1f} MiB'
    assert [own.name for own in tmp_path.iterdir()] == [path.name]
    assert address_in(CDLL(str(path)), alone['merge'].symbol)


def test_without_a_linker_a_target_is_left_out(tmp_path, monkeypatch, objects):
    monkeypatch.setattr(make_kernels.shutil, 'which', lambda name: None)
    other = TARGETS['aarch64' if OWN.name != 'aarch64' else 'x86-64']
    linker = 'aarch64-linux-gnu-ld' if other.name == 'aarch64' else 'x86_64-linux-gnu-ld'
    assert link(other, [], objects, tmp_path) == (
        f'{other.name}: left out, there is no {linker} to link it with')
    assert link(OWN, [], objects, tmp_path) == (
        f'{OWN.name}: left out, there is no cc to link it with')
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_target_is_refused(capsys):
    with pytest.raises(SystemExit) as ended:
        main(['z80'])
    assert ended.value.code == 2
    assert 'target z80: unknown, valid: x86-64-v3, x86-64, aarch64' in capsys.readouterr().err


@pytest.fixture
def interruptible():
    """Take Ctrl-C as at a terminal, also in the background of a script."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_a_ctrl_c_while_a_process_starts_is_not_lost(interruptible):
    """It is raised here; a process that was started meanwhile never gets one."""
    with pytest.raises(KeyboardInterrupt):
        with make_kernels._without_interrupts():
            child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(60)'])
            child.send_signal(signal.SIGINT)
            os.kill(os.getpid(), signal.SIGINT)
            with pytest.raises(subprocess.TimeoutExpired):
                child.wait(1.0)
    child.kill()
    assert child.wait() == -signal.SIGKILL
