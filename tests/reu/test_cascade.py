"""The nested loops: rates, order, enable."""

from isa_ros.actuator_sheet import actuator_record
from isa_ros.errors import ConfigError
from isa_ros.reu import cascade
import numpy as np
import pytest
from tests.sheets import actuator_sheet, override


def loops(model: str, offset_steps: int = 0) -> tuple[np.record, np.record]:
    """Return (constants, state) of an enabled cascade."""
    reu = actuator_record(actuator_sheet(model), offset_steps).view(np.recarray)[0].reu
    state = np.zeros(1, cascade.REU_STATE).view(np.recarray)[0]
    state.setpoint.is_enabled = 1.0
    return reu, state


def test_periods_in_plant_steps():
    """1, 5, 5 and 10 kHz are 50, 10, 10 and 5 steps of 20 us (paper Fig 7)."""
    assert cascade.loop_steps(actuator_sheet('isa_v5').reu) == (50, 10, 10, 5)


def test_a_loop_samples_at_its_own_instants_only():
    """A force setpoint reaches the force reference at 1 kHz, shifted by the offset."""
    reu, state = loops('smart_manifold', offset_steps=6)
    state.setpoint.effort = 10.0
    changed = []
    for step in range(0, 160):
        state.position.force_reference = 0.0
        if (step - 6) % 5 == 0:
            cascade.cascade_step(step, reu, state)
        if state.position.force_reference:
            changed.append(step)
    assert changed == [6, 56, 106, 156]


def test_coinciding_loops_run_outermost_first_without_delay():
    """One instant carries an effort through to the current reference."""
    reu, state = loops('smart_manifold')
    state.setpoint.effort = 10.0
    cascade.cascade_step(0, reu, state)
    assert state.force.output == pytest.approx(4e-5 * 10.0)
    # coils in parallel: the amplifier gives twice the series current
    assert state.current_reference == pytest.approx(2.0 * state.force.output, rel=1e-12)


def test_the_electric_valve_is_commanded_by_its_spool():
    """Figure 7 B: the output is the spool reference, its current follows K_spool."""
    reu, state = loops('isa_v5')
    state.setpoint.effort = 100.0
    cascade.cascade_step(0, reu, state)
    assert state.spool_reference == state.force.output
    assert state.current_reference == pytest.approx(
        2.0 * state.spool_reference / 0.0356, rel=1e-12)


def test_a_disabled_actuator_commands_null():
    """Disabled: no current, no memory."""
    reu, state = loops('isa_v5')
    state.setpoint.effort = 100.0
    cascade.cascade_step(0, reu, state)
    state.setpoint.is_enabled = 0.0
    cascade.cascade_step(10, reu, state)
    assert (state.current_reference, state.spool_reference, state.force.integral) == (0, 0, 0)


@pytest.mark.parametrize('delay_us', [100.0, 30.0])
def test_a_delay_the_loops_cannot_have_is_refused(delay_us):
    """A whole number of plant steps below the period of the current loop."""
    reu = override(actuator_sheet('isa_v5').reu, 'computation_delay_us', delay_us)
    with pytest.raises(ConfigError, match='multiple of 20 us below 100 us'):
        cascade.delay_steps(reu, 5)


@pytest.mark.parametrize(('rates', 'message'), [
    ({'position': 3000.0}, r'position.rate_hz = 3000 Hz, .* whole nanoseconds'),
    ({'current': 8000.0}, r'current.rate_hz = 8000 Hz = 0.125 ms, .* plant step 0.02 ms'),
    ({'force': 1250.0, 'spool': 1250.0},
     r'position.rate_hz = 1000 Hz does not divide force.rate_hz = 1250 Hz'),
])
def test_rates_that_do_not_divide_are_refused(rates, message):
    """Both rates, or the rate and the step, are named."""
    reu = actuator_sheet('isa_v5').reu
    for loop, rate in rates.items():
        reu = override(reu, f'{loop}.rate_hz', rate)
    with pytest.raises(ConfigError, match=message):
        cascade.loop_steps(reu)
