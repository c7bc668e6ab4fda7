"""Samples between two frames: all of few ticks, every second, fourth, ... of many."""

import base64
import json

from isa_ros.view.frames import frame_of, Gathering, MOST, Samples
import numpy as np
import pytest


def gathered(ticks, n_channels=2):
    own = Gathering(n_channels)
    for tick in ticks:
        row = own.row(tick)
        if row is not None:
            row[:] = tick, -tick
    return own


def test_all_of_few_ticks_are_there():
    own = gathered(range(7, 12))
    first, every, values = own.take()
    assert (first, every, values.tolist()) == (7, 1, [[k, -k] for k in range(7, 12)])
    assert len(own.take().values) == 0
    own.row(40)[:] = 1, 2
    assert own.take().first == 40


def test_samples_before_a_gap_or_a_restart_are_forgotten():
    for jump in (9, 3, 0):
        own = gathered([5, 6, 7, jump, jump + 1])
        first, every, values = own.take()
        assert (first, every, values[:, 0].tolist()) == (jump, 1, [jump, jump + 1])


@pytest.mark.parametrize('n, every', [(MOST, 1), (MOST + 1, 2), (2 * MOST + 1, 4), (5000, 32)])
def test_of_many_ticks_an_even_part_is_there(n, every):
    found = gathered(range(3, 3 + n)).take()
    assert found.first == 3 and found.every == every
    assert found.values[:, 0].tolist() == [*range(3, 3 + n, every)]
    assert len(found.values) <= MOST


def test_after_a_thinned_frame_all_ticks_are_there_again():
    own = gathered(range(1000))
    assert own.take().every == 4
    for tick in range(1000, 1007):
        own.row(tick)[:] = tick, 0
    found = own.take()
    assert (found.first, found.every, len(found.values)) == (1000, 1, 7)


def test_a_frame_is_one_event_with_its_numbers():
    values = np.array([[1.5, np.nan], [2.5, -3e38]], np.float32)
    frame = frame_of(Samples(12, 4, values), tick=16, answers=[])
    assert frame.startswith(b'data: {') and frame.endswith(b'}\n\n') and frame.count(b'\n') == 2
    tree = json.loads(frame[6:])
    assert {key: tree[key] for key in ('first', 'every', 'n', 'tick', 'answers')} == {
        'first': 12, 'every': 4, 'n': 2, 'tick': 16, 'answers': []}
    read = np.frombuffer(base64.b64decode(tree['y']), '<f4').reshape(2, 2)
    np.testing.assert_array_equal(read, values)


def test_a_frame_has_no_number_that_json_does_not_have():
    with pytest.raises(ValueError):
        frame_of(Samples(0, 1, np.zeros((0, 3), np.float32)), lag=np.inf)
