"""Rows of the comparison from the results of runs over peers."""

from benchmarks import comparison
from benchmarks.peers import catalogue
from benchmarks.peers.catalogue import Peer, PEERS
from isa_ros.bench import leg
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.spec import Failed, LEG, Spec
import pytest
from tests.bench.artificial import ran
from tests.bench.test_groups import by_name


@pytest.fixture
def all_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Evaluate the rows of all peers, installed or not."""
    monkeypatch.setattr(comparison, 'installed', lambda: list(PEERS))


def test_peers_are_compared_round_by_round(all_installed):
    """In the round with half the speed both are half as fast: the ratio is unchanged."""
    def peer(name: str) -> Spec:
        return Spec(LEG, name, leg.IN_PROCESSES.ticks)
    rows = by_name(comparison.comparison_rows(Outcomes({
        leg.IN_PROCESSES: [ran(1000.0, 3), ran(500.0, 3)],
        peer('pipes'): [ran(2000.0, 3), ran(1000.0, 3)],
        peer('zeromq'): [ran(1500.0, 3), ran(750.0, 3)],
        peer('helics'): [ran(400.0, 3), ran(200.0, 3)],
        peer('cyclone'): [Failed('no route')]})))
    helics, zeromq = rows['isa_ros over HELICS'], rows['ZeroMQ ipc over isa_ros']
    assert (helics.lowest, helics.value, helics.highest) == (2.5, 2.5, 2.5)
    assert helics.is_reached and zeromq.value == 1.5 and zeromq.is_reached
    failed = rows['Cyclone DDS from Python']
    assert failed.value is None and failed.note == 'no route'
    assert 'isa_ros over Cyclone DDS from Python' not in rows
    assert rows['ZeroMQ ipc'].ratio == pytest.approx(0.75)


def test_twelve_actuators_over_peers_have_the_aims_of_the_leg(all_installed):
    ours = comparison.TWELVE
    over = {peer.name: comparison.over(peer, ours) for peer in comparison.PEERS}
    rows = by_name(comparison.comparison_rows(Outcomes({
        ours: [ran(600.0, 12), ran(500.0, 12)], over['pipes']: [ran(400.0, 12)],
        over['zeromq']: [ran(1800.0, 12)], over['helics']: [ran(400.0, 12)]})))
    assert rows['12 actuators, isa_ros over HELICS'].value == pytest.approx(1.5)
    assert rows['12 actuators, isa_ros over HELICS'].is_reached is False
    assert rows['12 actuators, ZeroMQ ipc over isa_ros'].value == pytest.approx(3.0)
    assert rows['12 actuators, ZeroMQ ipc over isa_ros'].is_reached is False
    assert not [name for name in rows if name.startswith('isa_ros')]  # no leg was run


def test_a_peer_that_is_not_installed_is_neither_run_nor_a_row(monkeypatch):
    """One note of all of them, at the row of this package."""
    monkeypatch.setattr(catalogue, 'PEERS', (PEERS[0], Peer('a', 'A', 'a', 'no_such_package')))
    monkeypatch.setattr(comparison, 'PEERS', catalogue.PEERS)
    assert {spec.way for spec in comparison.specs()} == {'processes', 'pipes'}
    own, other = comparison.comparison_rows(Outcomes({
        leg.IN_PROCESSES: [ran(1000.0, 3)],
        comparison.over(PEERS[0], leg.IN_PROCESSES): [ran(2000.0, 3)]}))
    assert own.note == 'not installed: A: requirements-bench.txt'
    assert (other.name, other.value) == ('multiprocessing pipes', 2000.0)
