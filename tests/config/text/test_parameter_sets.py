"""Sections to checked parameter sets: refused values, with file and key."""

import math

from hypothesis import given, strategies as st
from isa_ros.config.text.parameter_sets import as_tree, build, build_one_of, kind_of, members
from isa_ros.config.text.sections import merge, Place, written
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import choice, parameter, Parameters, SMALLEST
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, ParameterError
import pytest


@frozen(kw_only=True)
class SmallDrive(Parameters):
    """A stand-in with one length."""

    bore_mm: float = parameter('bore', 'mm', gt=0.0, le=500.0)


@frozen(kw_only=True)
class BigDrive(Parameters):
    """A stand-in that checks one value against another."""

    low: float = parameter('low', 'm')
    high: float = parameter('high', 'm')

    def __post_init__(self) -> None:
        """Refuse an empty range."""
        super().__post_init__()
        if self.high <= self.low:
            raise ParameterError(f'high = {self.high:g} m, must be > low = {self.low:g} m')


@frozen(kw_only=True)
class Sheet(Parameters):
    """A stand-in with every kind of field."""

    law: str = choice('law', 'plain', 'fancy')
    gain: float = parameter('gain', '1', ge=0.0)
    drive: SmallDrive | BigDrive


RUN = Place('run.yaml') / 'parameters'
MODEL = Place('model.yaml')
GOOD = {'law': 'plain', 'gain': 2, 'drive': {'kind': 'small', 'bore_mm': 21.5}}


def test_integers_become_floats_and_names_stay_names() -> None:
    sheet = build(Sheet, written(GOOD, RUN), RUN)
    assert sheet == Sheet(law='plain', gain=2.0, drive=SmallDrive(bore_mm=21.5))
    assert type(sheet.gain) is float


@pytest.mark.parametrize('change, expected', [
    ({'gian': 1.0}, 'run.yaml: parameters.gian is unknown; did you mean gain'),
    ({'drive': {'kind': 'small', 'bore_m': 0.02}},
     r'parameters.drive.bore_m is unknown; the key is bore_mm \(the unit belongs to the key\)'),
    ({'drive': {'kind': 'small'}}, 'run.yaml: parameters.drive lacks bore_mm'),
    ({'drive': {'bore_mm': 2.0}}, 'parameters.drive lacks kind, one of small, big'),
    ({'drive': {'kind': 'huge'}}, "parameters.drive.kind = 'huge', must be one of small, big"),
    ({'drive': {'kind': {'a': 1}}}, 'parameters.drive.kind = .a section., must be one of'),
    ({'drive': 3.0}, 'run.yaml: parameters.drive = 3.0, must be a section'),
    ({'drive': {'kind': 'big', 'low': 2.0, 'high': 1.0}},
     'run.yaml: parameters.drive: high = 1 m, must be > low = 2 m'),
    ({'drive': {'kind': 'small', 'bore_mm': 600}},
     r'parameters.drive.bore_mm = 600 mm, must be <= 500 mm \(bore\)'),
    ({'drive': {'kind': 'small', 'bore_mm': '21.5 mm'}},
     "parameters.drive.bore_mm = '21.5 mm', must be a number in mm"),
    ({'drive': {'kind': 'small', 'bore_mm': None}}, 'bore_mm = None, must be a number in mm'),
    ({'drive': {'kind': 'small', 'bore_mm': True}}, 'bore_mm = True, must be a number in mm'),
    ({'gain': math.inf}, 'parameters.gain = inf, must be finite'),
    ({'gain': {'a': 1}}, 'run.yaml: parameters.gain is a section, must be one value'),
    ({'gain': [1.0]}, r'run.yaml: parameters.gain = \[1.0\], must be one value'),
    ({'law': 'odd'}, "run.yaml: parameters.law = 'odd', must be one of plain, fancy"),
])
def test_what_is_wrong_is_named_with_file_and_key(
        change: dict[str, object], expected: str) -> None:
    with pytest.raises(ConfigError, match=expected) as caught:
        build(Sheet, written({**GOOD, **change}, RUN), RUN)  # type: ignore[arg-type, dict-item]
    assert '\n' not in str(caught.value)


def test_a_kind_that_lacks_is_told_of_the_file_with_the_section() -> None:
    """Of the run file where it has a value of the section, else of the model."""
    section = written({'law': 'plain', 'gain': 2.0}, MODEL)
    for own, expected in ((written({'bore_mm': 2.0}, RUN / 'drive'), 'run.yaml: parameters.drive'),
                          (written({'bore_mm': 2.0}, MODEL / 'drive'), 'model.yaml: drive')):
        with pytest.raises(ConfigError, match=f'^{expected} lacks kind, one of small, big$'):
            build(Sheet, section | {'drive': own}, MODEL)


@pytest.mark.parametrize('over, expected', [
    ({'drive': {'bore_mm': -1.0}}, '^run.yaml: parameters.drive.bore_mm = -1 mm, must be > 0'),
    ({'drive': {'rod_mm': 1.0}}, '^run.yaml: parameters.drive.rod_mm is unknown'),
    ({'drive': {'kind': 'big'}}, '^run.yaml: parameters.drive lacks low, high$'),
    ({'drive': {'kind': 'big', 'low': 2.0, 'high': 1.0}}, '^run.yaml: parameters.drive: high = '),
    ({'other': {'deep': {'key': 1.0}}}, '^run.yaml: parameters.other'),
])
def test_a_later_layer_is_blamed_at_its_own_file(
        over: dict[str, object], expected: str) -> None:
    """An error in a run file is not reported for the model's sheet."""
    section = merge(written(GOOD, MODEL), written(over, RUN))  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match=expected):
        build(Sheet, section, MODEL)


@given(gain=st.just(0.0) | st.floats(SMALLEST, 1e300),
       low=st.floats(-1e6, -SMALLEST) | st.just(0.0), span=st.floats(1e-3, 1e6))
def test_a_set_survives_its_tree_bit_for_bit(gain: float, low: float, span: float) -> None:
    sheet = Sheet(law='fancy', gain=gain, drive=BigDrive(low=low, high=low + span))
    assert build(Sheet, written(as_tree(sheet), RUN), RUN) == sheet


def test_kinds_leave_out_a_shared_last_word() -> None:
    assert list(members(SmallDrive | BigDrive)) == ['small', 'big']
    assert list(members(SmallDrive | Sheet)) == ['small_drive', 'sheet']
    section = written({'kind': 'small', 'bore_mm': 1.0}, RUN)
    assert build_one_of(SmallDrive | BigDrive, section, RUN) == SmallDrive(bore_mm=1.0)


class StrangeDrive(Parameters):
    """A stand-in with a kind of its own."""

    KIND = 'other'


def test_a_kind_may_differ_from_the_name_of_its_class() -> None:
    """Its name counts for the shared last word of the others."""
    assert list(members(SmallDrive | StrangeDrive)) == ['small', 'other']
    assert kind_of(StrangeDrive(), SmallDrive | StrangeDrive) == 'other'
    section = written({'kind': 'other'}, RUN)
    assert build_one_of(SmallDrive | StrangeDrive, section, RUN) == StrangeDrive()
    assert as_tree(StrangeDrive(), SmallDrive | StrangeDrive) == {'kind': 'other'}


@pytest.mark.parametrize('wrong, expected', [
    ('bore_in_mm', 'bore_mm'),
    ('presure_mpa', 'pressure_mpa'),
    ('pressure_bar', 'the key is pressure_mpa'),
    ('rate', 'the key is rate_hz'),
    ('flow_lpm_per_pa', 'the key is flow_lpm_per_mpa'),
    ('xyz', 'valid: bore_mm, pressure_mpa'),
])
def test_a_wrong_key_is_answered_with_what_it_may_mean(wrong: str, expected: str) -> None:
    names = ['bore_mm', 'pressure_mpa', 'rate_hz', 'flow_lpm_per_mpa']
    assert expected in alternatives(wrong, names)
