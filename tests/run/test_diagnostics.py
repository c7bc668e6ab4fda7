"""Diagnostics of a run: every second and at the end, live as in the bag."""

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.core.accounts import MEAN, OIL, PEAK
from isa_ros.replay.replay import replay
from isa_ros.run.diagnostics import ENERGY, energy_statuses
from msg_adapters import diagnostics
from msg_adapters.cdr_reader import decode
import pytest

TOPIC = diagnostics.TOPIC[0]


def diagnosed(bag):
    """Return time in ms and data of every message of the topic."""
    return [(message.t_ns // 1_000_000, message.data)
            for message in Bag(bag).messages() if message.topic == TOPIC]


@pytest.fixture(scope='module')
def run():
    return isa_ros.load('rig_rotary')


@pytest.mark.parametrize(('duration', 'times'), [
    (0.25, [0, 1, 250]), (1.0, [0, 1, 1000]), (2.1, [0, 1, 1000, 2000, 2100])])
def test_a_bag_has_them_every_second_on_change_and_at_its_end(run, tmp_path, duration, times):
    """The actuator is ready in the first tick; and its replay has the same ones."""
    result = run.simulate(duration)
    bag = result.save(tmp_path / 'bag')
    found = diagnosed(bag)
    assert [t for t, _ in found] == times
    last = diagnostics.values(found[-1][1], ENERGY)
    for name, account in result.accounts.items():
        assert {key: float(value) for key, value in last[name].items()} == pytest.approx(
            account, rel=1e-8, abs=1e-9)
    report = replay(Bag(bag))
    assert report.is_equal, str(report)


def test_the_device_says_there_what_it_says_on_its_topic(tmp_path):
    """A pressure sensor is lost: level, words, and since when, on both topics alike."""
    faults = [{'t_s': 0.1, 'actuator': 'rotor', 'fault': 'pressure_a_lost'}]
    scenario = {'name': 'lost', 'duration_s': 0.3, 'faults': faults}
    bag = isa_ros.load('rig_rotary', scenario).simulate().save(tmp_path / 'bag')
    own = [decode(message.data, DiagnosticStatus) for message in Bag(bag).messages()
           if message.topic == '/rotor/device'][-1]
    assert own.level == DiagnosticStatus.ERROR
    last = decode(diagnosed(bag)[-1][1], DiagnosticArray)
    joined = next(status for status in last.status if status.name == 'rotor: device')
    assert (joined.level, joined.message, joined.values) == (own.level, own.message, own.values)
    assert joined.message.startswith('fault: load cell implausible; disabled until ~/clear_fault')


def test_a_status_says_what_was_drawn(run):
    result = run.simulate(0.5)
    status = energy_statuses(result.accounts)[0]
    assert (status.hardware, status.task) == ('rotor', ENERGY)
    assert status.message == '0.00142 l drawn, mean 58.6 W, peak 58.6 W'
    assert result.accounts['rotor'][OIL.key] == pytest.approx(0.00142, abs=5e-6)


def test_mean_and_peak_of_the_power_have_their_own_words():
    """A run of one level has both equal; this one does not."""
    status, = energy_statuses({'ram': {OIL.key: 0.5, MEAN.key: 50.0, PEAK.key: 80.0}})
    assert status.message == '0.5 l drawn, mean 50 W, peak 80 W'
