"""Bags from untrusted sources: one line, exit code 2, and no other file is opened or written."""

from dataclasses import replace
import json
import os
from pathlib import Path
import struct
import sys

from hypothesis import given, HealthCheck, settings, strategies as st
from isa_ros.bag import reader
from isa_ros.bag.provenance import Provenance
from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.cli.main import main
from isa_ros.config.assembly import surroundings_of
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.saved_state import sealed
from isa_ros.core.signals import COMMAND
from isa_ros.core.topic import Topic
from isa_ros.errors import BagError, IsaError
import lz4.frame
from mcap.writer import CompressionType, Writer
import pytest
from tests.bag.golden import GOLDEN, rewrite
from tests.bag.recorded import record, STEP_NS, tick_messages
import zstandard

RIG = load_run(Path(__file__).parents[2] / 'config' / 'rig_rotary.yaml').to_yaml()
CLOCK = 'rosgraph_msgs/msg/Clock'
MEBIBYTE = 1024 * 1024


@pytest.fixture
def refused(capsys):
    """Return the one line that a command ends with, which is its only output."""
    def refuse(*arguments) -> str:
        assert main([str(argument) for argument in arguments]) == 2
        error = capsys.readouterr().err
        assert error.startswith('isa: ') and error.count('\n') == 1
        assert error[:-1].isprintable() and len(error) < 2500
        return error
    return refuse


def with_configuration(directory: Path, text: str, **fields) -> Path:
    """Write a bag of two clock messages with this configuration as its provenance."""
    clock = Topic('/clock', CLOCK)
    own = Provenance(text, fields.pop('scenario', ''), 0, {}, **fields)
    with BagWriter(directory, [clock], own) as writer:
        for tick in (0, 3):
            writer.write_tick(tick * STEP_NS, tick, [(0, tick_messages(tick)[0][1])])
    return directory


def foreign(path: Path, *, topic='/clock', type_name=CLOCK, compression=CompressionType.NONE,
            data=bytes(12), n=1, attachments=()) -> Path:
    """Write a file with the official writer."""
    with path.open('wb') as file:
        writer = Writer(file, compression=compression)
        writer.start('ros2')
        for name, content in attachments:
            writer.add_attachment(0, 0, name, 'text/plain', content)
        schema = writer.register_schema(type_name, 'ros2msg', b'')
        channel = writer.register_channel(topic, 'cdr', schema)
        for _ in range(n):
            writer.add_message(channel, 0, data, 0)
        writer.finish()
    return path


def chunk_record(compression: str, data: bytes, size: int) -> bytes:
    content = (struct.pack('<QQQI', 0, 0, size, 0) + struct.pack('<I', len(compression))
               + compression.encode() + struct.pack('<Q', len(data)) + data)
    return bytes([6]) + struct.pack('<Q', len(content)) + content


@pytest.mark.parametrize('codec', ['zstd', 'lz4'])
def test_bomb_is_refused_before_it_is_unpacked(tmp_path, refused, codec, monkeypatch):
    """200 MiB of zeros in a few kilobytes."""
    zeros = bytes(200 * MEBIBYTE)
    packed = (zstandard.ZstdCompressor().compress(zeros) if codec == 'zstd'
              else lz4.frame.compress(zeros))
    bomb = tmp_path / 'bomb.mcap'
    bomb.write_bytes(b'\x89MCAP0\r\n' + b''.join(
        chunk_record(codec, packed[:200_000], len(zeros)) for _ in range(20)))
    monkeypatch.setattr(zstandard, 'ZstdDecompressor', None)
    monkeypatch.setattr(lz4.frame, 'LZ4FrameDecompressor', None)
    assert 'must be <= 1000 times as many' in refused('replay', bomb)


@pytest.mark.parametrize('codec', ['', 'zstd', 'lz4'])
def test_chunk_of_zeros_is_no_loop_without_end(tmp_path, refused, codec):
    zeros = bytes(60_000)
    packed = {'': zeros, 'zstd': zstandard.ZstdCompressor().compress(zeros),
              'lz4': lz4.frame.compress(zeros)}[codec]
    path = tmp_path / 'zeros.mcap'
    path.write_bytes(b'\x89MCAP0\r\n' + chunk_record(codec, packed, len(zeros)))
    assert 'unknown record 0x00 in a chunk' in refused('replay', path)


@pytest.mark.parametrize('opcode', [0x80, 0x05], ids=['private', 'message'])
def test_a_chunk_of_millions_of_empty_records_is_refused(tmp_path, refused, opcode):
    """
    200 000 records of 9 bytes in 1.8 kB, which is within the limit of its expansion.

    Of messages the first is refused before that limit, for it has no channel.
    """
    content = (bytes([opcode]) + bytes(8)) * 200_000
    packed = zstandard.ZstdCompressor().compress(content).ljust(1800, b'\0')
    path = tmp_path / 'empty.mcap'
    path.write_bytes(b'\x89MCAP0\r\n' + chunk_record('zstd', packed, len(content)))
    text = refused('replay', path)
    if opcode == 0x80:
        assert 'more records in a chunk than its compressed bytes allow, must be <= ' in text
    else:
        assert 'a message record of 9 bytes' in text


def test_messages_without_end_at_one_instant_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(reader, 'MAX_TICK_MESSAGES', 50)
    bag = Bag(foreign(tmp_path / 'x.mcap', n=51))
    with pytest.raises(BagError, match='more than 50 messages at t = 0 ns'):
        list(bag.ticks())


@pytest.mark.parametrize('text, expected', [
    ('a: ' + '[' * 100_000, 'line 1: nested deeper than 16'),
    ('a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n', 'line 2: aliases'),
    ('a: !!python/object/apply:os.system [touch x]\n', 'line 1: tags'),
    ('a: ' + '[' + '1,' * 20_001 + ']', 'line 1: more than 20000 values'),
    ('a: ' + 'x' * MEBIBYTE, 'larger than 1048576 bytes'),
    ('- 1', 'must be sections'),
    ('', 'must be sections'),
    (RIG.replace('step_ns: 1000000', 'step_ns: 0'), 'step_ns = 0 ns, must be > 0'),
    (RIG.replace('step_ns: 1000000', 'step_ns: 1' + '0' * 200), 'step_ns = 1e+200 ns, must be'),
    (RIG.replace('step_ns: 1000000', 'step_ns: 1000001'), 'a multiple of 100000 ns'),
    (RIG.replace('controller_offset_ns: 120000', 'controller_offset_ns: -20000'),
     'controller_offset_ns = -20000 ns, must be >= 0'),
    (RIG.replace('  rotor:', '  "../../rotor":'), "the name = '../../rotor', must be small"),
    (RIG.replace('  rotor:', '  "r\\nm\\e[2J":'), 'must be small letters'),
    (RIG.replace('model: smart_manifold', 'model: smart_manifold\n    "x\\ny": 1'),
     r'actuators.rotor.x\ny is unknown here'),
])
def test_hostile_configuration_ends_in_one_line(tmp_path, refused, text, expected):
    assert expected in refused('replay', with_configuration(tmp_path / 'bag', text))


def test_attachment_that_is_no_text_is_refused(tmp_path, refused, monkeypatch):
    monkeypatch.setattr(Provenance, 'attachments', lambda self: {
        'configuration.yaml': b'a: \xff', 'scenario.yaml': b''})
    bag = with_configuration(tmp_path / 'bag', RIG)
    monkeypatch.undo()
    assert 'configuration.yaml' in refused('replay', bag)
    assert 'attachment configuration.yaml: byte 3 is not UTF-8' in refused('report', bag)


def test_type_of_a_bag_imports_no_module(tmp_path, refused):
    """`antigravity` opens a browser when it is imported."""
    bags = [foreign(tmp_path / f'{k}.mcap', topic='/x', type_name='antigravity/msg/Flight',
                    data=bytes([0, 1, 0, 0, k])) for k in range(2)]
    assert 'antigravity/msg/Flight: no such message type is installed' in refused(
        'compare', *bags)
    assert 'antigravity' not in sys.modules


@pytest.mark.parametrize('names', [{'topic': '/a\nb'}, {'topic': '/\x1b[2Jx'}, {'topic': ''},
                                   {'topic': '/' + 'a' * 300}, {'type_name': '../msg/X'},
                                   {'type_name': 'a\nb'}])
def test_name_that_ros_does_not_have_is_refused(tmp_path, refused, names):
    assert 'must be a ROS name of letters, digits, _ and /' in refused(
        'replay', foreign(tmp_path / 'x.mcap', **names))


def test_versions_of_a_bag_are_shown_as_one_line_each(tmp_path, capsys):
    bag = rewrite(Bag(GOLDEN / 'rotor_step'), tmp_path / 'bag',
                  versions={'num\npy\x1b[2J': '1\n2'})
    main(['replay', str(bag)])
    lines = capsys.readouterr().out.splitlines()
    assert r'num\npy\x1b[2J is not known here, was 1\n2' in lines
    assert all(line.isprintable() for line in lines)


def test_pipe_in_a_bag_is_not_waited_for(tmp_path, refused):
    record(tmp_path / 'rig', 3)
    os.mkfifo(tmp_path / 'rig' / 'rig_1.mcap')
    assert 'rig_1.mcap: is not a file' in refused('replay', tmp_path / 'rig')


def test_names_in_metadata_are_never_opened(tmp_path, refused):
    secret = record(tmp_path / 'secret', 3)
    directory = tmp_path / 'rig'
    record(directory, 3)
    metadata = directory / 'metadata.yaml'
    metadata.write_text(metadata.read_text().replace('rig_0.mcap', '../secret/secret_0.mcap'))
    assert Bag(directory).path == directory / 'rig_0.mcap'
    (directory / 'rig_0.mcap').unlink()
    assert 'holds 0 MCAP files' in refused('replay', directory)
    with pytest.raises(BagError, match='which is not an MCAP file beside it'):
        record(directory, 3, overwrite=True)
    assert secret.is_file()


def test_metadata_of_a_bag_may_be_anything(tmp_path):
    """metadata.yaml is for other readers."""
    record(tmp_path / 'rig', 3)
    (tmp_path / 'rig' / 'metadata.yaml').write_text('&a [*a, !!python/name:os.system x]' * 1000)
    assert Bag(tmp_path / 'rig').is_whole


def test_overwriting_writes_through_no_link(tmp_path):
    """Links in a bag that is overwritten are not followed."""
    outside = [tmp_path / name for name in ('one', 'two')]
    for path in outside:
        path.write_text('mine')
    directory = tmp_path / 'rig'
    record(directory, 3)
    for name, path in zip(('.metadata.yaml.tmp', 'rig_0.mcap'), outside):
        (directory / name).unlink(missing_ok=True)
        (directory / name).symlink_to(path)
    record(directory, 5, overwrite=True)
    assert [path.read_text() for path in outside] == ['mine'] * 2
    assert Bag(directory).end_ns == 4 * STEP_NS


def test_figure_of_a_scenario_names_no_path(tmp_path, refused):
    bag = rewrite(Bag(GOLDEN / 'rotor_step'), tmp_path / 'bags' / 'bag')
    there = Bag(bag).provenance
    again = tmp_path / 'bags' / 'hostile'
    with BagWriter(again, [Topic('/clock', CLOCK)], replace(
            there, scenario='name: x\nfigure: ../../x\n')) as writer:
        writer.write_tick(0, 0, [(0, tick_messages(0)[0][1])])
    before = sorted(tmp_path.rglob('*'))
    assert "figure = '../../x' is not a figure" in refused('report', again)
    assert sorted(tmp_path.rglob('*')) == before


@pytest.mark.parametrize('state, expected', [
    ('[' * 200_000, 'is no saved state'),
    ('{"format": 5}', 'is damaged'),
    (sealed({'format': 5}), 'is no saved state'),
    ('x' * (16 * MEBIBYTE + 1), 'larger than 16777216 bytes'),
    (sealed({'format': 5, 'configuration.sha256': 'x'}), 'saved from the configuration x'),
    (json.dumps({'format': 5, 'configuration.sha256': 'x'}), 'is damaged, its sha256 is not'),
])
def test_hostile_state_ends_in_one_line(tmp_path, refused, state, expected):
    assert expected in refused('replay', with_configuration(tmp_path / 'bag', RIG, state=state))


@pytest.mark.parametrize('change, expected', [
    ({'tick': 10**30}, 'must be an integer >= 0 and < 4294967296'),
    ({'tick': -1}, 'must be an integer >= 0'),
    ({'tick': 2}, 'begins before tick 2'),
    ({'participants': []}, 'has 0 participants, the run has 1'),
    ({'participants': ['00']}, 'rotor: saved state has 1 bytes, must have'),
    ({'load': ''}, 'saved state of the surroundings has 0 bytes, must have'),
    ({'stops': ''}, 'saved state of the emergency stops has 0 bytes, must have 8'),
    ({'requests': '00'}, f'has 1 bytes of requests, must have {COMMAND.itemsize}'),
])
def test_state_that_does_not_fit_ends_in_one_line(tmp_path, refused, change, expected):
    run = load_run(Path(__file__).parents[2] / 'config' / 'rig_rotary.yaml')
    state = {'format': 5, 'configuration.sha256': run.digest, 'versions': {}, 'tick': 0,
             'load': surroundings_of(run).snapshot().hex(), 'requests': '00' * COMMAND.itemsize,
             'stops': '00' * 8, 'participants': ['00']} | change
    assert expected in refused('replay', with_configuration(
        tmp_path / 'bag', RIG, state=sealed(state)))


@given(drawn=st.data())
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_in_a_chunk_are_read_or_refused(tmp_path, drawn):
    """Whole records with arbitrary content, and no checksum (0)."""
    content = b''.join(
        bytes([opcode]) + struct.pack('<Q', len(data)) + data for opcode, data in drawn.draw(
            st.lists(st.tuples(st.integers(0, 15), st.binary(max_size=60)), max_size=6)))
    path = tmp_path / 'any.mcap'
    path.write_bytes(b'\x89MCAP0\r\n' + chunk_record('', content, len(content)))
    try:
        assert list(Bag(path).ticks()) == []
    except IsaError as error:
        assert isinstance(error, BagError)
