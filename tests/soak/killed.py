"""
Long runs in processes that are killed at a random time: their bags must be usable.

The victim is random as well: the bring-up with all its processes, or one participant. Time
and victim follow from the seed; the moment within a tick depends on the host.
"""

from collections.abc import Iterator, Sequence
import os
from pathlib import Path
import random
import shutil
import signal
import time
from typing import NamedTuple

from isa_ros.bag.reader import Bag
from rclpy.node import Node
from tests.ros.faults import assert_replays, ClockListener, ONE_SECOND_NS
from tests.ros.started import bringup, DEADLINE_S, is_alive, Started, wait_for

BRING_UP = 'bring-up'
FIRST_S = 1.0  # before it a bag may have no chunk yet
LOOK_S = 0.02


class Killed(NamedTuple):
    """One run that was killed."""

    victim: str
    t_s: float
    """Simulated time of the kill, random."""
    lost_s: float
    """Simulated time that was published on `/clock` but is not in the bag."""
    is_whole: bool

    def __str__(self) -> str:
        return (f'{self.victim} killed at t = {self.t_s:.3f} s: {self.lost_s:.3f} s lost, bag '
                f'{"whole" if self.is_whole else "cut short"}, replays')


def killed_runs(
        observer: Node, config: Path, options: Sequence[str], seconds: float, runs: int,
        seed: int, directory: Path) -> Iterator[Killed]:
    """
    Run ``config``, kill it within ``seconds`` of simulation, examine; ``runs`` times over.

    A run has no end of its own: on a busy host it could be over before the kill.
    """
    draw = random.Random(seed)
    for number in range(runs):
        bag = directory / f'run_{number}' / 'bag'
        bag.parent.mkdir()
        with bringup(bag, *options, config=config) as run:
            yield killed_run(observer, run, bag, draw.uniform(FIRST_S, seconds), draw)
        shutil.rmtree(bag)


def killed_run(
        observer: Node, run: Started, bag: Path, kill_s: float, draw: random.Random) -> Killed:
    """Kill a process of ``run`` at ``kill_s`` and examine the bag."""
    clock = ClockListener(observer)
    wait_for_time(clock, run, kill_s)
    children = run.children()
    victim = draw.choice([BRING_UP, *sorted(children)])
    os.kill(children.get(victim, run.pid), signal.SIGKILL)
    seen_ns = clock.latest_ns()
    code = run.exit_code()
    assert code == (-signal.SIGKILL if victim == BRING_UP else 3), run.errors
    assert victim == BRING_UP or f'isa: {victim}: its process' in run.errors
    wait_for(lambda: not any(map(is_alive, [run.pid, *children.values()])), 'their end')
    seen_ns = max(seen_ns, clock.latest_ns())
    read = Bag(bag)
    assert read.is_whole == (victim != BRING_UP)
    assert read.end_ns is not None and seen_ns - read.end_ns <= ONE_SECOND_NS
    assert_replays(bag, read.is_whole)
    lost_s = max(0, seen_ns - read.end_ns) / ONE_SECOND_NS
    return Killed(victim, kill_s, lost_s, read.is_whole)


def wait_for_time(clock: ClockListener, run: Started, seconds: float) -> None:
    """Wait until the run has reached that time; any progress restarts the deadline."""
    reached, deadline = 0, time.monotonic() + DEADLINE_S
    while reached < seconds * ONE_SECOND_NS:
        assert not run.has_ended_within(LOOK_S), run.errors
        if (now := clock.latest_ns()) > reached:
            reached, deadline = now, time.monotonic() + DEADLINE_S
        assert time.monotonic() < deadline, f'{seconds:.3f} s, stands at {reached} ns'
