"""Encoder and converters."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
from isa_ros.errors import ParameterError
from isa_ros.plant import sensors
import pytest
from tests.sheets import actuator_sheet, plant_row

ISA_V5 = plant_row('isa_v5').sensors


@given(position=st.floats(-0.01, 0.12))
def test_encoder_is_within_half_a_count(position):
    """S1: 1 um counts, paper Table 3."""
    read = sensors.encode(position, ISA_V5.encoder)
    # half a count plus one rounding of the product at 0.12 m
    assert abs(read - position) <= 0.5e-6 + 1.4e-17
    assert read / 1e-6 == pytest.approx(round(read / 1e-6), abs=1e-9)


@pytest.mark.parametrize('position', [math.nan, math.inf, -math.inf])
def test_a_position_that_has_diverged_stays_that(position):
    """Compiled, and in plain Python, whose `math.floor` refuses it: the run tells its state."""
    for encode in (sensors.encode, getattr(sensors.encode, 'py_func', sensors.encode)):
        assert str(float(encode(position, ISA_V5.encoder))) == str(position)


@given(force=st.floats(-2e4, 2e4))
def test_converter_has_4096_codes_and_clips(force):
    """S2: +-10 kN over 12 bits is 4.88 N a code."""
    read = sensors.convert(force, -1e4, 1e4, ISA_V5.force_step)
    code = (read + 1e4) / ISA_V5.force_step
    assert code == pytest.approx(round(code), abs=1e-9)
    assert 0 <= round(code) <= 4095
    if abs(force) < 1e4 - ISA_V5.force_step:
        assert abs(read - force) <= 0.5 * ISA_V5.force_step * (1.0 + 1e-9)


def test_zero_force_reads_exactly_zero():
    """A resting load cell must not bias the integral."""
    assert sensors.convert(0.0, -1e4, 1e4, ISA_V5.force_step) == 0.0


def test_a_fraction_of_a_bit_is_refused():
    """S2: codes are whole."""
    with pytest.raises(ParameterError, match='adc_bits = 12.5 bit, must be a whole number'):
        replace(actuator_sheet('isa_v5').plant.sensors, adc_bits=12.5)
