"""Results that are kept: the same for the same values, and no others."""

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.remembered import MOST, remembered
import pytest


@frozen(kw_only=True)
class Disc(Parameters):
    """A set of one value."""

    radius: float = parameter('of the disc', 'm', ge=-1e3, le=1e3)


class Counted:
    """A function of sets that counts how often it is called."""

    def __init__(self) -> None:
        self.calls = 0

    @remembered
    def of(self, disc: Disc, other: Disc | None = None) -> tuple[str, object]:
        """Return what it was called with."""
        self.calls += 1
        return repr(disc.radius), other

    def __repr__(self) -> str:
        return f'Counted {id(self)}'


def test_equal_sets_have_one_result() -> None:
    own = Counted()
    first = own.of(Disc(radius=0.5))
    assert own.of(Disc(radius=0.5)) is first and own.calls == 1
    assert own.of(Disc(radius=0.25)) == ('0.25', None) and own.calls == 2


@pytest.mark.parametrize(('one', 'other'), [(0.0, -0.0), (1, 1.0), (0.1, 0.1 + 2.0 ** -56)])
def test_values_that_differ_by_a_bit_are_others(one: float, other: float) -> None:
    """Sets with 0.0 and -0.0 equal, the bytes that are made of them do not."""
    own = Counted()
    assert [own.of(Disc(radius=value))[0] for value in (one, other)] == [repr(one), repr(other)]
    assert own.calls == 2


def test_all_sets_of_a_call_count() -> None:
    own, disc = Counted(), Disc(radius=2.0)
    assert own.of(disc, disc)[1] is disc and own.of(disc)[1] is None
    assert own.of(disc, other=disc)[1] is disc
    assert own.calls == 3


def test_a_name_and_a_place_are_not_mixed_up() -> None:
    own, disc = Counted(), Disc(radius=2.0)
    assert own.of(disc, None)[1] is None and own.of(disc, other=disc)[1] is disc
    assert own.of(disc=disc)[0] == '2.0' and own.calls == 3


def test_an_error_is_no_result() -> None:
    answers = iter([ValueError('closed'), 7])

    @remembered
    def next_of(disc: Disc) -> int:
        found = next(answers)
        if isinstance(found, ValueError):
            raise found
        return found
    with pytest.raises(ValueError, match='closed'):
        next_of(Disc(radius=1.0))
    assert next_of(Disc(radius=1.0)) == 7


def test_the_oldest_results_are_given_up() -> None:
    own = Counted()
    for radius in range(1, MOST + 2):
        own.of(Disc(radius=radius))
    own.of(Disc(radius=MOST + 1))
    assert own.calls == MOST + 1
    own.of(Disc(radius=1))
    assert own.calls == MOST + 2
