"""The short forms of the soak tests; test_long.py has the long ones."""

import pytest
from tests.ros.domains import held_domain, observing
from tests.ros.started import RIG
from tests.soak.killed import BRING_UP, killed_runs
from tests.soak.long_run import long_run

pytestmark = [pytest.mark.ros, pytest.mark.slow]
SECONDS = 60.0


def test_runs_that_are_killed_leave_bags_that_replay(tmp_path, monkeypatch):
    """Killed according to the seed: the bring-up, its actuator, and the bring-up again."""
    with held_domain(monkeypatch), observing(monkeypatch) as observer:
        runs = list(killed_runs(observer, RIG, (), 5.0, 3, 4, tmp_path))
    for killed in runs:
        print(killed)
    assert {killed.victim for killed in runs} == {BRING_UP, 'rotor'}


def test_memory_is_flat_and_times_agree(tmp_path, monkeypatch):
    """
    A minute of simulation.

    Python's own arenas come and go by a megabyte, which on a minute is a slope of tens of
    megabytes an hour; a message kept per tick would be 60 000 of a hundred bytes and more.
    """
    with held_domain(monkeypatch):
        run = long_run(tmp_path, SECONDS)
    print(run)
    assert run.ticks == round(SECONDS * 1000)
    assert run.most_mb - run.least_mb < 2.0
