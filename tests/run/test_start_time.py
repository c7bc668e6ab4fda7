"""A run whose stamps begin at another time than 0: shifted, and otherwise equal to the bit."""

from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.analysis.report.energy import recorded_accounts
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.bag.reader import Bag
from isa_ros.config.assembly import surroundings_of, timing_of
from isa_ros.config.runs.tick_grid import LATEST_START_S
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import replay
from isa_ros.run.options import Request
from isa_ros.run.outlets import Outlets
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.session import prepare
from isa_ros.testing import assert_reproduces
from isa_ros.tick.exchange import Rows
from msg_adapters import clock, event
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode, message_class
import pytest
import yaml

START_S = 1_700_000_000
LINK = {'kind': 'can', 'cycle_ms': 1.0, 'delay_cycles': 2, 'jitter_us': 200.0, 'loss': 0.1,
        'watchdog_ms': 20.0}
RUN: dict[str, Any] = {
    'name': 'two', 'supply': {'kind': 'constant', 'pressure_mpa': 20.7,
                              'return_pressure_mpa': 0.0},
    'actuators': {'ram': {'model': 'isa_v5', 'load': {'kind': 'mass'}, 'link': LINK},
                  'hot': {'model': 'isa_v5', 'load': {'kind': 'mass'}, 'variants': ['thermal']}}}
SCENARIO = {
    'name': 'steps', 'duration_s': 1.002,
    'tracks': {name: [{'t_s': 0.0, 'position': 'hold'},
                      {'t_s': 0.005, 'position': 0.05, 'sine': {
                          'amplitude': 0.004, 'frequency_hz': 5.0}}] for name in ('ram', 'hot')},
    'changes': [{'t_s': 0.01, 'actuator': 'hot', 'set': {'load.force': 20.0}},
                {'t_s': 0.02, 'supply': 'supply', 'set': {'pressure_mpa': 20.0}}]}


@pytest.fixture(scope='module')
def bags(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return the bags of one run from 0 and from `START_S`."""
    folder = tmp_path_factory.mktemp('start')
    run = isa_ros.load(RUN, SCENARIO)
    return (run.simulate().save(folder / 'from_0'),
            run.replace({'start_time_s': START_S}).simulate().save(folder / 'later'))


def stamps(message: Any) -> list[Any]:
    """Return the stamps of a message: its own, its header's, or that of a clock."""
    own = [message.header] if hasattr(message, 'header') else [message]
    return [getattr(part, name) for part in own for name in ('stamp', 'clock')
            if hasattr(part, name)]


def test_every_stamp_is_shifted_and_nothing_else(bags):
    """Over a full second, with a link's own times, temperatures, parameters and diagnostics."""
    first, later = (Bag(path) for path in bags)
    types = set()
    pairs = list(zip(first.messages(), later.messages(), strict=True))
    for one, other in pairs:
        assert other.t_ns - one.t_ns == START_S * 10**9
        assert (one.topic, one.sequence) == (other.topic, other.sequence)
        if one.data == other.data or 40 < one.sequence < 995:   # decoding takes its time
            assert one.topic.endswith('/device') or one.data != other.data
            continue
        cls = message_class(first.types[one.topic])
        message, shifted = decode(one.data, cls), decode(other.data, cls)
        times = stamps(shifted)
        assert times or one.topic.endswith('/device'), one.topic    # its time is one of the device
        for time in times:
            time.sec -= START_S
        assert encode(message) == encode(shifted), one.topic
        types.add(one.topic.rpartition('/')[2])
    assert types >= {'clock', 'diagnostics', 'temperature', 'applied_parameters', 'sent_setpoint',
                     'applied_setpoint', 'joint_states', 'supply_pressure'}


def test_a_bag_from_another_time_replays(bags):
    report = replay(Bag(bags[1]))
    assert report.is_equal and not report.changes, str(report)


def test_what_is_read_from_a_bag_counts_from_the_start(bags):
    first, later = (read_signals(path) for path in bags)
    assert later.time.tolist() == first.time.tolist() and later.time[-1] == 1.002
    accounts = [recorded_accounts(Bag(path)) for path in bags]
    assert accounts[0] == accounts[1] and accounts[0] is not None


def test_a_bag_from_another_time_is_reproduced_up_to_its_end(tmp_path):
    """Without a scenario's duration it is that of the bag."""
    run = RUN | {'start_time_s': START_S}
    (tmp_path / 'run.yaml').write_text(yaml.safe_dump(run))
    bag = isa_ros.load(tmp_path / 'run.yaml').simulate(duration=0.005).save(tmp_path / 'bag')
    assert_reproduces(tmp_path / 'run.yaml', None, bag)


def test_the_start_changes_no_signal_and_is_written_only_if_given():
    own, later = (isa_ros.load(RUN | more).configuration
                  for more in ({}, {'start_time_s': START_S}))
    assert later.digest == own.digest
    assert 'start_time_s' not in own.to_yaml()
    assert f'start_time_s: {START_S}\n' in later.to_yaml()


def test_the_option_is_the_key(tmp_path):
    (tmp_path / 'two.yaml').write_text(yaml.safe_dump(RUN))
    session = prepare(Request(config=tmp_path / 'two.yaml', out=tmp_path / 'bag',
                              start_time_s=START_S))
    assert session.run.start_ns == START_S * 10**9


@pytest.mark.parametrize('value', [-1, LATEST_START_S + 1, 0.5, 'now', True])
def test_a_start_that_no_stamp_has_is_refused(value):
    bound = f'a whole number of seconds >= 0 and <= {LATEST_START_S}'
    with pytest.raises(ConfigError, match=f'start_time_s = {value!r}, must be {bound}'):
        isa_ros.load({**RUN, 'start_time_s': value})


def test_the_clock_events_and_an_actuator_s_own_node_begin_there_too():
    """What a run publishes beside its bag, and the time that each node gets."""
    class Kept:
        wanted = None

        def __init__(self):
            self.messages = []

        def has_subscribers(self):
            return True

        def publish(self, messages):
            self.messages += messages

    run = isa_ros.load(RUN | {'start_time_s': START_S}).configuration
    assert timing_of(run).start_ns == START_S * 10**9
    rows = Rows(len(run.actuators), surroundings_of(run))
    kept = Kept(), Kept()
    output = RunOutput(packer_of(run, rows.published), run.step_ns, outlets=Outlets(*kept))
    output.take_time(3)
    output.add_event(2, 'pause')
    for own, topic, seconds in zip(kept, (clock.TOPIC, event.TOPIC), (0.003, 0.002)):
        time, = stamps(decode(own.messages[0], message_class(topic[1])))
        assert (time.sec, time.nanosec) == (START_S, round(seconds * 1e9))
