"""Bags without some topics: replay and compare use the configuration of recording."""

from collections import Counter
from dataclasses import replace
import struct

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.cli.main import main
from isa_ros.config.runs.recording import RecordConfig
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.replay.compare import compare_bags
from isa_ros.replay.replay import replay, Rerun
import pytest
from tests.bag.golden import GOLDEN, rewrite

RECORD = RecordConfig(
    leave_out=('/*/references', '/clock'),
    decimate=(('/rotor/valve', 10), ('*', 3)))
N = 151  # samples


def recorded_as(bag: Bag, record: RecordConfig, directory) -> Bag:
    """Simulate a bag's run again and record it with these patterns."""
    def section(text: str) -> str:
        return replace(run_of_text(text), record=record).to_yaml()

    configured = Bag(rewrite(
        bag, directory.with_name(f'{directory.name}_configured'), configuration=section))
    again = Rerun(configured)
    with BagWriter(directory, again.topics, configured.provenance) as writer:
        again.simulate(writer)
    return Bag(directory)


@pytest.fixture(scope='module')
def whole(tmp_path_factory) -> Bag:
    return recorded_as(Bag(GOLDEN / 'rotor_step'), RecordConfig(),
                       tmp_path_factory.mktemp('bags') / 'whole')


@pytest.fixture(scope='module')
def thinned(whole, tmp_path_factory) -> Bag:
    return recorded_as(whole, RECORD, tmp_path_factory.mktemp('bags') / 'thinned')


def test_bag_holds_what_was_configured(whole, thinned):
    """Applied commands are complete for any patterns; t = 0 is among the samples."""
    counts = Counter(message.topic for message in thinned.messages())
    assert counts['/rotor/valve'] == 16
    assert counts['/rotor/joint_states'] == 51
    assert counts['/rotor/applied_setpoint'] == sum(
        message.topic == '/rotor/applied_setpoint' for message in whole.messages())
    assert set(whole.types) - set(thinned.types) == {'/rotor/references', '/clock'}


def test_thinned_bag_replays_to_its_last_sample(thinned, capsys):
    assert main(['replay', str(thinned.path)]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith('equal: ')
    report = replay(thinned)
    assert report.report.messages == thinned.n_messages
    assert report.report.end_ns == thinned.end_ns


def test_thinned_bag_with_a_change_does_not_replay(thinned, tmp_path):
    def one_more(topic, sequence, data):
        at = topic == '/rotor/valve' and sequence == 60
        return data[:-8] + struct.pack('<d', 1.0) if at else data

    changed = Bag(rewrite(thinned, tmp_path / 'changed', one_more))
    difference = replay(changed).report.difference
    assert (difference.tick, difference.topic) == (60, '/rotor/valve')


@pytest.mark.parametrize('swap', [False, True])
def test_thinned_bag_equals_the_whole_one_in_what_both_hold(whole, thinned, capsys, swap):
    bags = [whole, thinned][::-1 if swap else 1]
    assert compare_bags(*bags).messages == thinned.n_messages
    assert main(['compare', *(str(bag.path) for bag in bags)]) == 0
    *keys, remark, verdict = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in keys[2:]] == [
        'record.leave_out', 'record.decimate./rotor/valve', 'record.decimate.*']
    assert remark == 'recorded with different record options: comparing the samples in both'
    assert verdict.startswith('equal: ')


def test_message_lost_from_a_thinned_bag_is_missed(whole, thinned, tmp_path):
    """Only the messages that the configuration leaves out may be missing."""
    lost = Bag(rewrite(thinned, tmp_path / 'lost', without=('/rotor/valve',)))
    difference = compare_bags(whole, lost).difference
    assert (difference.tick, difference.topic, difference.actual) == (
        0, '/rotor/valve', 'absent')
