"""What was handed to a link: every command reads back, other messages are refused."""

import math

from hypothesis import given, strategies as st
from isa_ros.core.record import floats
from isa_ros.core.signals import (
    COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_QUICK_STOP, HAS_REFERENCE,
    HAS_SETPOINT, SAMPLE)
from isa_ros.errors import SetpointError
from isa_ros.run.link_packing import pack_links, PackedLinks, WORDS
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.setpoint import applied_setpoint, sent_to_command
from msg_adapters.template import FIRST_VALUE, Template, time_word
import numpy as np
import pytest
from sensor_msgs.msg import JointState

NUMBER = st.floats(-1e6, 1e6)
GAIN = st.just(math.nan) | st.floats(0.0, 1e6)
T_NS, TICK_START_NS = 3_000_000_007, 2_999_000_007
STAMPS_NS = 1_700_000_000_000_000_000   # of stamps at t = 0
OTHERS = (math.nan, math.nan, float(HAS_SETPOINT | HAS_ENABLE))
"""Entries mode, reference and changed of a setpoint with enable."""


def words_of(command: np.ndarray, age: float = 0.0, due_step: int = 0, compiled: bool = True):
    """Return the words of a link: two times, then the sent setpoint."""
    applied = np.zeros(1, COMMAND).view(np.recarray)
    applied['due_step'] = due_step
    words = np.zeros(WORDS, np.uint64)
    pack = pack_links if compiled else pack_links.py_func
    sample = np.zeros(1, SAMPLE)
    sample['age'] = age
    links = PackedLinks(np.array([0]), np.array([0]), command.view(np.recarray))
    pack(T_NS, TICK_START_NS, STAMPS_NS, links, floats(sample), applied, words,
         words.view(np.float64))
    return words


def packed(command: np.ndarray) -> bytes:
    """Return the message of a command."""
    fields = ('is_enabled', 'position', 'velocity', 'effort', 'stiffness', 'damping', 'mode',
              'reference', 'kinds')
    template = Template([applied_setpoint('hip', {field: k for k, field in enumerate(fields)})])
    words = np.zeros(FIRST_VALUE + len(fields), np.uint64)
    words[FIRST_VALUE:] = words_of(command)[2:]
    template.fill(words)
    return template.message(0)


def command_of(kinds: int, is_enabled: int, *values: float) -> np.ndarray:
    row = np.zeros(1, COMMAND)
    row[0] = (kinds, is_enabled, *values, *[0] * (len(COMMAND.names or ()) - 2 - len(values)))
    return row


@given(st.integers(1, HAS_SETPOINT | HAS_ENABLE | HAS_GAINS), st.integers(0, 1),
       st.tuples(NUMBER, NUMBER, NUMBER, GAIN, GAIN))
def test_a_command_reads_back_as_it_was_sent(kinds, is_enabled, values):
    """With the gains that a setpoint may have, and with its kinds."""
    command = command_of(kinds, is_enabled, *values)
    found = sent_to_command(packed(command), 'hip')
    takes_gains = kinds & (HAS_SETPOINT | HAS_GAINS)
    assert found['kinds'] == kinds
    if kinds & HAS_ENABLE:
        assert found['is_enabled'] == is_enabled
    if kinds & HAS_SETPOINT:
        assert [found[name] for name in ('position', 'velocity', 'effort')] == list(values[:3])
    for name, value in zip(('stiffness', 'damping'), values[3:]):
        expected = value if takes_gains else math.nan
        assert found[name] == expected or math.isnan(found[name]) and math.isnan(expected)


@given(st.integers(1, 6), NUMBER)
def test_a_mode_its_reference_and_requests_read_back(mode, reference):
    kinds = HAS_MODE | HAS_REFERENCE | HAS_QUICK_STOP | HAS_CLEAR_FAULT
    command = command_of(kinds, 0)
    command['mode'], command['reference'] = mode, reference
    found = sent_to_command(packed(command), 'hip')
    assert (found['kinds'], found['mode'], found['reference']) == (kinds, mode, reference)


def test_the_times_are_those_of_sampling_and_of_effect():
    """3 ms ago; step 149,975 is at 2.9995 s. Without a step it is the start of the tick."""
    none = np.zeros(1, COMMAND)
    for compiled in (True, False):
        words = words_of(none, 0.003, 149_975, compiled)
        assert words[:2].tolist() == [
            time_word(STAMPS_NS + T_NS - 3_000_000), time_word(STAMPS_NS + 2_999_500_000)]
        assert words_of(none, compiled=compiled)[1] == time_word(STAMPS_NS + TICK_START_NS)


@pytest.mark.parametrize('changes, message', [
    ({'name': ['hip']}, 'sent setpoint names hip, must name hip, hip/stiffness'),
    ({'position': [0.1, math.nan, math.nan, 0.5, *OTHERS]},
     'enabled = 0.5, must be a whole number of 0 to 1'),
    ({'position': [0.1, -1.0, math.nan, 1.0, *OTHERS]},
     'hip/stiffness = -1.0, must be finite and >= 0'),
    ({'position': [0.1, math.nan, math.inf, 1.0, *OTHERS]}, 'hip/damping = inf, must be finite'),
    ({'position': [math.nan, 1.0, 1.0, 1.0, *OTHERS]},
     'hip: recorded position = nan, must be finite'),
    ({'position': [0.1, *[math.nan] * 5, 3.0]}, 'hip/changed = 3, must name the values'),
    ({'position': [0.1, *[math.nan] * 5, 9.0]}, 'hip/mode = nan, must be a whole number'),
    ({'position': [0.1, *[math.nan] * 3, 0.0, math.nan, 9.0]},
     'hip/mode = 0.0, must be a whole number of 1 to 6'),
    ({'position': [*[math.nan] * 6, 0.0], 'velocity': [math.nan] * 7, 'effort': [math.nan] * 7},
     'hip: sent setpoint without a value'),
    ({'velocity': [0.0]}, 'with all values of each')])
def test_another_message_is_refused(changes, message):
    good = decode(packed(command_of(HAS_SETPOINT, 0, 0.1, 0.0, 0.0, math.nan, math.nan)),
                  JointState)
    for field, value in changes.items():
        setattr(good, field, value)
    with pytest.raises(SetpointError) as refused:
        sent_to_command(encode(good), 'hip')
    assert message in str(refused.value)
