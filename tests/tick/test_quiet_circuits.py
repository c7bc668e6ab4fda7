"""Quiet ticks with circuits: the bytes are those of single ticks, whatever is in a call."""

from isa_ros.scripting.run import load, Run
from isa_ros.surroundings.circuits.circuit import Circuit
import pytest
from tests.tick.quietly import bag_of


def hot() -> Run:
    """Return a station whose oil gets other properties every few ticks."""
    heat = 'supplies.station.parts.tank.heat'
    return load('cooled_station', scenario='cooled_station').replace(
        {f'{heat}.oil_volume_l': 0.1, f'{heat}.metal_heat_capacity': 0.0})


@pytest.mark.parametrize('pattern', [(2,), (20,), (1, 50, 3, 9), (1_000_000,)])
def test_oil_that_warms_up_ends_a_call_and_no_byte_differs(tmp_path, monkeypatch, pattern):
    """Its circuit's network is another one then, which is for Python, in the same tick."""
    changed: list[float] = []
    change = Circuit.change

    def note(self, sheet):
        changed.append(float(self._warmth.oil.celsius))
        change(self, sheet)
    monkeypatch.setattr(Circuit, 'change', note)
    first, _ = bag_of(tmp_path / '1', hot(), 300, (1,))
    n_changes = len(changed)
    assert bag_of(tmp_path / '2', hot(), 300, pattern)[0] == first
    assert 5 < n_changes < 100 and changed[n_changes:] == changed[:n_changes]
    assert len(set(changed)) == n_changes


def test_a_circuit_takes_other_values_between_two_calls(tmp_path):
    run = load('pump_station')

    def tuned(simulation):
        simulation.tune('station', {'parts.press_hose.burst': 0.02})
    first, _ = bag_of(tmp_path / '1', run, 40, (1,), tuned)
    assert bag_of(tmp_path / '2', run, 40, (20,), tuned)[0] == first
    assert bag_of(tmp_path / '3', run, 40, (20,))[0] != first


def test_a_state_that_was_saved_within_quiet_ticks_continues():
    """In the arrays that the loop is bound to: restored there, and gone on in other calls."""
    run = load('pump_station')
    one, other = (run.simulation().loop for _ in range(2))
    for loop in (one, other):
        loop.begin()
        loop.advance()
    one.advance_quietly(20)
    assert one.ticks == 20
    state = one.save()
    one.advance_quietly(60)
    assert one.ticks == 60
    other.advance_quietly(5)
    other.restore(state)
    while other.ticks < 60:
        other.advance()
    assert one.save() == other.save() != state
