"""The messages of a tick in one block: the same sequence, without an object for each."""

from hypothesis import given, strategies as st
from isa_ros.bag.packed import layout, Packed
import numpy as np

MESSAGES = st.lists(st.tuples(st.integers(0, 100), st.binary(max_size=40)))


@given(messages=MESSAGES)
def test_packed_messages_are_those_that_were_given(messages):
    """Empty ones too; in their order."""
    packed = Packed.of(messages)
    assert list(packed) == messages and len(packed) == len(messages)
    assert Packed.of(packed) is packed
    assert packed[1:] == messages[1:]
    assert [packed[k] for k in range(len(packed))] == messages


def test_messages_may_stand_anywhere_in_their_block():
    """With gaps, and in another order than in the block."""
    block = np.frombuffer(b'..abc.de', np.uint8)
    packed = Packed(block, layout([3, 7], [6, 2], [2, 3]))
    assert list(packed) == [(3, b'de'), (7, b'abc')]
    assert packed[-1] == (7, b'abc')


def test_some_messages_are_selected_under_other_topics():
    """Of the same block."""
    packed = Packed.of([(0, b'a'), (2, b'bc'), (5, b'def')])
    some = packed.selected([0, 2], [0, 1])
    assert list(some) == [(0, b'a'), (1, b'def')]
    assert some.block is packed.block
    assert list(packed.selected([], [])) == []


def test_a_message_that_was_taken_stays_when_the_block_is_packed_anew():
    block = np.zeros(3, np.uint8)
    packed = Packed(block, layout([0], [1], [2]))
    taken = packed[0]
    block[:] = 7
    assert (taken, packed[0]) == ((0, b'\x00\x00'), (0, b'\x07\x07'))
