"""What a block or a mode begins with when it takes over."""

from dataclasses import replace

from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.device import CURRENT, FORCE, SPOOL
from isa_ros.core.parameter import replaced
from isa_ros.core.record import row_record
from isa_ros.reu.block import block_step
from isa_ros.reu.bumpless import back_calculate, start_setpoint, take_over
from isa_ros.reu.wiring import HELD
import pytest
from tests.reu.states import enabled_state
from tests.sheets import actuator_sheet

MEASURED, OUTPUT, PLACE = 500.0, 2e-5, 0.05     # N, m of spool, m


def test_a_block_with_feedback_damping_takes_over_with_its_filter_at_the_measured_value() -> None:
    """
    Its first output is that of the block inside of it before.

    A filter that began elsewhere would give a rate, and K_f of it a step of the output.
    """
    sheet = actuator_sheet('isa_v5')
    force = replace(sheet.reu.force, kf=2e-3, measured_filter_hz=100.0)
    reu = row_record(actuator_record(replaced(sheet, 'reu.force', force), 0)).reu
    block, state = reu.force, enabled_state(reu).force
    state.measured, state.measured_rate = -1e3, 7e4     # of an hour ago
    back_calculate(OUTPUT, MEASURED, 0.0, PLACE, reu.stroke, block, state)
    assert (state.measured, state.measured_rate) == (MEASURED, 0.0)
    block_step(MEASURED, MEASURED, 0.0, PLACE, reu.stroke, block, state)
    # sums of numbers up to K_p times 500 N, of 1e-5 m
    assert state.output == pytest.approx(OUTPUT, rel=1e-9, abs=0.0)


def test_the_spool_of_a_direct_valve_begins_where_its_current_holds_it() -> None:
    """K_spool times the series current, from which the cascade makes the same current again."""
    reu = row_record(actuator_record(actuator_sheet('isa_v5'), 0)).reu
    assert reu.spool_kind == HELD
    state = enabled_state(reu, CURRENT)
    state.current_reference = 4e-3
    series = 4e-3 / reu.parallel
    assert take_over(CURRENT, SPOOL, reu, state) == series * reu.k_spool
    assert take_over(CURRENT, FORCE, reu, state) == 0.0     # the measured force
    assert state.force.output == series * reu.k_spool


@pytest.mark.parametrize('mode', [CURRENT, FORCE])
def test_a_mode_that_begins_without_a_setpoint_has_none_of_the_velocity_before(mode: int) -> None:
    reu = row_record(actuator_record(actuator_sheet('isa_v5'), 0)).reu
    state = enabled_state(reu)
    state.measured.position, state.setpoint.velocity, state.setpoint.effort = 0.04, 0.3, 900.0
    start_setpoint(mode, 1.5, state)
    own = state.setpoint
    assert (own.position, own.velocity) == (0.04, 0.0)
    assert (own.effort, own.reference, own.is_reference) == (
        (1.5, 0.0, 0.0) if mode == FORCE else (0.0, 1.5, 1.0))
