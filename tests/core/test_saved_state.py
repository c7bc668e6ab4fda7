"""A saved state as text: loss-free, bound to its configuration, and refused where damaged."""

import json

from hypothesis import given, strategies
from isa_ros.core.saved_state import LARGEST_BYTES, MAX_TICKS, read_state, RunState
from isa_ros.core.signals import COMMAND
from isa_ros.errors import ConfigError
import numpy as np
import pytest

STATE = RunState(tick=7, load=b'load', participants=[b'haa', b''],
                 requests=np.zeros(2, COMMAND).tobytes())


@given(strategies.integers(0, MAX_TICKS - 1), strategies.binary(),
       strategies.lists(strategies.binary()))
def test_the_text_loses_nothing(tick, load, participants):
    state = RunState(tick=tick, load=load, participants=participants, requests=b'')
    assert RunState.from_json(state.to_json('digest', {}), 'digest', 'file') == state


def test_the_configuration_must_be_the_same():
    with pytest.raises(ConfigError, match='s.json: saved from the configuration one..., must be'):
        RunState.from_json(STATE.to_json('one', {}), 'another', 's.json')


@pytest.mark.parametrize(('key', 'value', 'message'), [
    ('tick', -1, 'tick = -1, must be an integer >= 0'),
    ('tick', MAX_TICKS, f'tick = {MAX_TICKS}, must be an integer >= 0 and < {MAX_TICKS}'),
    ('tick', 1.5, 'tick = 1.5, must be an integer >= 0'),
    ('load', 'xyz', 'is no saved state of a run'),
    ('load', None, 'is no saved state of a run'),
    ('participants', 3, 'is no saved state of a run'),
    ('format', 1, 'format 1, must be 2')])
def test_a_damaged_text_is_refused(key, value, message):
    tree = json.loads(STATE.to_json('digest', {})) | {key: value}
    with pytest.raises(ConfigError, match=message):
        RunState.from_json(json.dumps(tree), 'digest', 'file')


def test_requests_are_of_as_many_actuators():
    assert len(STATE.rows_of_requests(2)) == 2
    with pytest.raises(ConfigError, match='must have 144 for the 3 actuators of the run'):
        STATE.rows_of_requests(3)


def test_a_file_that_cannot_be_one_is_refused(tmp_path):
    with pytest.raises(ConfigError, match='missing.json: cannot be read, No such file'):
        read_state(tmp_path / 'missing.json', 'digest')
    large = tmp_path / 'large.json'
    with large.open('wb') as file:
        file.truncate(LARGEST_BYTES + 1)
    with pytest.raises(ConfigError, match='larger than'):
        read_state(large, 'digest')
    large.write_bytes(b'\xff\xfe')
    with pytest.raises(ConfigError, match='is no saved state'):
        read_state(large, 'digest')
