"""The slider of the leg is let go at its time, in a run from the start as in a restored one."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from isa_ros.config.run_config import RunConfig
from isa_ros.config.run_file import load_run
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.run.coordinator import Coordinator
from isa_ros.run.exchange import Records
from isa_ros.run.local_run import LocalRun
from isa_ros.run.saved_state import RunState
import numpy as np
import pytest

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
    assert run.leg is not None
    start = replace(run.leg.start, foot_height_mm=100.0, release_s=release_s)
    return replace(run, leg=replace(run.leg, start=start))


def commands(tick: int, rows: Records) -> None:
    """Let the knee be pushed a little from tick 5 on, so that something moves before."""
    if tick == 5:
        rows[2] = (HAS_SETPOINT, 0, 0.0587, 0.0, 50.0, np.nan, np.nan)


def recorded(
        run: RunConfig, state: RunState | None = None,
        save_at: int = -1) -> tuple[dict[int, Sample], list[RunState]]:
    """Return the samples of a run and the state that was saved before a tick."""
    kept, states = Kept(), []

    def requests(coordinator: Coordinator) -> None:
        if coordinator.ticks == save_at:
            states.append(coordinator.save())
    LocalRun(run).simulate(TICKS, commands, kept, state=state, requests=requests)
    return kept.samples, states


def first_difference(one: dict[int, Sample], other: dict[int, Sample]) -> int:
    """Return the first sample in which two runs differ."""
    return next(k for k in sorted(one) if one[k] != other[k])


@pytest.mark.parametrize('release_s', [0.02, 0.0194])
def test_the_slider_is_held_until_its_release_and_not_a_tick_longer(release_s):
    """Sample 20, of the release, is that of a leg that is held on; sample 21 no longer is."""
    released, _ = recorded(leg(release_s))
    held, _ = recorded(leg(NEVER_S))
    assert first_difference(released, held) == RELEASE + 1


@pytest.mark.parametrize('save_at', [RELEASE - 7, RELEASE, RELEASE + 1])
def test_a_restored_run_releases_the_slider_when_the_whole_one_does(save_at):
    """The state holds the time: before, at and after the release the samples go on alike."""
    whole, (state,) = recorded(leg(0.02), save_at=save_at)
    rest, _ = recorded(leg(0.02), state=state)
    assert sorted(rest) == list(range(save_at, TICKS + 1))
    assert {k: rest[k] for k in rest if k > save_at} == {
        k: whole[k] for k in rest if k > save_at}
