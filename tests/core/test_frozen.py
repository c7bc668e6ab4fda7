"""Immutable dataclasses: what `dataclass` gives, method by method."""

import copy
from dataclasses import (
    asdict, astuple, dataclass, field, fields, FrozenInstanceError, is_dataclass, replace)
import inspect
import pickle
from typing import ClassVar, get_type_hints
from unittest.mock import patch

from isa_ros.core import frozen as module
from isa_ros.core.frozen import frozen
import pytest

made = dataclass(frozen=True)


class Twice:
    """A class twice: frozen by `dataclass`, and here."""

    def __init__(self, **options):
        self.options = options

    def __call__(self, cls):
        own = type(cls.__name__, cls.__bases__, {
            name: value for name, value in vars(cls).items()
            if name not in ('__dict__', '__weakref__')})
        return dataclass(frozen=True, **self.options)(cls), frozen(**self.options)(own)


@Twice()
class Places:
    """Has all kinds of fields."""

    COUNT: ClassVar[int] = 3
    first: int
    second: float = 2.5
    hidden: str = field(default='h', repr=False)
    beside: str = field(default='b', compare=False)
    listed: list[int] = field(default_factory=list, compare=False)
    whole: float = field(init=False, repr=False, compare=False)

    def __post_init__(self):
        object.__setattr__(self, 'whole', self.first + self.second)


@Twice(kw_only=True)
class Named:
    """Takes names only."""

    value: float
    other: 'int' = 7


@Twice(eq=False)
class Itself:
    """Equals itself only."""

    value: float


@Twice()
class One:
    """Has one field."""

    value: object


@Twice()
class Nothing:
    """Has none."""


PAIRS = [(Places, (4,), {}), (Places, (4, 1.5, 'x', 'y', [6]), {}), (Places, (), {'first': 5}),
         (Named, (), {'value': 1.25}), (Named, (), {'other': 8, 'value': 2.0}),
         (Itself, (3.0,), {}), (One, ((1, 2),), {}), (Nothing, (), {})]


@pytest.mark.parametrize('pair, given, named', PAIRS)
def test_an_instance_is_that_of_a_dataclass(pair, given, named):
    theirs, ours = (cls(*given, **named) for cls in pair)
    assert vars(ours) == vars(theirs) and list(vars(ours)) == list(vars(theirs))
    assert repr(ours) == repr(theirs)
    assert asdict(ours) == asdict(theirs) and astuple(ours) == astuple(theirs)
    assert is_dataclass(ours)
    assert [each.name for each in fields(ours)] == [each.name for each in fields(theirs)]


@pytest.mark.parametrize('pair', [Places, Named, Itself, One, Nothing])
def test_a_class_has_what_a_dataclass_has(pair):
    theirs, ours = pair
    assert inspect.signature(ours) == inspect.signature(theirs)
    assert ours.__match_args__ == theirs.__match_args__
    assert ours.__init__.__qualname__ == theirs.__init__.__qualname__
    assert ours.__init__.__module__ == theirs.__init__.__module__ == __name__
    assert get_type_hints(ours.__init__) == get_type_hints(theirs.__init__)
    for name in ('COUNT', 'second', 'listed', 'other'):
        assert getattr(ours, name, None) == getattr(theirs, name, None)


@pytest.mark.parametrize('pair, given, named', [
    (Places, (), {}), (Places, (1,), {'first': 2}), (Places, (1,), {'none': 2}),
    (Places, (1, 2, 3, 4, 5, 6), {}), (Named, (1.0,), {}), (Named, (), {}), (Nothing, (1,), {})])
def test_wrong_arguments_are_refused_in_the_same_words(pair, given, named):
    messages = []
    for cls in pair:
        with pytest.raises(TypeError) as caught:
            cls(*given, **named)
        messages.append(str(caught.value))
    assert messages[0] == messages[1]


@pytest.mark.parametrize('which', [0, 1])
def test_what_is_compared_is_equal_and_has_one_hash(which):
    cls = Places[which]
    assert cls(1, 2.0) == cls(1, 2.0, beside='else') != cls(1, 2.0, 'else')
    assert hash(cls(1, 2.0)) == hash(cls(1, 2.0, beside='else')) == hash((1, 2.0, 'h'))
    assert hash(One[which]('a')) == hash(('a',)) and hash(Nothing[which]()) == hash(())
    assert One[which](1) != (1,) and One[which](1) != One[1 - which](1)
    assert cls(1).__eq__(3) is NotImplemented
    alike = Itself[which](1.0), Itself[which](1.0)
    assert alike[0] != alike[1] and len({*alike}) == 2
    with pytest.raises(TypeError, match='unhashable'):
        hash(One[which]([1]))


@pytest.mark.parametrize('which', [0, 1])
def test_an_instance_cannot_be_changed(which):
    own = Places[which](1)
    for name in ('first', 'none'):
        with pytest.raises(FrozenInstanceError, match=f"^cannot assign to field '{name}'$"):
            setattr(own, name, 2)
        with pytest.raises(FrozenInstanceError, match=f"^cannot delete field '{name}'$"):
            delattr(own, name)
    assert own.first == 1
    changed = replace(own, second=9.0)
    assert (changed.first, changed.second, changed.whole) == (1, 9.0, 10.0)
    with pytest.raises((ValueError, TypeError), match='whole'):     # by the version of Python
        replace(own, whole=1.0)


@pytest.mark.parametrize('which', [0, 1])
def test_a_plain_class_that_inherits_has_attributes_of_its_own(which):
    own = type('Own', (One[which],), {})(1)
    own.more = 2
    with pytest.raises(FrozenInstanceError):
        own.value = 3
    with pytest.raises(FrozenInstanceError):
        del own.value
    assert own.more == 2 and own.value == 1
    del own.more
    assert not hasattr(own, 'more')


@pytest.mark.parametrize('decorator', [made, frozen])
def test_a_class_that_inherits_adds_and_replaces_fields(decorator):
    @decorator
    class Base:
        first: int
        second: int = 2

        def __post_init__(self):
            assert self.first >= 0

    @decorator
    class Derived(Base):
        second: int = 5
        third: int = 6
    assert Base(0) == Base(0, 2)
    assert repr(Derived(1)) == f'{Derived.__qualname__}(first=1, second=5, third=6)'
    assert Derived.__init__.__qualname__ == f'{Derived.__qualname__}.__init__'
    assert Derived.__qualname__ != Derived.__name__
    assert Derived(1) != Base(1, 5) and Derived(1, 5, 6) == Derived(1)
    assert hash(Derived(1)) == hash((1, 5, 6))
    with pytest.raises(AssertionError):
        Derived(-1)


@pytest.mark.parametrize('decorator', [made, frozen])
def test_own_methods_stay(decorator):
    @decorator
    class Own:
        value: int

        def __repr__(self):
            return 'mine'

        def __eq__(self, other):
            return True
    assert repr(Own(1)) == 'mine' and Own(1) == Own(2) and hash(Own(3)) == hash((3,))

    @decorator
    class Begun:
        value: int = 0

        def __init__(self):
            object.__setattr__(self, 'value', 9)

        def __hash__(self):
            return 5
    assert Begun().value == 9 and hash(Begun()) == 5


@frozen
class Kept:
    """A class that pickle finds."""

    value: int
    held: object = None


def test_it_is_pickled_and_copied_and_shows_itself():
    own = Kept(3, [1])
    assert pickle.loads(pickle.dumps(own)) == copy.copy(own) == copy.deepcopy(own) == own
    assert copy.deepcopy(own).held is not own.held
    own.held.append(own)
    assert repr(own) == 'Kept(value=3, held=[1, ...])'
    match own:
        case Kept(value, _):
            assert value == 3


def test_a_method_is_made_at_the_first_instance_and_no_other():
    with patch.object(module, 'dataclass', wraps=dataclass) as made_by:
        @frozen
        class Late:
            value: int
        assert [call.kwargs['init'] for call in made_by.call_args_list] == [False]
        assert Late(1) == Late(1) and Late(2).value == 2 and hash(Late(3)) == hash((3,))
    assert [call.kwargs.get('init', True) for call in made_by.call_args_list] == [False, True]
    assert not made_by.call_args.kwargs['eq'] and not made_by.call_args.kwargs['repr']
