"""The slider of the leg is let go at its time, in a run from the start as in a restored one."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import COMMAND, Records
from isa_ros.run.local_run import LocalRun
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
from isa_ros.tick.source import ScheduledSource
import numpy as np
import pytest
from tests.sheets import setpoint

CONFIG = Path(__file__).parents[2] / 'config'
NEVER_S = 1e6
RELEASE = 20  # tick
TICKS = 30

Sample = list[tuple[int, bytes]]


class Kept:
    """A recorder that keeps every sample by its sequence number."""

    def __init__(self) -> None:
        self.samples: dict[int, Sample] = {}

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Keep a sample."""
        self.samples[sequence] = list(messages)


def leg(release_s: float) -> RunConfig:
    """Return the shipped leg, hanging 0.1 m above the ground until its release."""
    run = load_run(CONFIG / 'leg.yaml')
    start = replace(run.leg.start, foot_height_mm=100.0, release_s=release_s)
    return run.with_body(replace(run.leg, start=start))


def commands(tick: int, rows: Records) -> None:
    """Let the knee be pushed a little from tick 5 on, so that something moves before."""
    if tick == 5:
        rows[2] = setpoint(position=0.0587, effort=50.0)


def recorded(run: RunConfig, state: RunState | None = None) -> dict[int, Sample]:
    """Return the samples of a run."""
    kept = Kept()
    LocalRun(run).simulate(TICKS, ScheduledSource(commands), kept, state=state)
    return kept.samples


def state_before(run: RunConfig, tick: int) -> RunState:
    """Return the state of a run before a tick."""
    simulation = Simulation(idle(run))
    rows = np.zeros(len(run.actuators), COMMAND)
    while simulation.ticks < tick:
        rows['kinds'] = 0
        commands(simulation.ticks, rows)
        simulation.step(rows)
    return simulation.state()


def first_difference(one: dict[int, Sample], other: dict[int, Sample]) -> int:
    """Return the first sample in which two runs differ."""
    return next(k for k in sorted(one) if one[k] != other[k])


@pytest.mark.parametrize('release_s', [0.02, 0.0194])
def test_the_slider_is_held_until_its_release_and_not_a_tick_longer(release_s):
    """Sample 20, of the release, is that of a leg that is held on; sample 21 no longer is."""
    released, held = recorded(leg(release_s)), recorded(leg(NEVER_S))
    assert first_difference(released, held) == RELEASE + 1


@pytest.mark.parametrize('save_at', [RELEASE - 7, RELEASE, RELEASE + 1])
def test_a_restored_run_releases_the_slider_when_the_whole_one_does(save_at):
    """The state holds the time: before, at and after the release the samples go on alike."""
    whole = recorded(leg(0.02))
    rest = recorded(leg(0.02), state_before(leg(0.02), save_at))
    assert sorted(rest) == list(range(save_at, TICKS + 1))
    assert {k: rest[k] for k in rest if k > save_at} == {
        k: whole[k] for k in rest if k > save_at}
