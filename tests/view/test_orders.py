"""Orders of a page: known words with a value of their kind, all others refused by name."""

import json

from isa_ros.errors import SetpointError
from isa_ros.view.orders import FASTEST, Order, order_of
import pytest


def read(**tree):
    return order_of(json.dumps(tree).encode())


def test_an_order_has_its_value_in_its_type():
    assert read(what='pause', value=True, number=7) == Order('pause', value=True, number=7)
    assert read(what='step', value=25).value == 25
    speed = read(what='speed', value=2)
    assert speed.value == 2.0 and isinstance(speed.value, float)
    assert read(what='speed', value=FASTEST).value == FASTEST
    assert str(read(what='speed', value=-0.0).value) == '0.0'
    assert read(what='restart', value='ignored').value is None
    assert read(what='setpoint', of='kfe', name='position', value=-0.03) == Order(
        'setpoint', 'kfe', 'position', -0.03)


@pytest.mark.parametrize('tree, message', [
    ({'what': 'exec'}, "order what = 'exec', must be one of pause, step"),
    ({'what': ['pause']}, 'order what = '),
    ({}, "order what = '', must be one of"),
    ({'what': 'pause', 'value': 1}, 'pause: value = 1, must be true or false'),
    ({'what': 'pause'}, 'pause: value = None, must be true or false'),
    ({'what': 'step', 'value': 0}, 'step: value = 0, must be a whole number from 1 to 10000'),
    ({'what': 'step', 'value': 2.5}, 'step: value = 2.5, must be a whole number from'),
    ({'what': 'step', 'value': True}, 'step: value = True, must be a whole number from'),
    ({'what': 'step', 'value': 10001}, 'step: value = 10001, must be'),
    ({'what': 'speed', 'value': -0.1}, 'speed: value = -0.1, must be a number from 0 to 1000'),
    ({'what': 'speed', 'value': 1001}, 'speed: value = 1001, must be a number from 0 to 1000'),
    ({'what': 'seek', 'value': 2e9},
     'seek: value = 2000000000.0, must be a number from 0 to 1e+09'),
    ({'what': 'seek', 'value': 'now'}, "seek: value = 'now', must be a number"),
    ({'what': 'tune', 'value': False}, 'tune: value = False, must be a number'),
    ({'what': 'tune', 'value': 1, 'of': 3}, 'tune: of = 3, must be a text'),
    ({'what': 'tune', 'value': 1, 'name': 'x' * 201}, 'must be a text of at most 200'),
    ({'what': 'restart', 'number': -1}, 'restart: number = -1, must be a number'),
    ({'what': 'restart', 'number': True}, 'restart: number = True, must be a number'),
    ({'what': 'restart', 'else': 1}, 'an order must have what, of, name, value, number, no other'),
    ({'what': 'tune', 'value': 10 ** 400}, 'tune: value = 1000')])
def test_others_are_refused_with_what_they_must_be(tree, message):
    with pytest.raises(SetpointError) as error:
        read(**tree)
    assert message in str(error.value) and len(str(error.value)) < 300


@pytest.mark.parametrize('body', [
    b'', b'pause', b'[1]', b'3', b'\xff', b'[' * 100_000, b'{"what": "tune", "value": NaN}',
    b'{"what": "tune", "value": Infinity}', b'{"what": "seek", "value": 1e999}',
    b'\xef\xbb\xbf{"what": "restart"}', '{"what": "restart"}'.encode('utf-16')])
def test_what_is_no_order_is_refused(body):
    with pytest.raises(SetpointError):
        order_of(body)


def test_a_key_that_is_there_twice_is_refused():
    """Which of the two a reader takes is not defined."""
    for body in (b'{"what": "step", "value": 1, "value": 9}',
                 b'{"what": "tune", "value": {"a": 1, "a": 1}}'):
        with pytest.raises(SetpointError, match='^an order must have each key once$'):
            order_of(body)
