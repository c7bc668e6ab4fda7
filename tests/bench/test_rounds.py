"""The order of the runs, and the handling of those that fail."""

from itertools import pairwise
from statistics import mean

from isa_ros.bench import rounds
from isa_ros.bench.spec import Failed, LEG, Measured, ONE_PROCESS, PROCESSES, Spec
from isa_ros.errors import RunError
import pytest
from tests.bench.artificial import ran

A, B, C = (Spec(str(n), ONE_PROCESS, 100, rounds=2) for n in (1, 2, 3))


def test_every_other_round_goes_backwards():
    assert rounds.order_of([A, B, C]) == [A, B, C, C, B, A]


def test_a_steady_drift_meets_all_specs_alike():
    """With an even number of rounds the mean position of every spec is the same."""
    order = rounds.order_of([A, B, C])
    places = {spec: mean(k for k, s in enumerate(order) if s is spec) for spec in (A, B, C)}
    assert all(a == b for a, b in pairwise(places.values()))


def test_fewer_rounds_are_the_middle_ones():
    once, thrice = Spec('24', PROCESSES, 10, rounds=1), Spec('1', PROCESSES, 10, rounds=3)
    assert rounds.order_of([once, thrice]) == [thrice, thrice, once, thrice]


def test_a_spec_and_what_it_told_cross_as_json():
    run = ran(1000.0, 3)
    assert Spec.from_json(A.to_json()) == A
    assert Measured.from_json(run.to_json()) == run


def test_a_run_of_our_own_that_fails_ends_the_bench(monkeypatch):
    monkeypatch.setattr(rounds, 'measured', lambda spec: Failed('the disk is full'))
    with pytest.raises(RunError, match='the leg, processes: the disk is full'):
        rounds.outcomes([Spec(LEG, PROCESSES, 10)])


def test_a_peer_that_fails_leaves_the_others(monkeypatch):
    monkeypatch.setattr(
        rounds, 'measured', lambda s: Failed('no route') if s.way == 'pipes' else ran(1000.0))
    peer, own = Spec(LEG, 'pipes', 10), Spec(LEG, PROCESSES, 10)
    outcomes = rounds.outcomes([peer, own])
    assert outcomes.reason(peer) == 'no route' and not outcomes.of(peer)
    assert len(outcomes.of(own)) == own.rounds


def test_progress_counts_every_run(monkeypatch):
    monkeypatch.setattr(rounds, 'measured', lambda spec: ran(1000.0))
    seen = []
    rounds.outcomes([A, B], lambda done, total, what: seen.append((done, total, what)))
    assert seen == [(0, 4, str(A)), (1, 4, str(B)), (2, 4, str(B)), (3, 4, str(A)), (4, 4, '')]


def test_a_run_that_cannot_start_says_why():
    """A real process; an invalid plant is refused by the check of the run file."""
    failed = rounds.measured(Spec('0', ONE_PROCESS, 10))
    assert isinstance(failed, Failed) and 'rigs_0.yaml' in failed.reason
