"""Runs of the leg in processes: equal bytes, and every way a run may end early."""

import hashlib
import os
from pathlib import Path
import signal

from isa_ros.bag.reader import Bag
import pytest
from tests.ros.started import bringup, DROP, is_alive, LEG, Started, wait_for

pytestmark = pytest.mark.ros


def sha256(bag: Path) -> str:
    return hashlib.sha256((bag / f'{bag.name}_0.mcap').read_bytes()).hexdigest()


def wait_for_tick_0(bag: Path, run: Started) -> None:
    """Wait until the bag exists: all have answered the hello."""
    wait_for(lambda: (bag / 'metadata.yaml').exists() or not run.is_running(), 'tick 0')
    assert run.is_running(), run.errors


def read_sequences(bag: Path) -> list[int]:
    """Return the ticks of a bag that must be whole."""
    read = Bag(bag)
    assert read.is_whole
    return [tick.sequence for tick in read.ticks()]


def with_timeout(path: Path, seconds: float) -> Path:
    """Return the leg's configuration with another tick timeout."""
    text = LEG.read_text()
    assert 'tick_timeout_s: 5.0' in text
    path.write_text(text.replace('tick_timeout_s: 5.0', f'tick_timeout_s: {seconds}'))
    return path


def test_processes_and_one_process_give_equal_files(domain, tmp_path):
    bags = [tmp_path / 'several' / 'bag', tmp_path / 'one' / 'bag']
    for bag, options in zip(bags, [(), ('--in-process',)]):
        bag.parent.mkdir()
        with bringup(bag, '--scenario', str(DROP), '--duration', '0.3', *options) as run:
            assert run.exit_code() == 0, run.errors
    assert read_sequences(bags[0]) == list(range(301))
    assert sha256(bags[0]) == sha256(bags[1])


def test_killed_actuator_ends_the_run_naming_it(domain, tmp_path):
    bag = tmp_path / 'bag'
    with bringup(bag) as run:
        wait_for_tick_0(bag, run)
        children = run.children()
        assert sorted(children) == ['haa', 'hfe', 'kfe']
        os.kill(children['hfe'], signal.SIGKILL)
        assert run.exit_code() == 3
    assert f'hfe: its process {children["hfe"]} was ended by SIGKILL in tick' in run.errors
    assert len(run.errors.splitlines()) == 1
    assert not any(is_alive(pid) for pid in children.values())
    sequences = read_sequences(bag)
    assert sequences == list(range(len(sequences)))


def test_late_actuator_is_named_with_tick_and_time(domain, tmp_path):
    """A stopped process answers nothing; its state is unknown, so only time can tell."""
    bag = tmp_path / 'bag'
    with bringup(bag, config=with_timeout(tmp_path / 'leg.yaml', 0.5)) as run:
        wait_for_tick_0(bag, run)
        children = run.children()
        os.kill(children['kfe'], signal.SIGSTOP)
        assert run.exit_code() == 3
    last = read_sequences(bag)[-1]
    assert f'kfe: no answer to tick {last} after 0.5 s' in run.errors
    assert not any(is_alive(pid) for pid in children.values())


def test_stopped_and_continued_actuator_changes_nothing(domain, tmp_path):
    """A participant that is late, but within its timeout, gives the same bytes."""
    bags = [tmp_path / 'slow' / 'bag', tmp_path / 'one' / 'bag']
    options = '--scenario', str(DROP), '--duration', '0.3'
    for bag in bags:
        bag.parent.mkdir()
    with bringup(bags[0], *options, '--real-time-factor', '0.2') as run:
        wait_for_tick_0(bags[0], run)
        pid = run.children()['haa']
        os.kill(pid, signal.SIGSTOP)
        wait_for(lambda: ') T ' in Path(f'/proc/{pid}/stat').read_text(), 'the stop')
        os.kill(pid, signal.SIGCONT)
        assert run.exit_code() == 0, run.errors
    with bringup(bags[1], *options, '--in-process') as run:
        assert run.exit_code() == 0, run.errors
    assert sha256(bags[0]) == sha256(bags[1])


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize('options', [(), ('--in-process',)])
def test_signal_ends_cleanly(domain, tmp_path, number, options):
    bag = tmp_path / 'bag'
    with bringup(bag, *options) as run:
        wait_for_tick_0(bag, run)
        children = run.children()
        run.signal(number)
        assert run.exit_code() == 130
    assert 'stopped at t = ' in run.errors
    assert 'Traceback' not in run.errors
    assert not any(is_alive(pid) for pid in children.values())
    sequences = read_sequences(bag)
    assert sequences == list(range(len(sequences)))


def test_children_do_not_outlive_a_killed_coordinator(domain, tmp_path):
    bag = tmp_path / 'bag'
    with bringup(bag) as run:
        wait_for_tick_0(bag, run)
        children = run.children()
        run.signal(signal.SIGKILL)
        assert run.exit_code() == -signal.SIGKILL
    wait_for(lambda: not any(is_alive(pid) for pid in children.values()), 'their end')


def test_existing_output_is_refused_before_anything_starts(domain, tmp_path):
    bag = tmp_path / 'bag'
    bag.mkdir()
    (bag / 'notes.txt').write_text('mine')
    for options, reason in (((), 'exists, must not'), (('--overwrite',), 'holds no bag')):
        with bringup(bag, *options) as run:
            assert run.exit_code() == 2
        assert reason in run.errors
    assert [path.name for path in bag.iterdir()] == ['notes.txt']
