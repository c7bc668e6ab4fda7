"""The ports of supplies on the private wire: there where a run has them, and nowhere else."""

import re

from isa_ros.core.signals import COMMAND, LOAD_REPLY, SAMPLE, SUPPLY_REPLY
from isa_ros.run.wire.header import WireError
from isa_ros.run.wire.parts import actuator_parts, refuse_actuator_parts, take_actuator_parts
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import decode_step, encode_tick
from isa_ros.tick.exchange import Rows
import numpy as np
import pytest
from tests.run.filled import filled

NAMES = ['a', 'b', 'c']
PORTED = Roster(NAMES, ['supply_0'], {}, True)


def made() -> Rows:
    """Return the rows of three actuators, of which the ports count up."""
    rows = filled(3, bodies={})
    rows.has_supply_ports = True
    rows.feeds.view(np.float64)[:] = np.arange(rows.feeds.nbytes // 8)
    rows.samples.view(np.float64)[:] = 1.0
    rows.supplies.view(np.float64)[:] = 2.0
    return rows


def test_a_tick_has_the_port_of_each_actuator() -> None:
    sent = made()
    step = decode_step(encode_tick(1, 2, sent, False))
    for k in range(3):
        step.refuse_feed(k)
        assert step.feed(k).tobytes() == sent.feeds[k].tobytes()
        assert step.command(k).tobytes() == sent.commands[k].tobytes()
    assert len(step.body) == sent.ports.nbytes + sent.commands.nbytes + sent.feeds.nbytes


def test_controllers_find_what_they_are_shown_behind_the_ports() -> None:
    sent = made()
    step = decode_step(encode_tick(1, 2, sent, True))
    step.refuse_state(3, PORTED)
    shown = step.state(PORTED)
    assert shown.samples.tobytes() == sent.samples.tobytes()
    assert shown.supplies.tobytes() == sent.supplies.tobytes()


@pytest.mark.parametrize('mode', [-1.0, 2.5, 7.0, -3e300])
def test_controllers_are_shown_no_mode_that_there_is_not(mode: float) -> None:
    """A mode of another process selects a word of what is refused."""
    sent = made()
    sent.samples['device_mode'] = 6.0, 0.0, 3.0
    decode_step(encode_tick(1, 2, sent, True)).refuse_state(3, PORTED)
    sent.samples['device_mode'][1] = mode
    with pytest.raises(WireError, match=re.escape(f'there is not, of [6.0, {mode}, 3.0]')):
        decode_step(encode_tick(1, 2, sent, True)).refuse_state(3, PORTED)


@pytest.mark.parametrize('broken', ['short', 'nan'])
def test_a_tick_without_valid_ports_is_refused(broken: str) -> None:
    sent = made()
    if broken == 'short':
        sent.has_supply_ports = False
    else:
        sent.feeds['share'][1] = np.nan
    step = decode_step(encode_tick(1, 2, sent, False))
    with pytest.raises(WireError, match='ports of the supplies|not finite'):
        step.refuse_feed(1)


def parts(fed: bytes) -> list[bytes | None]:
    """Return the parts of an answer of an actuator with a reply to its port."""
    own = actuator_parts(np.zeros(1, LOAD_REPLY), np.zeros(1, SAMPLE), np.zeros(1, COMMAND), {},
                         None, np.zeros(1, SUPPLY_REPLY))
    return [*own[:-1], fed]


def test_an_answer_has_what_was_paid() -> None:
    """In the row of the actuator, and only there."""
    reply = np.zeros(1, SUPPLY_REPLY)
    reply['flow'], reply['conductance'], reply['paid'] = 1.0, 2.0, 3.0
    answer, rows = parts(reply.tobytes()), made()
    refuse_actuator_parts(answer)
    take_actuator_parts(answer, 2, rows)
    assert rows.fed['paid'].tolist() == [0.0, 0.0, 3.0]
    assert rows.fed[2].tobytes() == reply[0].tobytes()


@pytest.mark.parametrize('fed', [
    b'', np.zeros(1, SUPPLY_REPLY).tobytes()[:-8], np.full(3, np.inf).tobytes()])
def test_an_answer_with_another_reply_is_refused(fed: bytes) -> None:
    with pytest.raises(WireError, match='reply to the port'):
        refuse_actuator_parts(parts(fed))


def test_a_roster_says_that_there_are_ports_only_where_there_are() -> None:
    """A hello of a run without them has the bytes that it had."""
    without = Roster(NAMES, ['supply_0'], {})
    assert Roster.decode(PORTED.encode()) == PORTED
    assert Roster.decode(without.encode()) == without
    assert without.encode() == b'[["a", "b", "c"], ["supply_0"], []]'


@pytest.mark.parametrize('more', [', false', ', 1.5', ', true, true'])
def test_a_roster_with_more_is_refused(more: str) -> None:
    text = f'[["a", "b", "c"], ["supply_0"], []{more}]'
    with pytest.raises(WireError, match='more than participants'):
        Roster.decode(text.encode())
