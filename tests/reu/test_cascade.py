"""The nested loops: rates, order, enable."""

from dataclasses import replace

from isa_ros.actuator.sheet import actuator_record, refuse_wiring
from isa_ros.core.record import row_record
from isa_ros.reu import cascade
from isa_ros.reu.compensation import Linear
from isa_ros.reu.wiring import Off
import numpy as np
import pytest
from tests.reu.states import disable, enabled_state
from tests.sheets import actuator_sheet, MODELS, override


def loops(
        model: str, offset_steps: int = 0, *variants: str) -> tuple[np.record, np.record]:
    """Return (constants, state) of an enabled cascade."""
    sheet = actuator_sheet(model, 'default', *variants)
    reu = row_record(actuator_record(sheet, offset_steps)).reu
    return reu, enabled_state(reu)


def test_a_loop_samples_at_its_own_instants_only():
    """A force setpoint reaches the force reference at 1 kHz, shifted by the offset."""
    reu, state = loops('smart_manifold', offset_steps=6)
    state.setpoint.effort = 10.0
    changed = []
    for step in range(0, 160):
        state.position.output = 0.0
        if (step - 6) % 5 == 0:
            cascade.cascade_step(step, reu, state)
        if state.position.output:
            changed.append(step)
    assert changed == [6, 56, 106, 156]


def test_coinciding_loops_run_outermost_first_without_delay():
    """Within one instant an effort reaches the current reference."""
    reu, state = loops('smart_manifold')
    state.setpoint.effort = 10.0
    cascade.cascade_step(0, reu, state)
    assert state.force.output == pytest.approx(reu.force.kp * 10.0)
    # coils in parallel: the amplifier gives twice the series current
    assert state.current_reference == pytest.approx(
        2.0 * state.force.output, rel=1e-12, abs=0.0)


def test_the_electric_valve_is_commanded_by_its_spool():
    """Figure 7 B: the output is the spool reference, its current follows K_spool."""
    reu, state = loops('isa_v5')
    state.setpoint.effort = 100.0
    cascade.cascade_step(0, reu, state)
    assert state.spool_reference == state.force.output
    assert state.current_reference == pytest.approx(
        2.0 * state.spool_reference / 0.0356, rel=1e-12, abs=0.0)


def test_a_disabled_actuator_commands_null():
    """While disabled the current is zero and the states are reset."""
    reu, state = loops('isa_v5')
    state.setpoint.effort = 100.0
    cascade.cascade_step(0, reu, state)
    disable(state)
    cascade.cascade_step(10, reu, state)
    assert (state.current_reference, state.spool_reference, state.force.integral) == (0, 0, 0)


def test_without_any_outer_block_the_effort_is_the_current_of_the_coil():
    """Section 3: a plain valve amplifier, at the instants of the current block."""
    reu, state = loops('smart_manifold', 0, 'valve_amplifier')
    state.setpoint.effort = 1e-3  # series A
    cascade.cascade_step(5, reu, state)
    assert state.current_reference == pytest.approx(2e-3)
    assert state.spool_reference == pytest.approx(35.6e-6)
    assert state.force_reference == 0.0


def test_without_position_block_the_effort_goes_to_the_force_block_at_its_rate():
    """The outermost block that is on takes the setpoint's effort, here at 5 kHz."""
    sheet = actuator_sheet('smart_manifold')
    sheet = replace(sheet, reu=replace(sheet.reu, position=Off()))
    refuse_wiring(sheet)
    reu = row_record(actuator_record(sheet, 0)).reu
    state = enabled_state(reu)
    state.setpoint.effort = 10.0
    cascade.cascade_step(5, reu, state)
    assert (state.force_reference, state.force.output) == (10.0, 0.0)
    cascade.cascade_step(10, reu, state)
    assert state.force.output == pytest.approx(sheet.reu.force.kp * 10.0)


def test_pure_position_control_feeds_the_setpoint_s_velocity_forward():
    """R3: K_v of the position block is on the reference's speed, not on the measured one."""
    sheet = override(
        actuator_sheet('smart_manifold', 'default', 'position_control'), 'reu.position.kv', 1e-3)
    reu = row_record(actuator_record(sheet, 0)).reu
    state = enabled_state(reu)
    state.setpoint.velocity = 0.5
    cascade.cascade_step(0, reu, state)
    assert state.position.output == pytest.approx(1e-3 * 0.5)


def test_pure_position_control_commands_the_valve():
    """Paper section 5.1: the output of the position block is the command of the valve."""
    reu, state = loops('smart_manifold', 0, 'position_control')
    state.setpoint.position = 0.1
    state.setpoint.stiffness = 300.0
    cascade.cascade_step(0, reu, state)
    assert state.current_reference == pytest.approx(2.0 * 8e-3 * 0.1)  # 8 mA/rad, series


def test_a_pressure_block_controls_the_difference():
    """Section 3: the pressure difference between the chambers."""
    sheet = actuator_sheet('smart_manifold')
    reu_sheet = replace(sheet.reu, position=Off(), force=Off(), pressure=replace(
        sheet.reu.force, kp=1e-10, ki=0.0, kv=0.0))
    sheet = replace(sheet, reu=reu_sheet)
    refuse_wiring(sheet)
    reu = row_record(actuator_record(sheet, 0)).reu
    state = enabled_state(reu)
    state.setpoint.effort = 5e6
    state.measured.pressure_a, state.measured.pressure_b = 9e6, 7e6
    state.pressure.measured = 2e6
    cascade.cascade_step(0, reu, state)
    assert state.current_reference == pytest.approx(2.0 * 1e-10 * 3e6)


def test_the_explicit_current_block_gives_a_voltage():
    """Figure 7: PID + LLC; its first output is b_0 K_pf i_r."""
    reu, state = loops('smart_manifold', 0, 'explicit', 'valve_amplifier')
    state.setpoint.effort = 1e-5
    cascade.cascade_step(0, reu, state)
    assert state.drive == pytest.approx(reu.lead_lag.b_0 * 1.15 * 2e-5)


def test_a_disabled_position_or_pressure_block_forgets_its_integral():
    """An integral from before must not reappear with the next enable."""
    pid = replace(actuator_sheet('smart_manifold').reu.force, kp=0.0, ki=1e-9, kv=0.0)
    reu_sheet = replace(
        actuator_sheet('smart_manifold').reu, force=Off(),
        position=replace(pid, ki=1e9, limit=1e7, compensation=Linear()), pressure=pid)
    sheet = replace(actuator_sheet('smart_manifold'), reu=reu_sheet)
    sheet = override(sheet, 'reu.position.rate_hz', 1000.0)
    refuse_wiring(sheet)
    reu = row_record(actuator_record(sheet, 0)).reu
    state = enabled_state(reu)
    state.setpoint.position = 0.1
    for instant in (0, 50, 100):
        cascade.cascade_step(instant, reu, state)
    assert state.position.integral > 0.0 and state.pressure.integral > 0.0
    disable(state)
    cascade.cascade_step(105, reu, state)
    assert (state.position.integral, state.pressure.integral) == (0.0, 0.0)
    assert (state.position.output, state.pressure.output) == (0.0, 0.0)
    assert state.current_reference == 0.0


def test_spool_and_current_blocks_feed_back_what_is_measured():
    """Figure 7 B: at the reference the outputs of both blocks are zero."""
    sheet = actuator_sheet('isa_v5', 'default', 'explicit')
    sheet = replace(sheet, reu=replace(sheet.reu, position=Off(), force=Off()))
    refuse_wiring(sheet)
    reu = row_record(actuator_record(sheet, 0)).reu
    state = enabled_state(reu)
    state.setpoint.effort = 5e-5
    state.measured.spool = state.spool.measured = 5e-5
    cascade.cascade_step(0, reu, state)
    assert (state.current_reference, state.drive) == (0.0, 0.0)
    state.measured.spool, state.measured.current = 4e-5, 1e-3
    cascade.cascade_step(10, reu, state)
    assert state.current_reference == pytest.approx(2.0 * sheet.reu.spool.kp * 1e-5)
    error = 1.15 * state.current_reference - 1e-3
    assert state.drive == pytest.approx(reu.lead_lag.b_0 * error)


@pytest.mark.parametrize('variants', [
    (), ('feedback_linearisation',), ('explicit',), ('position_control',), ('valve_amplifier',)])
@pytest.mark.parametrize('model', MODELS)
def test_compiled_cascade_equals_its_python_source(model, variants):
    """A few instants of every wiring, every state."""
    reu, compiled = loops(model, 0, *variants)
    python = loops(model, 0, *variants)[1]
    for state, step in ((compiled, cascade.cascade_step), (python, cascade.cascade_step.py_func)):
        state.setpoint.effort, state.setpoint.position = 1e-4, 0.03
        state.measured.force, state.measured.position = 3.0, 0.02
        state.measured.pressure_a, state.measured.pressure_b = 8e6, 9e6
        for instant in (0, 5, 10, 50):
            step(instant, reu, state)
    assert compiled.tobytes() == python.tobytes()
