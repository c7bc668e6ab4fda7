"""Two messages of diagnostics are compared by status and key, their numbers as numbers."""

from pathlib import Path

from diagnostic_msgs.msg import DiagnosticArray
from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.core.topic import Topic
from isa_ros.replay.compare import compare_bags
from isa_ros.replay.comparison import Comparison
from isa_ros.replay.diagnostic_fields import differing_values
from isa_ros.text.table import Cells
from msg_adapters.cdr_reader import decode
from msg_adapters.diagnostics import pack, Status, TOPIC
from msg_adapters.joint_state import joint_state
import pytest
from tests.bag.recorded import PROVENANCE, STEP_NS

RAM = Status('ram', 'oil', '0.5 l', {'drawn_l': 0.5, 'mean_w': 100.0, 'state': 'on'})
PUMP = Status('pump', 'oil', '2 l', {'drawn_l': 2.0})


def differing(first: list[Status], second: list[Status]) -> list[tuple[str, object, object]]:
    return [*differing_values(*(decode(pack(0, own), DiagnosticArray)
                                for own in (first, second)))]


@pytest.mark.parametrize(('changed', 'expected'), [
    (RAM, []),
    (RAM._replace(message='0.6 l', values={**RAM.values, 'drawn_l': 0.625}),
     [('ram: oil, drawn_l', 0.5, 0.625), ('ram: oil, message', '0.5 l', '0.6 l')]),
    (RAM._replace(level=b'\2'), [('ram: oil, level', 0.0, 2.0)]),
    (RAM._replace(values={**RAM.values, 'state': 'off'}), [('ram: oil, state', 'on', 'off')]),
    (RAM._replace(values={**RAM.values, 'state': '3'}), [('ram: oil, state', 'on', '3')]),
    (RAM._replace(values={**RAM.values, 'mean_w': '1e2'}), [('ram: oil, mean_w', '100', '1e2')]),
    (RAM._replace(values={'drawn_l': 0.5, 'mean_w': 100.0}),
     [('ram: oil, state', 'on', 'absent')]),
    (RAM._replace(values={'new': 1.0, **RAM.values}), [('ram: oil, new', 'absent', '1')])])
def test_values_are_compared_by_key(
        changed: Status, expected: list[tuple[str, object, object]]) -> None:
    """Numbers as floats, unless they are one number as two texts; the message comes last."""
    assert differing([RAM, PUMP], [changed, PUMP]) == expected
    assert differing([PUMP, RAM], [changed, PUMP]) == expected


def test_a_status_may_be_absent() -> None:
    assert differing([RAM, PUMP], [RAM]) == [('pump: oil', 'present', 'absent')]
    assert differing([PUMP], [RAM, PUMP]) == [('ram: oil', 'absent', 'present')]


def test_a_number_that_is_none_is_a_text_where_both_are_none() -> None:
    def of(text: str) -> list[Status]:
        return [Status('ram', 'oil', '', {'x': text})]
    assert differing(of('nan'), of('NaN')) == [('ram: oil, x', 'nan', 'NaN')]
    found, = differing(of('nan'), of('3'))
    assert str(found) == "('ram: oil, x', nan, 3.0)"


def test_messages_come_after_the_values_of_all() -> None:
    assert [own[0] for own in differing(
        [RAM, PUMP], [RAM._replace(message='-'), PUMP._replace(values={'drawn_l': 3.0})])] == [
        'pump: oil, drawn_l', 'ram: oil, message']


def test_other_messages_are_not_diagnostics() -> None:
    one, other = joint_state('ram', ['ram']), joint_state('ram', ['rim'])
    assert not [*differing_values(one, other)]
    assert not [*differing_values(decode(pack(0, [RAM]), DiagnosticArray), other)]


def topics_of(tmp_path: Path, *statuses: list[Status]) -> list[Cells]:
    """Return the rows of two bags with one message of diagnostics each."""
    bags = []
    for name, own in zip(('one', 'other'), statuses):
        with BagWriter(tmp_path / name, [Topic(*TOPIC)], PROVENANCE) as writer:
            writer.write_tick(STEP_NS, 1, [(0, pack(STEP_NS, own))])
        bags.append(Bag(tmp_path / name))
    return Comparison([], compare_bags(*bags)).topic_rows('a', 'b')[1:]


def test_the_row_of_two_bags_has_key_both_values_and_their_difference(tmp_path: Path) -> None:
    """That of the largest deviation in proportion."""
    other = RAM._replace(
        message='0.6 l', values={'drawn_l': 0.625, 'mean_w': 100.5, 'state': 'on'})
    assert topics_of(tmp_path, [RAM, PUMP], [other, PUMP]) == [
        ('/diagnostics', '1', '1', 'ram: oil, drawn_l', '1', '0.5', '0.625', '0.125', 'none')]


def test_the_row_of_texts_has_key_and_both(tmp_path: Path) -> None:
    other = RAM._replace(values={**RAM.values, 'state': 'off'})
    assert topics_of(tmp_path, [RAM], [other]) == [
        ('/diagnostics', '1', '1', 'ram: oil, state', '1', 'on', 'off', '', '')]


def test_another_order_is_a_difference_of_places(tmp_path: Path) -> None:
    (row,) = topics_of(tmp_path, [RAM, PUMP], [PUMP, RAM])
    assert row[3:7] == ('status[0].name', '1', 'ram: oil', 'pump: oil')


def test_the_same_number_as_another_text_is_a_difference(tmp_path: Path) -> None:
    other = RAM._replace(values={**RAM.values, 'mean_w': '1e2'})
    assert topics_of(tmp_path, [RAM], [other])[0][3:7] == ('ram: oil, mean_w', '1', '100', '1e2')
