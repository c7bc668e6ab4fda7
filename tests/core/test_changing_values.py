"""Values that change between two ticks: accepted, over and beneath, in force, echoed, saved."""

from isa_ros.core.changing_values import bare, ChangingValues, OFF, OVER, RECORDED
from isa_ros.errors import ConfigError
import numpy as np
import pytest

FIRST = {'a': 1.0, 'b': 2.0, 'c': 3.0}


def values() -> ChangingValues:
    return ChangingValues('ram', list(FIRST), list(FIRST.values()))


def test_a_value_is_in_force_from_the_next_tick_on_and_echoed_once() -> None:
    own = values()
    assert own.is_settled and not own.latch()
    own.accept({'a': 5.0, 'b': 2.0})
    assert own.value('a') == 5.0 and own.in_force == {} and not own.is_settled
    assert own.latch() and own.in_force == own.applied == {'a': 5.0}
    assert own.change('a') == (1.0, 5.0) and not own.is_settled
    assert not own.latch() and own.applied == {} and own.in_force == {'a': 5.0}
    assert own.is_settled and own.change('a') == (5.0, 5.0)


def test_what_lies_over_a_value_hides_what_is_accepted_until_it_is_taken_off() -> None:
    own = values()
    own.accept({f'{OVER}a': 9.0})
    own.latch()
    own.accept({'a': 5.0})
    assert not own.latch() and own.in_force == {'a': 9.0}
    own.accept({f'{OFF}a': 0.0})
    assert own.latch() and own.applied == {'a': 5.0}


def test_the_end_of_a_fault_over_the_first_value_brings_that_back() -> None:
    own = values()
    own.accept({f'{OVER}a': 9.0, f'{RECORDED}b': 8.0})
    own.latch()
    assert own.recorded.tolist() == [False, True, False]
    own.accept({f'{OFF}a': 0.0, f'{OFF}b': 0.0})
    own.latch()
    assert own.in_force == {} and own.applied == {'a': 1.0, 'b': 2.0}
    assert not own.recorded.any()


def test_a_trial_changes_nothing_and_has_the_next_tick_and_what_lies_beneath() -> None:
    own = values()
    own.accept({f'{OVER}a': 9.0, 'a': 5.0})
    before = own.snapshot()
    following, beneath = own.with_accepted({'b': 7.0})
    assert following == {'a': 9.0, 'b': 7.0} and beneath == {'a': 5.0, 'b': 7.0}
    assert own.snapshot() == before


def test_a_restart_has_the_first_values_in_force_and_faults_taken_off() -> None:
    own = values()
    own.accept({'a': 5.0, f'{OVER}b': 9.0})
    own.latch()
    assert own.restart() == {'a': 5.0}
    assert own.in_force == {} and not own.is_settled
    assert own.latch() and own.applied == {'a': 5.0}


@pytest.mark.parametrize('n_latched', [0, 1, 2])
def test_a_restored_one_goes_on_as_the_saved_one(n_latched: int) -> None:
    own, twin = values(), values()
    own.accept({'a': 5.0, f'{OVER}b': 9.0})
    for _ in range(n_latched):
        own.latch()
    assert own.nbytes == len(own.snapshot())
    twin.restore(own.snapshot())
    for _ in range(3):
        assert twin.latch() == own.latch()
        assert (twin.in_force, twin.applied) == (own.in_force, own.applied)


def test_a_snapshot_that_is_not_finite_is_refused_by_name() -> None:
    own = values()
    rows = np.frombuffer(own.snapshot()).copy()
    rows[4] = np.nan
    with pytest.raises(ConfigError, match='ram: saved state has b = nan, must be finite'):
        own.restore(rows.tobytes())
    assert own.in_force == {}


def test_what_is_withdrawn_stays_as_it_was_and_loses_its_fault() -> None:
    own = values()
    own.accept({'a': 5.0, f'{OVER}b': 9.0, 'c': 7.0})
    own.withdraw(np.array([True, True, False]), np.array([1.0, 2.0]))
    assert own.accepted == {'c': 7.0}


def test_bare_names() -> None:
    assert [bare(name) for name in (f'{OVER}a', f'{OFF}a', f'{RECORDED}a', 'a')] == ['a'] * 4
