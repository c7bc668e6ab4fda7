"""Reading bags: whole, cut short anywhere, written by others, and damaged."""

from itertools import groupby

from hypothesis import given, settings, strategies as st
from isa_ros.bag import records
from isa_ros.bag.reader import Bag
from isa_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer
import pytest
from tests.bag.recorded import NAMES, PROVENANCE, record, STEP_NS, tick_messages

N = 600  # ticks: one full chunk and a part


@pytest.fixture(scope='module')
def mcap(tmp_path_factory):
    """Return the MCAP file of a bag of N ticks."""
    return record(tmp_path_factory.mktemp('recorded') / 'rig', N)


@pytest.fixture(scope='module')
def scratch(tmp_path_factory):
    """Return the path of a file that examples overwrite."""
    return tmp_path_factory.mktemp('scratch') / 'rig_0.mcap'


def rewrite(mcap, path, compression=CompressionType.NONE, attachments=True):
    """Copy a bag with the official writer."""
    with mcap.open('rb') as source, path.open('wb') as sink:
        reader, writer = make_reader(source), Writer(sink, 64 * 1024, compression)
        writer.start('ros2')
        for item in reader.iter_attachments() if attachments else ():
            writer.add_attachment(
                item.create_time, item.log_time, item.name, item.media_type, item.data)
        for item in reader.iter_metadata():
            writer.add_metadata(item.name, item.metadata)
        channels = {}
        for schema, channel, message in reader.iter_messages():
            if channel.topic not in channels:
                schema_id = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(
                    channel.topic, 'cdr', schema_id)
            writer.add_message(
                channels[channel.topic], message.log_time, message.data,
                message.publish_time, message.sequence)
        writer.finish()
    return path


def chunks(mcap):
    """Return (start, end) of every chunk record in a file."""
    with mcap.open('rb') as file:
        return [(chunk.chunk_start_offset, chunk.chunk_start_offset + chunk.chunk_length)
                for chunk in make_reader(file).get_summary().chunk_indexes]


def test_every_tick_comes_back_as_it_was_written(mcap):
    ticks = list(Bag(mcap).ticks())
    assert len(ticks) == N
    for k, tick in enumerate(ticks):
        assert (tick.t_ns, tick.sequence) == (k * STEP_NS, k)
        assert [(NAMES.index(m.topic), m.data) for m in tick.messages] == tick_messages(k)


def test_directory_and_file_name_the_same_bag(mcap):
    assert list(Bag(mcap.parent).messages()) == list(Bag(mcap).messages())


def test_bag_says_what_it_holds(mcap):
    bag = Bag(mcap)
    assert bag.is_whole
    assert (bag.start_ns, bag.end_ns) == (0, (N - 1) * STEP_NS)
    assert bag.n_messages == sum(len(tick_messages(k)) for k in range(N))
    assert sorted(bag.types) == NAMES
    assert bag.types['/hip/load_cell'] == 'geometry_msgs/msg/WrenchStamped'
    assert bag.provenance == PROVENANCE


@given(drawn=st.data())
@settings(deadline=None, max_examples=40)
def test_bag_cut_anywhere_reads_whole_ticks_up_to_its_last_chunk(mcap, scratch, drawn):
    data = mcap.read_bytes()
    cut = drawn.draw(st.integers(8, len(data) - 1))
    scratch.write_bytes(data[:cut])
    bag = Bag(scratch)
    n_chunks = sum(end <= cut for _, end in chunks(mcap))
    assert not bag.is_whole
    assert [tick.sequence for tick in bag.ticks()] == list(range([0, 500, N][n_chunks]))


@given(drawn=st.data())
@settings(deadline=None, max_examples=80)
def test_any_flipped_bit_of_a_whole_bag_is_found(mcap, scratch, drawn):
    """Every byte lies under the CRC of the data section, of the summary, or is magic."""
    data = bytearray(mcap.read_bytes())
    place = drawn.draw(st.integers(0, len(data) - 1) | st.integers(len(data) - 60, len(data) - 1)
                       | st.integers(0, 1500))
    data[place] ^= 1 << drawn.draw(st.integers(0, 7))
    scratch.write_bytes(data)
    with pytest.raises(BagError, match='rig_0.mcap: '):
        Bag(scratch)


@given(drawn=st.data())
@settings(deadline=None, max_examples=40)
def test_flipped_bit_in_a_chunk_of_a_cut_bag_is_found(mcap, scratch, drawn):
    """A cut bag has no DataEnd, so the chunk's own CRC must detect it."""
    start, end = chunks(mcap)[0]
    data = bytearray(mcap.read_bytes()[:end])
    data[drawn.draw(st.integers(start + 9 + 40, end - 1))] ^= 1 << drawn.draw(st.integers(0, 7))
    scratch.write_bytes(data)
    with pytest.raises(BagError, match=f'damaged at byte {start}: CRC of a chunk is wrong'):
        Bag(scratch)


@given(data=st.binary(max_size=400))
@settings(deadline=None)
def test_arbitrary_records_are_read_or_refused(scratch, data):
    """For any bytes after the magic the only error raised is BagError."""
    scratch.write_bytes(b'\x89MCAP0\r\n' + data)
    try:
        bag = Bag(scratch)
    except BagError:
        return
    assert bag.n_messages == 0


@pytest.mark.parametrize('compression', list(CompressionType))
def test_bag_rewritten_by_the_official_writer_reads_the_same(mcap, tmp_path, compression):
    path = rewrite(mcap, tmp_path / 'copy.mcap', compression)
    assert list(Bag(path).ticks()) == list(Bag(mcap).ticks())
    assert Bag(path).provenance == PROVENANCE


@pytest.mark.parametrize('compression', [CompressionType.LZ4, CompressionType.ZSTD])
def test_chunk_larger_than_it_declares_is_refused(mcap, tmp_path, compression):
    """A small file must not unpack into all memory: no more than declared is unpacked."""
    path = rewrite(mcap, tmp_path / 'copy.mcap', compression)
    with path.open('rb') as file:
        chunk = next(r for r in StreamReader(file, emit_chunks=True).records
                     if isinstance(r, Chunk))
    chunk.uncompressed_size -= 1
    with pytest.raises(BagError, match=r'here: \d+ bytes in a chunk, must be the declared \d+'):
        records.chunk_content(chunk, 'here')


def test_chunk_beyond_the_bound_is_refused():
    chunk = Chunk(
        compression='', data=b'', message_start_time=0, message_end_time=0,
        uncompressed_crc=0, uncompressed_size=records.MAX_RECORD_BYTES + 1)
    with pytest.raises(BagError, match='268435457 bytes in a chunk, must be <= 268435456'):
        records.chunk_content(chunk, 'here')


def test_unknown_compression_is_refused():
    chunk = Chunk(
        compression='rar', data=b'', message_start_time=0, message_end_time=0,
        uncompressed_crc=0, uncompressed_size=0)
    with pytest.raises(BagError, match="compression 'rar', must be zstd or lz4"):
        records.chunk_content(chunk, 'here')


def test_record_beyond_the_bound_is_refused(tmp_path):
    path = tmp_path / 'long.mcap'
    path.write_bytes(
        b'\x89MCAP0\r\n' + bytes([Opcode.ATTACHMENT]) + (2**62).to_bytes(8, 'little'))
    with pytest.raises(BagError, match='damaged at byte 8: a record of 4611686018427387904'):
        Bag(path)


def write(path, *messages, topics=('/a',)):
    """Write a file of (topic index, log time) with the official writer."""
    with path.open('wb') as file:
        writer = Writer(file, compression=CompressionType.NONE)
        writer.start('ros2')
        schema = writer.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        ids = [writer.register_channel(topic, 'cdr', schema) for topic in topics]
        for k, t_ns in messages:
            writer.add_message(ids[k], t_ns, b'\0\1\0\0\0', t_ns)
        writer.finish()
    return path


def test_messages_of_one_instant_form_a_tick_sorted_by_topic(tmp_path):
    path = write(tmp_path / 'b.mcap', (0, 5), (1, 5), (1, 7), topics=('/z', '/a'))
    ticks = [(t, [m.topic for m in g]) for t, g in
             groupby((m for tick in Bag(path).ticks() for m in tick.messages),
                     key=lambda m: m.t_ns)]
    assert ticks == [(5, ['/a', '/z']), (7, ['/a'])]


def test_time_that_runs_back_is_refused(tmp_path):
    path = write(tmp_path / 'b.mcap', (0, 5), (0, 4))
    with pytest.raises(BagError, match='time decreases on /a, from 5 to 4 ns'):
        Bag(path)


def test_a_time_that_ros_cannot_have_is_refused(tmp_path):
    """Nanoseconds of 64 bits with a sign."""
    last = write(tmp_path / 'a.mcap', (0, 5), (1, 2 ** 63 - 1), topics=('/a', '/b'))
    assert Bag(last).end_ns == 2 ** 63 - 1
    path = write(tmp_path / 'b.mcap', (0, 5), (1, 2 ** 63), topics=('/a', '/b'))
    with pytest.raises(BagError, match=r'9223372036854775808 ns on /b, must be < 2\^63 ns'):
        Bag(path)


def test_messages_outside_chunks_are_refused(tmp_path):
    path = tmp_path / 'b.mcap'
    with path.open('wb') as file:
        writer = Writer(file, use_chunking=False)
        writer.start('ros2')
        schema = writer.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        writer.add_message(writer.register_channel('/a', 'cdr', schema), 0, b'', 0)
        writer.finish()
    with pytest.raises(BagError, match='a message outside chunks, not supported'):
        Bag(path)


def test_bag_of_others_has_no_provenance(tmp_path):
    bag = Bag(write(tmp_path / 'b.mcap', (0, 0)))
    with pytest.raises(BagError, match='b.mcap: has no provenance'):
        assert bag.provenance


def test_lost_attachment_is_named(mcap, tmp_path):
    bag = Bag(rewrite(mcap, tmp_path / 'copy.mcap', attachments=False))
    with pytest.raises(BagError, match='attachment configuration.yaml is missing'):
        assert bag.provenance


def test_what_is_no_bag_is_refused_by_name(tmp_path):
    with pytest.raises(BagError, match='nothing: no such bag'):
        Bag(tmp_path / 'nothing')
    with pytest.raises(BagError, match='holds 0 MCAP files, must hold one, or .*none'):
        Bag(tmp_path)
    (tmp_path / 'text.mcap').write_text('text')
    with pytest.raises(BagError, match='text.mcap: is not an MCAP file'):
        Bag(tmp_path)
    (tmp_path / 'more.mcap').write_text('')
    with pytest.raises(BagError, match='2 MCAP files, must hold one, or .*more.mcap, text.mcap'):
        Bag(tmp_path)
