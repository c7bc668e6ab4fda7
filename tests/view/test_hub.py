"""Frames to pages, orders from them: a page never holds the run up."""

import json
from threading import Thread

from isa_ros.view.hub import Hub, MOST_VIEWERS
from isa_ros.view.orders import Order


def test_all_pages_get_all_frames_in_order():
    hub = Hub({'title': 'a'})
    assert json.loads(hub.page) == {'title': 'a'}
    assert not hub.has_viewers and not hub.was_opened.is_set()
    first = hub.opened()
    assert hub.has_viewers and hub.was_opened.is_set()
    hub.send(b'1')
    second = hub.opened()
    hub.send(b'2')
    assert [first.get(), first.get(), second.get()] == [b'1', b'2', b'2']


def test_a_slow_page_loses_its_oldest_frames():
    """It keeps those of a second, and the end."""
    hub = Hub({})
    viewer = hub.opened()
    for k in range(100):
        hub.send(b'%d' % k)
    hub.send(None)
    found = [viewer.get() for _ in range(30)]
    assert found == [*(b'%d' % k for k in range(71, 100)), None]


def test_only_so_many_pages_and_none_after_the_end():
    hub = Hub({})
    viewers = [hub.opened() for _ in range(MOST_VIEWERS)]
    assert None not in viewers and hub.opened() is None
    hub.close(viewers[1])
    again = hub.opened()
    assert again is not None
    hub.send(b'1')
    hub.close(again)
    hub.send(None)
    assert hub.opened() is None
    for viewer in (viewers[0], *viewers[2:]):
        hub.close(viewer)
    assert not hub.has_viewers


def test_the_end_waits_for_pages_that_still_read():
    """But not for ever."""
    hub = Hub({})
    viewer = hub.opened()
    hub.wait_until_left(0.01)
    assert hub.has_viewers
    thread = Thread(target=hub.wait_until_left, args=(30.0,))
    thread.start()
    hub.close(viewer)
    thread.join(10.0)
    assert not thread.is_alive()


def test_orders_are_taken_once():
    hub = Hub({})
    hub.orders.put(Order('pause', value=True))
    hub.orders.put(Order('step', value=3))
    assert [own.what for own in hub.taken()] == ['pause', 'step']
    assert hub.taken() == []
