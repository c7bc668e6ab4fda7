"""The recorder's faults: the message has the file, and the written part can be used."""

from collections.abc import Iterator
import os
from pathlib import Path
import re
import shutil
import subprocess

import pytest
from tests.ros.faults import assert_replays, Fault, wait_for_chunk, wait_for_tick_0
from tests.ros.started import bringup, DEADLINE_S, RIG

pytestmark = [pytest.mark.ros, pytest.mark.slow]
MEGABYTE = 1_000_000


def mount(*arguments: str) -> None:
    """Mount, or skip the test where this is not allowed."""
    done = subprocess.run(
        ['mount', *arguments], capture_output=True, text=True, timeout=DEADLINE_S, check=False)
    if done.returncode:
        pytest.skip(f'mounting needs root: {done.stderr.strip()}')


@pytest.fixture
def small_disk(tmp_path) -> Iterator[Path]:
    """Return a directory on a disk of 2 MB."""
    disk = tmp_path / 'disk'
    disk.mkdir()
    mount('-t', 'tmpfs', '-o', f'size={2 * MEGABYTE}', 'tmpfs', str(disk))
    yield disk
    subprocess.run(['umount', str(disk)], timeout=DEADLINE_S, check=True)


@pytest.fixture
def read_only_disk(tmp_path) -> Iterator[Path]:
    """Return a directory that root cannot write to either."""
    disk = tmp_path / 'read_only'
    disk.mkdir()
    mount('-t', 'tmpfs', '-o', 'ro', 'tmpfs', str(disk))
    yield disk
    subprocess.run(['umount', str(disk)], timeout=DEADLINE_S, check=True)


def test_full_disk_ends_the_run_with_a_whole_bag(domain, tmp_path, small_disk):
    """The chunk that did not fit is lost: 500 ticks of 0.5 s."""
    bag = small_disk / 'bag'
    with bringup(bag, config=RIG, log=tmp_path / 'log') as run:
        wait_for_chunk(bag, run)
        fault = Fault(run, bag)
        ended = fault.ended(DEADLINE_S)
    assert ended.exit_code == 3
    assert ended.line == f'isa: {bag}/bag_0.mcap: cannot record, No space left on device'
    copy = tmp_path / 'bag'
    shutil.copytree(bag, copy)
    assert sorted(path.name for path in copy.iterdir()) == ['bag_0.mcap', 'metadata.yaml']
    assert (assert_replays(copy) + 1) % 500 == 0


def test_a_disk_that_is_full_at_the_start_ends_the_run(domain, tmp_path, small_disk):
    """The directory is not a bag and is not accepted as one."""
    (small_disk / 'others').write_bytes(bytes(2 * MEGABYTE - 10_000))
    bag = small_disk / 'bag'
    with bringup(bag, config=RIG, log=tmp_path / 'log') as run:
        assert run.exit_code() == 3
    line, = run.errors.splitlines()
    assert line.startswith(f'isa: {bag}/') and line.endswith(
        'cannot record, No space left on device')


def test_a_disk_that_cannot_be_written_is_refused_before_anything_starts(
        domain, tmp_path, read_only_disk):
    bag = read_only_disk / 'bag'
    with bringup(bag, config=RIG, log=tmp_path / 'log') as run:
        assert run.exit_code() == 2
    assert run.errors == f'isa: {bag}: cannot be created, {read_only_disk} is not writable\n'


def test_a_path_below_a_file_is_refused_before_anything_starts(domain, tmp_path):
    (tmp_path / 'file').write_text('mine')
    bag = tmp_path / 'file' / 'bag'
    with bringup(bag, config=RIG, log=tmp_path / 'log') as run:
        assert run.exit_code() == 2
    assert run.errors == f'isa: {bag}: cannot be created, {tmp_path / "file"} is not writable\n'
    assert (tmp_path / 'file').read_text() == 'mine'


def test_a_directory_that_vanishes_ends_the_run(domain, tmp_path):
    """The open file can still be written, but never be read."""
    bag = tmp_path / 'bag'
    with bringup(bag, config=RIG, log=tmp_path / 'log') as run:
        wait_for_tick_0(bag, run)
        fault = Fault(run, bag)
        shutil.rmtree(bag)
        ended = fault.ended(DEADLINE_S)
    assert ended.exit_code == 3
    assert ended.line == (
        f'isa: {bag}/bag_0.mcap: cannot record, the file was removed or moved during the run')
    assert not bag.exists()


def test_a_truncated_file_ends_the_run(domain, tmp_path):
    """What was recorded before is lost: never exit code 0. The file may grow until the check."""
    bag = tmp_path / 'bag'
    with bringup(bag, config=RIG, log=tmp_path / 'log') as run:
        wait_for_chunk(bag, run)
        fault = Fault(run, bag)
        os.truncate(bag / 'bag_0.mcap', 1000)
        ended = fault.ended(DEADLINE_S)
    assert ended.exit_code == 3
    said = re.fullmatch(
        rf'isa: {re.escape(str(bag))}/bag_0.mcap: cannot record, the file has (\d+) bytes instead '
        r'of the (\d+) written: it was changed during the run', ended.line)
    assert said and 1000 <= int(said[1]) < int(said[2])
