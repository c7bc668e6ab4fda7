"""The excitation runs the same loops and plant as the ticks, and logs the same signals."""

import math

from isa_ros.actuator.actuator import SmartActuator, Timing
from isa_ros.analysis.response.excitation import excite, excite_steps, RATE_HZ, TRACE
from isa_ros.analysis.signals.frequency import stepped_response, Window
from isa_ros.core.signals import COMMAND
from isa_ros.errors import SimulationDiverged
import numpy as np
import pytest
from tests.sheets import MODELS, setpoint, smart_actuator

TICK = Timing(step_ns=100_000, controller_offset_ns=0)
EFFORT = {'smart_manifold': 17.0, 'isa_v2': 400.0, 'isa_v5': 750.0}


def blocked(model: str, preset: str = 'default', timing: Timing = TICK) -> SmartActuator:
    """Return a blocked actuator with its impedance off, after a tick."""
    actuator = smart_actuator(model, 'blocked', preset=preset, timing=timing)
    actuator.accept(setpoint(
        position=actuator.sample.position, stiffness=0.0, damping=0.0))
    actuator.tick()
    return actuator


@pytest.mark.parametrize('model', MODELS)
def test_excitation_equals_ticks_sample_for_sample(model):
    """A setpoint before every tick of 100 us is the same run, to the last bit."""
    values = EFFORT[model] * np.sin(2.0 * math.pi * 40.0 * np.arange(400) / RATE_HZ)
    ticked, excited = blocked(model), blocked(model)
    trace = excite(excited, 'effort', values)
    for row, value in zip(trace, values):
        before = ticked.sample.copy()
        exact = float(ticked.reply.force), float(ticked.reply.position)
        ticked.accept(setpoint(position=before.position_reference, effort=value))
        ticked.tick()
        assert (row['force'], row['position']) == exact
        assert (row['position_measured'], row['force_measured']) == (
            before.position, before.force)
        for name in ('force', 'spool', 'current'):
            assert row[f'{name}_reference'] == ticked.sample[f'{name}_reference']
    # all but the totals, which a tick starts anew
    states = [actuator.memory.states[0, :-3].tobytes() for actuator in (ticked, excited)]
    assert states[0] == states[1]
    assert excited.t_ns == ticked.t_ns


def test_a_position_excitation_is_the_setpoint():
    """With the sheet's stiffness a blocked actuator responds to a position with force."""
    actuator = smart_actuator('isa_v5', 'blocked', timing=TICK)
    values = 0.05 + 1e-3 * np.sin(2.0 * math.pi * 10.0 * np.arange(2000) / RATE_HZ)
    trace = excite(actuator, 'position', values)
    assert (trace['position_reference'] == values).all()
    # 1e5 N/m on 1 mm, held for 1 ms at 10 Hz: at most 2 pi 10 1e-3 * 100 N behind
    assert trace['force_reference'] == pytest.approx(1e5 * (values - 0.05), abs=8.0)


def test_a_velocity_goes_with_a_position():
    """4000 Ns/m on 10 mm/s, from the position block's next instant on."""
    actuator = smart_actuator('isa_v5', 'blocked', timing=TICK)
    trace = excite(actuator, 'position', np.full(20, 0.05), np.full(20, 0.01))
    # the output is at rest within 1 um of the encoder: 1e5 N/m, and 4000 Ns/m at 1 kHz
    # through a low-pass of 100 Hz (a share of 0.47)
    assert trace['force_reference'] == pytest.approx(40.0, abs=0.1 + 4000.0 * 1e-3 * 0.47)


def test_compiled_excitation_equals_its_python_source():
    """The kernel's own lines; the loops and the plant have a test of their own."""
    rows = []
    for kernel in (excite_steps, excite_steps.py_func):
        actuator = blocked('smart_manifold')
        trace = np.zeros(20, TRACE)
        memory = actuator.memory
        arrays = (memory.ports, memory.constants, memory.bodies, memory.rates, memory.states,
                  memory.slopes, memory.reu, memory.read_outs)
        if kernel is not excite_steps:
            arrays = tuple(a.view(np.recarray) if a.dtype.names else a for a in arrays)
            trace = trace.view(np.recarray)
        assert kernel(5, 5, False, np.linspace(0.0, 17.0, 20), np.zeros(20), trace, *arrays) == 20
        rows.append(trace.tobytes())
    assert rows[0] == rows[1]


def test_slow_torque_follows_its_reference():
    """Blocked, impedance off, 5 Hz: the integral makes the closed loop's gain about 1."""
    actuator = blocked('smart_manifold', 'table_4')
    n = round(RATE_HZ)
    values = 17.0 * np.sin(2.0 * math.pi * 5.0 * np.arange(n) / RATE_HZ)
    trace = excite(actuator, 'effort', values)
    got = stepped_response(
        [Window(5.0, n // 2, n)], trace['force_reference'], trace['force'], RATE_HZ)
    # a second-order loop that overshoots by at most 40 % (zeta 0.28) and rises in at most 9 ms
    # (1.3 / w_n, so f_n > 23 Hz): (1 - 2 zeta^2)(f / f_n)^2 = 0.04
    assert got.gain[0] == pytest.approx(1.0, abs=0.04)
    assert got.coherence[0] > 0.999
    assert got.input_amplitude[0] == pytest.approx(17.0, abs=0.01)


def test_a_state_that_is_not_finite_ends_it_with_time_and_name():
    actuator = blocked('isa_v5')
    actuator.memory.ports['supply_pressure'] = math.nan
    with pytest.raises(SimulationDiverged, match=r'isa_v5: plant\.\S+ = nan at t = 0.000200 s'):
        excite(actuator, 'effort', np.zeros(10))


def test_what_is_accepted_stays_for_the_next_tick():
    actuator = blocked('isa_v5')
    actuator.accept(setpoint(effort=100.0))
    trace = excite(actuator, 'effort', np.zeros(20))
    assert not trace['force_reference'].any()
    actuator.tick()
    assert actuator.applied is not None and actuator.applied['effort'] == 100.0
    assert actuator.applied.dtype == COMMAND
