"""The trace of an actuator: states before the loops run, references made from them."""

from dataclasses import replace
import math

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.analysis.response.actuator_trace import RATE_HZ, setpoints, TIMING, traced
from isa_ros.analysis.response.rig import Choice, Rig, rig
from isa_ros.analysis.signals.frequency import stepped_response, Window
import numpy as np
import pytest
from tests.sheets import MODELS

EFFORT = {'smart_manifold': 17.0, 'isa_v2': 400.0, 'isa_v5': 750.0}


def blocked(model: str, loop: str, preset: str = 'default') -> Rig:
    """Return a rig of a model's loop with its output blocked."""
    return rig(Choice(name=model, loop=loop, preset=preset, load='blocked'))


def sine(amplitude: float, frequency: float, n: int) -> np.ndarray:
    """Return a sine sampled as a trace, (n,)."""
    return amplitude * np.sin(2.0 * math.pi * frequency * np.arange(n) / RATE_HZ)


@pytest.mark.parametrize('model', MODELS)
def test_a_trace_is_that_of_single_ticks(model):
    """States before each tick and the references after it, to the last bit."""
    bench = blocked(model, 'force')
    excited, ticked = bench.begin(0.0), bench.begin(0.0)
    values = sine(EFFORT[model], 40.0, 400)
    trace = bench.excite(excited, values)
    assert {len(column) for column in trace.values()} == {len(values)}
    for k, command in enumerate(setpoints(ticked, 'effort', values)):
        row = {name: column[k] for name, column in trace.items()}
        reply = ticked.replies[0].copy()
        ticked.advance(bench.ports, command)
        assert (row['force'], row['position'], row['velocity']) == (
            reply['force'], reply['position'], reply['velocity'])
        for name in ('position', 'force', 'spool', 'current'):
            assert row[f'{name}_reference'] == ticked.samples[0][f'{name}_reference']
    assert (trace['pressure'] == trace['pressure_a'] - trace['pressure_b']).all()
    assert excited.snapshot() == ticked.snapshot()


def test_a_position_excitation_is_the_setpoint():
    """With the sheet's stiffness a blocked actuator responds to a position with force."""
    bench = blocked('isa_v5', 'position')
    offset = bench.offset
    assert offset == bench.config.initial_position
    values = sine(1e-3, 10.0, 2000)
    trace = bench.excite(bench.begin(0.0), values)
    assert (trace['position_reference'] == offset + values).all()
    # 1e5 N/m on 1 mm, held for 1 ms at 10 Hz: at most 2 pi 10 1e-3 * 100 N behind; and the
    # output is at rest within 1 um of the encoder
    assert trace['force_reference'] == pytest.approx(1e5 * values, abs=8.0)


def test_a_velocity_goes_with_a_position():
    """4000 Ns/m on 10 mm/s, from the position block's next instant on."""
    bench = blocked('isa_v5', 'position')
    trace = bench.excite(bench.begin(0.0), np.zeros(20), np.full(20, 0.01))
    # the output is at rest within 1 um of the encoder: 1e5 N/m, and 4000 Ns/m at 1 kHz
    # through a low-pass of 100 Hz (a share of 0.47)
    assert trace['force_reference'] == pytest.approx(40.0, abs=0.1 + 4000.0 * 1e-3 * 0.47)


def test_an_effort_leaves_position_and_velocity():
    bench = blocked('isa_v5', 'position')
    actuator = bench.begin(0.0)
    rows = setpoints(actuator, 'effort', np.full(20, 100.0), np.full(20, 0.01))
    trace = traced(actuator, bench.ports, rows)
    assert (trace['position_reference'] == actuator.samples['position_reference'][0]).all()
    # the output is at rest within 1 um of the encoder, as above
    assert trace['force_reference'] == pytest.approx(100.0, abs=0.1 + 4000.0 * 1e-3 * 0.47)


def test_slow_torque_follows_its_reference():
    """Blocked, impedance off, 5 Hz: the integral makes the closed loop's gain about 1."""
    bench = blocked('smart_manifold', 'force', 'table_4')
    n = round(RATE_HZ)
    trace = bench.excite(bench.begin(0.0), sine(17.0, 5.0, n))
    got = stepped_response(
        [Window(5.0, n // 2, n)], trace['force_reference'], trace['force'], RATE_HZ)
    # a second-order loop that overshoots by at most 40 % (zeta 0.28) and rises in at most 9 ms
    # (1.3 / w_n, so f_n > 23 Hz): (1 - 2 zeta^2)(f / f_n)^2 = 0.04
    assert got.gain[0] == pytest.approx(1.0, abs=0.04)
    assert got.coherence[0] > 0.999
    assert got.input_amplitude[0] == pytest.approx(17.0, abs=0.01)


def test_a_rig_begins_under_the_pressures_of_its_supply():
    """As `SmartActuator.start` with the pressures of a supply that is not the default one."""
    bench = blocked('smart_manifold', 'force')
    supply = bench.run.supplies[0]
    softer = replace(bench, run=replace(bench.run, supplies=(replace(
        supply, sheet=replace(supply.sheet, pressure_mpa=10.0, return_pressure_mpa=0.5)),)))
    assert softer.ports['supply_pressure'] == 10e6 and softer.ports['return_pressure'] == 0.5e6
    group = ActuatorGroup([softer.config], TIMING)
    group.actuators[0].start(softer.config.initial_position, 0.0, 10e6, 0.5e6)
    assert softer.begin(0.0).snapshot() == group.snapshot()
