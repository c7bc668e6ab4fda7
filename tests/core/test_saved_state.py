"""A saved state as text and file: loss-free, bound to its configuration, refused if damaged."""

import json
from pathlib import Path

from hypothesis import given, strategies
from isa_ros.core import saved_state
from isa_ros.core.saved_state import (
    LARGEST_BYTES, MAX_TICKS, read_state, RunState, sealed, write_state)
from isa_ros.core.signals import COMMAND
from isa_ros.errors import ConfigError, RunError
import numpy as np
import pytest
from tests.full_disk import limited_files

STATE = RunState(tick=7, load=b'load', participants=[b'haa', b''],
                 requests=np.zeros(2, COMMAND).tobytes())


@given(strategies.integers(0, MAX_TICKS - 1), strategies.binary(),
       strategies.lists(strategies.binary()))
def test_the_text_loses_nothing(tick, load, participants):
    state = RunState(
        tick=tick, load=load, participants=participants, requests=b'', stops=load[::-1])
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
    ('format', 3, 'format 3, must be 5')])
def test_a_text_of_other_content_is_refused(key, value, message):
    with pytest.raises(ConfigError, match=message):
        RunState.from_json(sealed(content(STATE) | {key: value}), 'digest', 'file')


def content(state: RunState) -> dict:
    """Return the content of the text of a state, without its checksum."""
    tree = json.loads(state.to_json('digest', {}))
    del tree['sha256']
    return tree


def test_every_changed_digit_is_noticed():
    """The checksum covers all that is read."""
    text = STATE.to_json('digest', {'numpy': '2.0'})
    for place in [k for k, letter in enumerate(text) if letter.isalnum()]:
        changed = text[:place] + ('1' if text[place] != '1' else '0') + text[place + 1:]
        with pytest.raises(ConfigError) as refused:
            RunState.from_json(changed, 'digest', 'file')
        assert '\n' not in str(refused.value)


def test_a_text_without_a_checksum_is_refused():
    with pytest.raises(ConfigError, match='file: is damaged, its sha256 is not that of its'):
        RunState.from_json(json.dumps(content(STATE)), 'digest', 'file')


@pytest.mark.parametrize('number', ['NaN', 'Infinity', '-Infinity'])
def test_a_number_that_is_none_is_refused(number):
    text = STATE.to_json('digest', {}).replace('"tick": 7', f'"tick": {number}')
    with pytest.raises(ConfigError, match=f'is no saved state of a run .{number} is not a number'):
        RunState.from_json(text, 'digest', 'file')


def requesting(field: str, value: float) -> RunState:
    rows = np.zeros(2, COMMAND)
    rows[1][field] = value
    return RunState(tick=7, load=b'', participants=[], requests=rows.tobytes())


@pytest.mark.parametrize(('field', 'value'), [
    ('position', np.nan), ('velocity', -np.inf), ('effort', np.nan), ('stiffness', np.inf)])
def test_a_request_that_is_not_finite_is_neither_read_nor_written(field, value):
    state = requesting(field, value)
    with pytest.raises(ConfigError, match=(
            f'^requests: saved state has {field} = {value}, must be finite$')):
        state.rows_of_requests(2)
    with pytest.raises(RunError, match=f'^requests: {field} = {value}, must be finite to be'):
        state.to_json('digest', {})


def test_a_gain_that_is_kept_is_saved():
    """A gain of NaN keeps the one in force."""
    state = requesting('stiffness', np.nan)
    assert RunState.from_json(state.to_json('digest', {}), 'digest', 'file') == state
    assert np.isnan(state.rows_of_requests(2)['stiffness'][1])


def test_a_full_disk_leaves_the_old_file(tmp_path: Path):
    path, text = tmp_path / 'state.json', STATE.to_json('digest', {})
    write_state(path, text)
    with limited_files(100), pytest.raises(RunError) as refused:
        write_state(path, text)
    assert str(refused.value) == f'{path}: cannot save, File too large'
    assert [each.name for each in tmp_path.iterdir()] == ['state.json']
    assert read_state(path, 'digest') == STATE


def test_a_state_that_could_not_be_read_again_is_not_written(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(saved_state, 'LARGEST_BYTES', 100)
    with pytest.raises(RunError, match=r'state.json: cannot save \d+ bytes, must be <= 100'):
        write_state(tmp_path / 'state.json', STATE.to_json('digest', {}))
    assert not any(tmp_path.iterdir())


def test_requests_are_of_as_many_actuators():
    assert len(STATE.rows_of_requests(2)) == 2
    with pytest.raises(ConfigError, match=(
            f'must have {3 * COMMAND.itemsize} for the 3 actuators of the run')):
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
