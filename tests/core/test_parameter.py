"""The text of a parameter set: what it is remembered by."""

import copy
from dataclasses import FrozenInstanceError, replace
import pickle

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import numbers, parameter, Parameters, text_of
import pytest
from tests.sheets import actuator_sheet, MODELS, override


@frozen(kw_only=True)
class Disc(Parameters):
    """A set of one value."""

    radius: float = parameter('of the disc', 'm', ge=-1e3, le=1e3)


@frozen(kw_only=True)
class Curve(Parameters):
    """A set of several values in one."""

    points: tuple[float, ...] = numbers('of a curve', 'm', least=1, most=9)


def test_a_list_cannot_be_changed_afterwards() -> None:
    """Else its text, and what is remembered by it, would be that of the old values."""
    given = [1.0, 2.0]
    curve = Curve(points=given)     # type: ignore[arg-type]
    given[0] = 9.0
    assert curve.points == (1.0, 2.0) and curve == Curve(points=(1.0, 2.0))
    assert curve.as_text == 'Curve(points=(1.0, 2.0))' and hash(curve)


@frozen(kw_only=True)
class Stack(Parameters):
    """A set in a set."""

    disc: Disc
    height: float = parameter('of the stack', 'm', ge=0.0, le=1e3)


@pytest.mark.parametrize('model', MODELS)
def test_it_is_what_repr_shows(model: str) -> None:
    sheet = actuator_sheet(model)
    assert sheet.as_text == repr(sheet) == text_of(sheet) and len(sheet.as_text) > 3000
    changed = override(sheet, 'plant.sensors.force_range', 12345.0)
    assert changed.as_text == repr(changed) != sheet.as_text == repr(sheet)


def test_it_is_made_once_and_parts_keep_theirs() -> None:
    stack = Stack(disc=Disc(radius=0.5), height=2.0)
    assert stack.as_text is stack.as_text
    higher = replace(stack, height=3.0)
    assert higher.as_text == 'Stack(disc=Disc(radius=0.5), height=3.0)'
    assert higher.disc.as_text is stack.disc.as_text
    object.__setattr__(stack.disc, '_text', 'kept')
    assert replace(stack, height=4.0).as_text == 'Stack(disc=kept, height=4.0)'
    assert text_of((1, -0.0)) == '(1, -0.0)'


@pytest.mark.parametrize('copied', [copy.copy, copy.deepcopy, replace, lambda own: pickle.loads(
    pickle.dumps(own))])
def test_it_is_none_of_the_values(copied) -> None:
    """A copy has the values, cannot be changed, and finds its text again."""
    disc = Disc(radius=0.25)
    assert disc.as_text == 'Disc(radius=0.25)'
    assert vars(disc) == {'radius': 0.25} and disc == Disc(radius=0.25)
    other = copied(disc)
    assert other == disc and hash(other) == hash(disc) and vars(other) == vars(disc)
    assert other.as_text == disc.as_text
    with pytest.raises(FrozenInstanceError):
        other.radius = 1.0
