"""The messages of a chunk: found by the kernel as by a walk in Python, and by topic."""

from pathlib import Path

from isa_ros.bag import message_table
from isa_ros.bag.message_chunk import MESSAGE_HEADER
from isa_ros.bag.message_table import messages_in
from isa_ros.bag.reader import Bag
from isa_ros.errors import BagError
import numpy as np
import pytest

GOLDEN = Path(__file__).parents[1] / 'golden' / 'leg_touchdown'


def message(channel: int, sequence: int, t_ns: int, data: bytes) -> bytes:
    return MESSAGE_HEADER.pack(5, 22 + len(data), channel, sequence, t_ns, 77) + data


def other(opcode: int, data: bytes) -> bytes:
    return bytes([opcode]) + len(data).to_bytes(8, 'little') + data


CHUNK = (other(3, b'schema') + message(700, 2**32 - 1, 2**63 + 9, b'abc') + other(0x90, b'')
         + message(3, 5, 11, b'defg') + message(700, 6, 12, b'hij'))


def test_heads_are_those_that_were_packed():
    """Also in the highest bits of each."""
    table, others = messages_in(CHUNK, 5, 'here')
    assert others == [(3, b'schema'), (0x90, b'')]
    assert table.channels.tolist() == [700, 3, 700]
    assert table.sequences.tolist() == [2**32 - 1, 5, 6]
    assert table.times.tolist() == [2**63 + 9, 11, 12]
    data = [CHUNK[begin:end] for begin, end in zip(table.begins, table.ends)]
    assert data == [b'abc', b'defg', b'hij']


def test_the_messages_of_a_channel_are_rows_of_bytes():
    table, _ = messages_in(CHUNK, 5, 'here')
    own = table.of(700)
    assert own.times.tolist() == [2**63 + 9, 12]
    assert own.bytes_of().tobytes() == b'abchij'
    assert table.bytes_of() is None         # of two sizes
    assert table.of(3).bytes_of().tobytes() == b'defg'


def test_unevenly_spaced_messages_are_gathered():
    content = b''.join([message(1, k, k, b'%02d' % k) + other(0x80, bytes(k)) for k in range(4)])
    table, _ = messages_in(content, 8, 'here')
    assert np.ptp(np.diff(table.begins)) > 0
    assert table.bytes_of().tobytes() == b'00010203'
    even, _ = messages_in(b''.join(message(1, k, k, b'%02d' % k) for k in range(4)), 8, 'here')
    assert even.bytes_of().tobytes() == b'00010203' and even.bytes_of().base is not None


@pytest.mark.parametrize(('content', 'most', 'complaint'), [
    (CHUNK[:-1], 5, 'here: a record reaches beyond its chunk'),
    (CHUNK + b'\5', 9, 'here: a record reaches beyond its chunk'),
    (b'\5' + bytes([255] * 8) + bytes(50), 9, 'here: a record reaches beyond its chunk'),
    (b'\5' + bytes(6) + b'\0\x80' + bytes(50), 9, 'here: a record reaches beyond its chunk'),
    (CHUNK, 4, 'here: more records in a chunk than its compressed bytes allow, must be <= 4'),
    (CHUNK + bytes(9), 9, 'here: unknown record 0x00 in a chunk'),
    (CHUNK + other(5, bytes(21)), 9, 'here: a message record of 30 bytes')])
def test_what_is_no_chunk_is_refused(content, most, complaint):
    with pytest.raises(BagError) as error:
        messages_in(content, most, 'here')
    assert str(error.value) == complaint


def test_a_message_may_be_empty():
    table, _ = messages_in(message(1, 2, 3, b''), 1, 'here')
    assert (table.ends - table.begins).tolist() == [0]


@pytest.mark.parametrize('length', [7, -7, 2**63 - 1])
def test_the_kernel_is_its_python_source(length):
    content = np.frombuffer(CHUNK + b'\x05' + length.to_bytes(8, 'little', signed=True), np.uint8)
    found = [np.zeros((9, 6), np.int64) for _ in range(2)]
    results = [walk(content, 9, into) for walk, into in zip(
        (message_table._find_records, message_table._find_records.py_func), found)]
    assert results[0] == results[1] == (5, 1)
    assert (found[0] == found[1]).all()


def test_some_topics_are_those_of_all_messages():
    """In their order; chunks without them are not read."""
    bag = Bag(GOLDEN)
    wanted = {'/diagnostics', '/kfe/valve'}
    every = list(bag.messages())
    assert list(bag.messages(wanted)) == [own for own in every if own.topic in wanted]
    assert {topic: len([1 for own in every if own.topic == topic])
            for topic in bag.types if bag.counts[topic]} == dict(bag.counts)
    by_topic = {topic: b''.join(own.data for own in every if own.topic == topic)
                for topic in wanted}
    found = dict.fromkeys(wanted, b'')
    for topic, table in bag.columns(wanted):
        found[topic] += b''.join(
            table.content[begin:end] for begin, end in zip(table.begins, table.ends))
    assert found == by_topic
