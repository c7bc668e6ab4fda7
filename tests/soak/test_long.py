"""Soaks of minutes to hours, as `python -m tests.soak` runs them: `./isa test --long`."""

import pytest
from tests.ros.domains import held_domain, observing
from tests.ros.started import RIG
from tests.soak.killed import BRING_UP, killed_runs
from tests.soak.long_run import long_run

pytestmark = [pytest.mark.ros, pytest.mark.long]
RUNS, SECONDS, SEED = 10, 600.0, 1
LONG_RUN_S = 3600.0


@pytest.mark.parametrize('options', [(), ('--in-process',)], ids=['processes', 'one process'])
def test_long_runs_that_are_killed_leave_bags_that_replay(tmp_path, monkeypatch, options):
    """Each at a random time of its ten minutes."""
    victims = set()
    with held_domain(monkeypatch), observing(monkeypatch) as observer:
        for killed in killed_runs(observer, RIG, options, SECONDS, RUNS, SEED, tmp_path):
            print(killed)
            victims.add(killed.victim)
    assert victims == ({BRING_UP} if options else {BRING_UP, 'rotor'})


def test_memory_is_flat_and_times_agree_for_an_hour(tmp_path, monkeypatch):
    """
    An hour of simulation; a message kept per tick would be 3 600 000 of a hundred bytes and more.

    Python's own arenas come and go by a megabyte, however long the run.
    """
    with held_domain(monkeypatch):
        run = long_run(tmp_path, LONG_RUN_S)
    print(run)
    assert run.ticks == round(LONG_RUN_S * 1000)
    assert run.most_mb - run.least_mb < 2.0
