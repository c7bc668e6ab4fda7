"""Orders of a page, checked as far as that takes no run: what, of what, and a value."""

from collections.abc import Mapping, Sequence
import json
import math
import sys
from typing import Any, NamedTuple

from isa_ros.core.suggest import listed, shortened
from isa_ros.errors import SetpointError

MOST_BYTES = 4096
"""Of an order."""
MOST_TICKS = 10_000
"""Of a step: about as many as take a second."""
FASTEST = 1000.0
"""Largest speed, times real time."""
SLOWEST = 0.01
"""Least speed of a run: between two ticks it takes orders."""
LATEST = 1e9
"""Largest time of a bag that is sought, s: thirty years."""
_LONGEST = 200      # characters of a name
_LARGEST_ID = 1 << 53
_LARGEST = sys.float_info.max

PAUSE, STEP, SPEED, SEEK, RESTART = 'pause', 'step', 'speed', 'seek', 'restart'
SETPOINT, TUNE, FAULT, REQUEST, STOP = 'setpoint', 'tune', 'fault', 'request', 'stop'
_VALUES: Mapping[str, type | None] = {
    PAUSE: bool, STEP: int, SPEED: float, SEEK: float, RESTART: None, SETPOINT: float,
    TUNE: float, FAULT: bool, REQUEST: None, STOP: bool}
"""Type of the value by order."""
_BOUNDS = {STEP: (1, MOST_TICKS), SPEED: (0.0, FASTEST), SEEK: (0.0, LATEST)}


class Order(NamedTuple):
    """One order."""

    what: str
    """One of the words above."""
    of: str = ''
    """Actuator or supply."""
    name: str = ''
    """Field of a setpoint, key of a parameter, fault, or request."""
    value: Any = None
    number: int = 0
    """By which the page knows the answer."""


class OrderAnswer(NamedTuple):
    """What became of an order."""

    number: int
    is_done: bool
    text: str
    tick: int
    """Finished ticks when it was taken: it takes effect from there on."""


def ticks_text(n: int) -> str:
    """Return a number of ticks in words."""
    return f'{n} tick{"s" * (n > 1)}'


def order_of(body: bytes) -> Order:
    """
    Return the order in the JSON of a page.

    Raises
    ------
    SetpointError
        It is not an order.

    """
    try:
        tree = json.loads(body.decode(), object_pairs_hook=_of_pairs)
    except (ValueError, RecursionError):
        raise SetpointError('an order must be JSON in UTF-8') from None
    if not isinstance(tree, dict) or not set(tree) <= set(Order._fields):
        raise SetpointError(f'an order must have {listed(Order._fields)}, no other key')
    order = Order(**{'what': '', **tree})
    if not isinstance(order.what, str) or order.what not in _VALUES:
        raise SetpointError(
            f'order what = {_quoted(order.what)}, must be one of {listed([*_VALUES])}')
    for field in ('of', 'name'):
        text = getattr(order, field)
        if not isinstance(text, str) or len(text) > _LONGEST:
            raise SetpointError(
                f'{order.what}: {field} = {_quoted(text)}, must be a text of at most {_LONGEST} '
                'characters')
    if type(order.number) is not int or not 0 <= order.number < _LARGEST_ID:
        raise SetpointError(f'{order.what}: number = {_quoted(order.number)}, must be a number')
    return order._replace(value=_value(order))


def _of_pairs(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """Return an object of JSON whose keys are there once."""
    tree = dict(pairs)
    if len(tree) < len(pairs):
        raise SetpointError('an order must have each key once')
    return tree


def _value(order: Order) -> Any:
    """Return the value of an order in its type."""
    kind, value = _VALUES[order.what], order.value
    if kind is None:
        return None
    low, high = _BOUNDS.get(order.what, (-math.inf, math.inf))
    if kind is bool:
        if isinstance(value, bool):
            return value
        bound = 'true or false'
    else:
        is_number = isinstance(value, int if kind is int else (int, float)) and not isinstance(
            value, bool)
        if is_number and low <= value <= high and abs(value) <= _LARGEST:
            return kind(value) + kind(0)    # no -0
        bound = f'a {"whole " if kind is int else ""}number'
        if order.what in _BOUNDS:
            bound += f' from {low:g} to {high:g}'
    raise SetpointError(f'{order.what}: value = {_quoted(value)}, must be {bound}')


def _quoted(value: Any) -> str:
    return shortened(repr(value))
