"""Compensation of a dead band: flow in proportion to the demand, its inverse, its ranges."""

from dataclasses import replace

from hypothesis import example, given, strategies as st
from isa_ros.actuator.tunable import refuse_unusable
from isa_ros.core.record import rows_of
from isa_ros.errors import ParameterError
from isa_ros.reu import block
from isa_ros.reu.bumpless import back_calculate
from isa_ros.reu.compensation import (
    compensated, compensation_record, dead_band_compensation, DeadBand, demand_for, Linear)
from isa_ros.reu.schedule import POINTS
import numpy as np
import pytest
from tests.sheets import actuator_sheet

SHEET = DeadBand(overlap=1.2e-3, transition=1e-4, slope=0.88)
BAND = compensation_record(SHEET)
LIMIT = 0.01
demands = st.floats(-0.02, 0.02)


def row(**changes: object) -> np.record:
    """Return the `BLOCK` record of a position block with the dead band's compensation."""
    sheet = actuator_sheet('isa_v5', 'default', 'position_control').reu.position
    return block.block_record(
        replace(sheet, **{'compensation': SHEET, 'limit': LIMIT} | changes), np.ones(POINTS))


def state() -> np.record:
    """Return a block at rest."""
    return rows_of(1, block.BLOCK_STATE)[0]


@pytest.mark.parametrize(('demand', 'output'), [
    (2e-5, 0.88 * 2e-5 + 0.2 * 1.2e-3), (1e-4, 0.88e-4 + 1.2e-3), (4e-3, 0.88 * 4e-3 + 1.2e-3),
    (LIMIT, LIMIT)])
def test_the_output_is_the_demand_over_the_band(demand, output):
    """R21: a part of the overlap within the transition, all of it beyond; 1 - d/limit: full."""
    assert compensated(demand, BAND) == pytest.approx(output, rel=4e-15, abs=0.0)
    assert compensated(-demand, BAND) == -compensated(demand, BAND)


@given(demand=demands)
def test_flow_beyond_the_transition_is_in_proportion_to_the_demand(demand):
    """A valve of V26 without flow up to the overlap, and a straight line to the limit."""
    output = abs(compensated(demand, BAND))
    flow = max(0.0, output - SHEET.overlap) / (LIMIT - SHEET.overlap)
    if abs(demand) >= SHEET.transition:
        # two products and a difference, each rounded to 1.1e-16 of at most 1.2e-3 to 0.02
        assert flow == pytest.approx(abs(demand) / LIMIT, rel=1e-12, abs=1e-15)


@given(demand=demands)
@example(demand=1.05e-4)        # just beyond the transition
@example(demand=-0.98e-4)       # just within, where the output is more than the overlap
def test_the_inverse_gives_the_demand_back(demand):
    """R21, for a block that takes over at a present output."""
    assert demand_for(compensated(demand, BAND), BAND) == pytest.approx(
        demand, rel=1e-12, abs=1e-18)


@given(demand=demands)
def test_compiled_is_the_python_source_bit_for_bit(demand):
    assert dead_band_compensation(demand, BAND) == dead_band_compensation.py_func(demand, BAND)


def test_without_an_overlap_the_demand_is_unchanged():
    none = compensation_record(Linear())
    assert none.overlap == 0.0
    assert compensated(3.7e-3, none) == demand_for(3.7e-3, none) == 3.7e-3


def test_a_block_adds_the_band_to_its_demand_after_the_factor_on_retracting():
    """R7, R21: half of the flow, not half of the overlap."""
    own = row(kp=0.5, ki=0.0, kf=0.0, kv=0.0, retracting_factor=0.5)
    for error, output in ((2e-3, 0.88e-3 + 1.2e-3), (-2e-3, -(0.44e-3 + 1.2e-3))):
        at = state()
        block.block_step(error, 0.0, 0.0, 0.0, 1.0, own, at)
        assert at.output == pytest.approx(output, rel=1e-12, abs=0.0)


@pytest.mark.parametrize('output', [2.5e-3, -7e-4])
def test_a_block_takes_over_within_the_band_and_beyond_it(output):
    """The integral gives the present output: that of the next period is within its growth."""
    own, at = row(kp=0.5, ki=2.0, kf=0.0, kv=0.0, retracting_factor=0.8), state()
    back_calculate(output, 0.03, 0.0, 0.0, 1.0, own, at)
    block.block_step(0.03, 0.03, 0.0, 0.0, 1.0, own, at)
    assert at.output == pytest.approx(output, rel=1e-12, abs=0.0)


@pytest.mark.parametrize(('change', 'message'), [
    ({'overlap': 0.0}, 'overlap = 0 .*must be > 0'),
    ({'transition': 0.0}, 'transition = 0 .*must be > 0'),
    ({'slope': 1.1}, 'slope = 1.1, must be <= 1')])
def test_a_band_without_extent_is_refused(change, message):
    with pytest.raises(ParameterError, match=message):
        replace(SHEET, **change)


def test_an_overlap_beyond_the_whole_output_is_refused():
    sheet = actuator_sheet('isa_v5', 'default', 'position_control')
    limit = sheet.reu.position.limit
    with pytest.raises(ParameterError, match='compensation.overlap = .* must be < '):
        refuse_unusable(replace(sheet, reu=replace(sheet.reu, position=replace(
            sheet.reu.position, compensation=replace(SHEET, overlap=1.5 * limit)))))
