"""What a library says of itself: its actuator, parameters, signals and codes."""

import ctypes

from isa_ros.actuator.integration import state_name, STATE_SIZE
from isa_ros.core.fields import units_of
from isa_ros.core.signals import SAMPLE, SAMPLE_FIELDS
import numpy as np
import pytest
from tests.export.calls import parameter
from tests.export.libraries import BEHIND, Instance

pytestmark = pytest.mark.slow


def test_what_it_is(loaded, own):
    class About(ctypes.Structure):
        _fields_ = [*((name, ctypes.c_char_p) for name in ('name', 'model', 'version', 'digest')),
                    ('step_ns', ctypes.c_int64), ('is_rotary', ctypes.c_int),
                    ('has_own_load', ctypes.c_int), ('start', ctypes.c_double * 4)]
    from isa_ros.core.version import VERSION
    about = ctypes.cast(loaded.call('about', result=ctypes.c_void_p),
                        ctypes.POINTER(About)).contents
    assert (about.name, about.model, about.version) == (b'isa_v5', b'isa_v5', VERSION.encode())
    assert about.digest.decode() == own.actuator.digest
    assert (about.step_ns, about.is_rotary, about.has_own_load) == (1_000_000, 0, 0)
    assert list(about.start) == [0.05, 0.0, 20.7e6, 0.0]
    assert Instance(loaded).save().tobytes()[-BEHIND:-BEHIND + 16] == about.digest


class Texts(ctypes.Structure):
    """A parameter or a signal, as far as both have the same fields."""

    _fields_ = [('texts', ctypes.c_char_p * 3)]


def test_parameters_are_those_of_isa_params(loaded, own):
    from isa_ros.config.listing import describe
    listed = describe('isa_v5', values={'reu.force.kp': 9.5e-08}).split('\n\n')
    table = next(text for text in listed if text.startswith('actuators.isa_v5.parameters'))
    rows = [line.split()[:2] for line in table.splitlines()[2:]]
    count = loaded.call('parameter_count')
    found = [parameter(loaded.call('parameter', k, result=ctypes.c_void_p))
             for k in range(count)]
    assert [one.name.decode() for one in found] == [row[0] for row in rows]
    for one, row in zip(found, rows):
        assert one.value.decode().split() == [] or one.value.decode().startswith(row[1])
    assert loaded.call('parameter', count, result=ctypes.c_void_p) is None
    assert loaded.call('parameter', -1, result=ctypes.c_void_p) is None


def test_parameters_by_name(loaded):
    def named(name):
        return loaded.call('find', name, result=ctypes.c_void_p)
    kp = parameter(named(b'reu.force.kp'))
    assert (kp.name, kp.value, kp.number, kp.source) == (
        b'reu.force.kp', b'9.5e-08', 9.5e-08, b'--set')
    bore = parameter(named(b'plant.drive.bore_mm'))
    assert (bore.number, bore.unit, bore.source) == (21.5, b'mm', b'paper Table 2')
    assert bore.range.startswith(b'> 0') and b'piston' in bore.meaning
    assert np.isnan(parameter(named(b'plant.kind')).number)
    assert parameter(named(b'reu.force.kv')).unit == b'output per m/s'
    for name in (b'plant.drive.bore', b'plant.drive.bore_mmm', b'', None):
        assert named(name) is None


def test_signals_have_names_and_units(loaded):
    units = units_of(SAMPLE_FIELDS)
    assert loaded.call('field_count') == len(SAMPLE_FIELDS) == SAMPLE.itemsize // 8
    for k, field in enumerate(SAMPLE_FIELDS):
        address = loaded.call('field', k, result=ctypes.c_void_p)
        texts = ctypes.cast(address, ctypes.POINTER(Texts)).contents.texts
        assert [text.decode() for text in texts] == [
            field.name, units[field.name], field.meaning]
    for k in (-1, len(SAMPLE_FIELDS)):
        assert loaded.call('field', k, result=ctypes.c_void_p) is None


def test_codes_have_messages(loaded):
    messages = [loaded.message(code) for code in range(0, -10, -1)]
    assert len(set(messages)) == 10 and messages[0] == 'done'
    assert loaded.message(-10) == loaded.message(STATE_SIZE + 1) == 'unknown code'
    for k in (0, 1, STATE_SIZE - 1):
        assert loaded.message(1 + k) == f'{state_name(k)} is not finite: the model has diverged'
