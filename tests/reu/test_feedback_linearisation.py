"""The linearising force block: it inverts its model of the plant."""

from dataclasses import replace

from hypothesis import given, strategies as st
from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.signals import MEASURED
from isa_ros.plant import chambers, servo_valve
from isa_ros.plant.plant import plant_record
from isa_ros.plant.valve_sheets import PointsFlow
from isa_ros.reu import block, feedback_linearisation as fl
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, override

SUPPLY = 20.7e6


def known(model: str, return_mpa: float = 0.0) -> tuple[np.record, np.record]:
    """Return (LINEARISATION, PLANT) records of a shipped model without null leakage."""
    sheet = override(
        actuator_sheet(model, 'default', 'feedback_linearisation'),
        'plant.valve.null_leakage_lpm', 0.0)
    sheet = override(sheet, 'reu.force.return_pressure_mpa', return_mpa)
    sheet = override(sheet, 'plant.valve.orifice_smoothing_kpa', 1e-6)
    record = row_record(actuator_record(sheet, 0))
    return record.reu.linearisation, plant_record(sheet.plant)[0]


KNOWN = {model: known(model) for model in MODELS}


def measured(**values: float) -> np.record:
    """Return a `MEASURED` row."""
    row = rows_of(1, MEASURED)[0]
    for name, value in values.items():
        setattr(row, name, value)
    return row


@given(flow=st.floats(0.0, 1.2e-4))
def test_opening_inverts_the_flow_curve(flow):
    """R11, V4: g(u(q)) = q up to the spool's stop."""
    for law, plant in KNOWN.values():
        u = fl.opening_of(flow, law.model)
        if u < law.model.x_max:
            assert servo_valve.flow_curve(u, plant.valve) == pytest.approx(
                flow, rel=1e-9, abs=1e-15)
        else:
            assert flow >= servo_valve.flow_curve(u, plant.valve) * (1.0 - 1e-9)


@given(flow=st.floats(0.0, 6e-4))
def test_opening_inverts_the_points_of_a_data_sheet(flow):
    """R11, V15: g(u(q)) = q for a curve of three lines, up to its last point."""
    sheet = actuator_sheet('cylinder', 'default', 'feedback_linearisation')
    points = PointsFlow(current_ma=(0.0, 2.0, 6.0, 10.0), flow_lpm=(0.0, 1.0, 12.0, 20.0))
    valve_sheet = replace(sheet.plant.valve, flow=points)
    sheet = replace(sheet, plant=replace(sheet.plant, valve=valve_sheet))
    law = row_record(actuator_record(sheet, 0)).reu.linearisation
    valve = plant_record(sheet.plant)[0].valve
    u = fl.opening_of(flow, law.model)
    assert servo_valve.flow_curve(u, valve) == pytest.approx(
        min(flow, 20.0 / 60e3), rel=1e-9, abs=1e-15)
    assert u == fl.opening_of.py_func(flow, law.model)


@given(rate=st.floats(-1.0, 1.0), velocity=st.floats(-0.02, 0.02), place=st.floats(0.05, 0.95),
       share_a=st.floats(0.2, 0.8), share_b=st.floats(0.2, 0.8))
def test_the_opening_gives_the_wanted_force_rate(rate, velocity, place, share_a, share_b):
    """R12: with that opening C2 and C3 give F', with the sensor deflecting by F'/K_s."""
    for law, plant in KNOWN.values():
        oil = plant.chambers
        p_a, p_b, s = share_a * SUPPLY, share_b * SUPPLY, place * oil.stroke
        wanted = rate * 0.02 * chambers.oil_stiffness(s, oil) * oil.stroke
        speed = velocity * oil.stroke
        x = fl.opening_for(
            wanted, measured(position=s, pressure_a=p_a, pressure_b=p_b), speed, law)
        if abs(x) == law.model.x_max:
            continue
        q_a, q_b, _, _ = servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0.0, plant.valve)
        piston = speed + wanted / plant.mechanics.k_s
        rates = chambers.pressure_rates(q_a, q_b, p_a, p_b, s, piston, oil)
        given_rate = chambers.hydraulic_force(*rates, oil)
        # scale: the terms that cancel
        scale = abs(wanted) + chambers.oil_stiffness(s, oil) * (abs(speed) + abs(piston)) + 1.0
        assert given_rate == pytest.approx(wanted, abs=1e-9 * scale)


def test_the_integral_stands_still_at_the_stop():
    """R5 holds for this block too."""
    sheet = actuator_sheet('isa_v5', 'default', 'feedback_linearisation')
    sheet = replace(sheet, reu=replace(sheet.reu, force=replace(sheet.reu.force, ki_per_s2=1e4)))
    law = row_record(actuator_record(sheet, 0)).reu.linearisation
    state = rows_of(1, block.BLOCK_STATE)[0]
    row = measured(position=0.05, pressure_a=8e6, pressure_b=11e6)
    fl.linearising_step(1e5, row, 0.0, law, state)
    assert state.output == law.limit
    assert state.integral == 0.0
    fl.linearising_step(10.0, row, 0.0, law, state)
    assert state.integral > 0.0


@pytest.mark.parametrize('direction', [1.0, -1.0])
@pytest.mark.parametrize('model', MODELS)
def test_the_opening_counts_from_the_return_pressure(model, direction):
    """
    R12 with P_T = 2 MPa: the lands to return have P - P_T, and C2, C3 give F' back.

    With 5 MPa in both chambers a block that took P for P - P_T would open a fifth too little
    there.
    """
    law, plant = known(model, return_mpa=2.0)
    oil, p = plant.chambers, 5e6
    s = 0.5 * oil.stroke
    wanted = direction * 1e-3 * chambers.oil_stiffness(s, oil) * oil.stroke
    x = fl.opening_for(wanted, measured(position=s, pressure_a=p, pressure_b=p), 0.0, law)
    assert 0.0 < direction * x < law.model.x_max
    q_a, q_b, _, _ = servo_valve.port_flows(x, p, p, SUPPLY, 2e6, plant.valve)
    rates = chambers.pressure_rates(
        q_a, q_b, p, p, s, wanted / plant.mechanics.k_s, oil)
    # a dozen roundings, and the orifices' smoothing of 1e-3 Pa on 3 MPa: 1e-19
    assert chambers.hydraulic_force(*rates, oil) == pytest.approx(wanted, rel=1e-9, abs=0.0)


@pytest.mark.parametrize('model', MODELS)
def test_the_output_is_what_the_innermost_block_takes(model):
    """The opening in m, or without a spool block the series current for it."""
    law, plant = KNOWN[model]
    per_spool = 1.0 if model == 'isa_v5' else 1.0 / plant.valve.k_spool
    row = measured(position=0.5 * plant.chambers.stroke, pressure_a=9e6, pressure_b=9e6)
    state = rows_of(1, block.BLOCK_STATE)[0]
    fl.linearising_step(1.0, row, 0.0, law, state)
    opening = fl.opening_for(law.bandwidth, row, 0.0, law)
    assert state.output == pytest.approx(per_spool * opening, rel=1e-12, abs=0.0)


@pytest.mark.parametrize('model', MODELS)
def test_a_rising_force_damps_and_slows_the_load(model):
    """R8, R12: F' = -w K_f dF/dt, and the load moves by dF/dt / K_s less than the piston."""
    law, plant = KNOWN[model]
    state = rows_of(1, block.BLOCK_STATE)[0]
    rate = 1e-3 * chambers.oil_stiffness(0.5 * plant.chambers.stroke, plant.chambers)
    for n in range(1, 200):  # 40 ms: the 100 Hz low-pass of the speed has settled to 1e-11
        force = rate * n * law.period
        row = measured(position=0.5 * plant.chambers.stroke, pressure_a=9e6, pressure_b=9e6,
                       force=force)
        state.integral = 0.0
        fl.linearising_step(force, row, 0.0, law, state)
    expected = law.model.output_per_spool * fl.opening_for(
        -law.bandwidth * law.kf * rate, row, -rate / plant.mechanics.k_s, law)
    assert expected < 0.0
    assert state.output == pytest.approx(expected, rel=1e-8, abs=0.0)


@given(reference=st.floats(-7e3, 7e3), force=st.floats(-7e3, 7e3), velocity=st.floats(-0.5, 0.5))
def test_compiled_block_equals_its_python_source(reference, force, velocity):
    """One period, every state."""
    for law, plant in KNOWN.values():
        row = measured(position=0.4 * plant.chambers.stroke, force=force, pressure_a=9e6,
                       pressure_b=7e6)
        compiled, python = (rows_of(1, block.BLOCK_STATE)[0] for _ in 'ab')
        fl.linearising_step(reference, row, velocity, law, compiled)
        fl.linearising_step.py_func(reference, row, velocity, law, python)
        assert compiled.tobytes() == python.tobytes()
