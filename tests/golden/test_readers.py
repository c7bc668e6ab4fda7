"""The leg's bag in other readers, topic by topic."""

from collections import Counter
from pathlib import Path
import subprocess
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

BAG = Path(__file__).parent / 'leg_touchdown'
FILE = BAG / 'leg_touchdown_0.mcap'
N_SAMPLES = 81  # 80 ticks of 1 ms and t = 0
STATES = ('joint_states', 'load_cell', 'pressure_a', 'pressure_b', 'references', 'valve')
TOPICS = {f'/{name}/{state}' for name in ('haa', 'hfe', 'kfe') for state in STATES} | {
    '/clock', '/joint_states', '/coordinator/ground_contact', '/coordinator/supply_pressure'}
RARE = {'/haa/applied_setpoint': 2, '/hfe/applied_setpoint': 2, '/kfe/applied_setpoint': 3,
        '/diagnostics': 3, '/haa/device': 2, '/hfe/device': 2, '/kfe/device': 2}


def test_every_topic_is_there_at_its_rate_with_simulation_time():
    """1 kHz each, the stamp equal to log_time; echoes on change, diagnostics at both ends."""
    counts = Counter()
    with AnyReader([BAG]) as reader:
        for connection, t_ns, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            counts[connection.topic] += 1
            if connection.topic.endswith(('/device', '/applied_setpoint')):
                continue    # without a stamp, or with that of the tick's start
            stamp = message.clock if connection.topic == '/clock' else message.header.stamp
            assert stamp.sec * 1_000_000_000 + stamp.nanosec == t_ns
    assert counts == dict.fromkeys(TOPICS, N_SAMPLES) | RARE


def test_rosbag2_reader_knows_every_message():
    """The counts of the metadata are those of the file."""
    with Reader(BAG) as reader:
        assert reader.message_count == N_SAMPLES * len(TOPICS) + sum(RARE.values())
        assert (reader.start_time, reader.duration) == (0, 80_000_001)  # rosbags adds 1 ns


def test_mcap_reader_accepts_every_checksum():
    """The official library with ROS 2 decoding."""
    with FILE.open('rb') as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        decoded = sum(1 for _ in reader.iter_decoded_messages())
        assert reader.get_header().profile == 'ros2'
    assert decoded == N_SAMPLES * len(TOPICS) + sum(RARE.values())


def test_doctor_finds_nothing():
    """pymcap-cli doctor returns 0."""
    doctor = Path(sys.executable).with_name('pymcap-cli')
    result = subprocess.run([doctor, 'doctor', FILE], capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
