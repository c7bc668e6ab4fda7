"""States of a unit: saved, restored with the same bytes, and refused when damaged."""

import numpy as np
import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.asserted import refused  # noqa: E402
from tests.export.fmi.importing import ERROR  # noqa: E402
from tests.export.fmi.runs import inputs_of, SAMPLED  # noqa: E402
from tests.export.libraries import sealed  # noqa: E402

pytestmark = pytest.mark.slow
HEAD = 33    # bytes of a state before its inputs: the token
NAN = np.float64('nan').tobytes()


def ran(unit, ticks):
    """Make the steps of ticks; return all samples."""
    found = []
    for tick in ticks:
        unit.set(dict(inputs_of(tick, False)))
        unit.step()
        found.append(unit.numbers([*SAMPLED]))
    return np.array(found)


def test_equal_instances_do_not_know_each_other(make, case):
    ticks = case.ticks[:150]
    alone = ran(make(), ticks)
    one, other = make(), make({'start.position': 0.02})
    found = []
    for tick in ticks:
        found.append(ran(one, [tick])[0])
        other.step()
    assert np.array(found).tobytes() == alone.tobytes()


def test_a_state_goes_on_with_the_same_bytes(make, case):
    unit, other = make(), make({'start.position': 0.02})
    ran(unit, case.ticks[:120])
    state = unit.state()
    after = ran(unit, case.ticks[120:200])
    other.step(5)
    for own in (unit, other):
        own.restore(state)
        own.n_steps = 120
        assert own.state() == state
        assert own.reached == 0.12
        assert ran(own, case.ticks[120:200]).tobytes() == after.tobytes()


def test_a_state_has_what_was_written_since_the_last_step(make):
    unit, other = make(), make()
    for own in (unit, other):
        own.step(3)
    unit.set({'setpoint.position': 0.08, 'quick_stop': True})
    other.restore(unit.state())
    for own in (unit, other):
        own.step(30)
    assert unit.state() == other.state()
    assert unit.get('device_event') == other.get('device_event') != 1


def with_checksum(state):
    """Return a state with the checksum of what it has now."""
    return sealed(np.frombuffer(state, np.uint8)).tobytes()


def test_bytes_that_are_no_state_are_refused(make):
    unit, other = make(), make()
    unit.step(20)
    state, before = unit.state(), other.state()
    assert with_checksum(state) == state
    pressure = np.float64(unit.get('supply.pressure')).tobytes()
    assert HEAD < state.index(pressure) < len(state) // 4    # of the supply, before the actuator
    middle = len(state) // 2
    for text, broken in (
            (f'a state of {len(state) - 1} bytes, must be', state[:-1]),
            ('a state of 0 bytes, must be', b''),
            ('not a state of this unit', with_checksum(b'x' + state[1:])),
            ('not a state of this unit', with_checksum(state.replace(pressure, NAN, 1))),
            ('not a state of this unit', with_checksum(state[:HEAD] + NAN + state[HEAD + 8:])),
            ('', with_checksum(state[:middle] + b'\xff' * 400 + state[middle + 400:]))):
        refused(other, ERROR, text, other.restore, broken)
    assert other.state() == before


def test_any_damage_of_a_state_is_refused(make):
    """Also where the number would be a possible one: an input, the supply, the time."""
    unit, other = make(), make()
    unit.step(20)
    state, before = unit.state(), other.state()
    places = (0, HEAD + 1, HEAD + 8 * 5, len(state) // 5, len(state) // 2, len(state) - 9,
              len(state) - 1)
    for place in places:
        damaged = bytearray(state)
        damaged[place] ^= 1
        refused(other, ERROR, 'not a state of this unit', other.restore, bytes(damaged))
    assert other.state() == before
    other.restore(state)
    assert other.state() == state


def test_reset_is_a_new_instance(make):
    unit, new = make({'start.position': 0.02}), make()
    unit.set({'setpoint.position': 0.06})
    unit.step(30)
    unit.slave.reset()
    unit.initialise()
    unit.n_steps = 0
    assert unit.state() == new.state()
    assert unit.get('start.position') == 0.05
