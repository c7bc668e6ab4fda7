"""
The control blocks of figure 7 and Table 4, one at a time and in open loop.

Gains are measured on the kernels: the block's output divided by its input, a reference, a
position or a speed.
"""

from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.units import MILLI
from isa_ros.paper.printed import cell, Printed, statement
from isa_ros.plant.servo_valve import flow_curve
from isa_ros.reu.block import BLOCK_STATE, block_step
from isa_ros.reu.cascade import initial_gains
from isa_ros.reu.compensation import dual_gain_compensation
from isa_ros.reu.impedance import force_reference, Impedance, SETPOINT
from isa_ros.reu.lead_lag import LeadLag
from isa_ros.validation.entry import around, as_printed, Entry, Findings, INPUT
from isa_ros.validation.sheets import model_sheet, plant_of
import numpy as np

ROTARY, LINEAR = 'smart_manifold', 'isa_v5'
COLUMNS = {ROTARY: 'Smart manifold', LINEAR: 'ISA V5'}
SMALL = 1e-3    # of the full output: inside the low-gain region
PERIODS = 2000  # long after every filter has settled
EXACT = 'the printed digits; 0.01 % for rounding'
PER_KN = 'erratum 11: mm/kN and mm/(kN s)'


def reu_statics() -> Findings:
    """Compare gains, rates and the dual-gain compensation with figure 7 and Table 4."""
    return Findings((
        *_force_gains(ROTARY), *_force_gains(LINEAR), *_impedance(), *_rates(),
        *(entry for model in (ROTARY, LINEAR) for entry in _lead_lag(model)),
        *(_proportionality(model) for model in (ROTARY, LINEAR))))


def _force_block(model: str) -> tuple[np.record, np.record]:
    """Return a force block and its state at rest."""
    record = row_record(actuator_record(model_sheet(model), 0)).reu.force
    return record, rows_of(1, BLOCK_STATE)[0]


def proportional_gain(model: str) -> float:
    """Return the output of the first period over a small reference."""
    block, state = _force_block(model)
    reference = SMALL * block.limit / block.kp
    block_step(reference, 0.0, 0.0, 0.0, 1.0, block, state)
    return float(state.output / reference)


def integral_gain(model: str) -> float:
    """Return the growth rate of the output over a constant error."""
    block, state = _force_block(model)
    error = SMALL * block.limit / (PERIODS * block.period * block.ki)
    block_step(error, 0.0, 0.0, 0.0, 1.0, block, state)
    first = state.output
    for _ in range(PERIODS):
        block_step(error, 0.0, 0.0, 0.0, 1.0, block, state)
    return float((state.output - first) / (PERIODS * block.period * error))


def velocity_gain(model: str) -> float:
    """Return the output over the speed, without a reference."""
    block, state = _force_block(model)
    velocity = SMALL * block.limit / block.kv
    block_step(0.0, 0.0, velocity, 0.0, 1.0, block, state)
    return float(state.output / velocity)


def damping_time(model: str) -> float:
    """Return K_f from a measured ramp that the reference follows, s: without the integral."""
    block, state = _force_block(model)
    rise = SMALL * block.limit / (block.kp * block.kf) * block.period
    integral = 0.0
    for k in range(PERIODS):
        integral = float(state.integral)
        block_step(k * rise, k * rise, 0.0, 0.0, 1.0, block, state)
    return float((integral - state.output) / (proportional_gain(model) * rise / block.period))


def _force_gains(model: str) -> list[Entry]:
    """Return the gains in mA per Nm or mm per N, as they are printed."""
    is_rotary = model == ROTARY
    per_kilo, per_million = (1.0, 1.0) if is_rotary else (1e-3, 1e-6)
    speed = 'erratum 6: mA per rad/s' if is_rotary else 'erratum 6: 240e-6 s'
    to_printed = 1.0 / MILLI
    return [
        _gain(f'{model}_force_kp', model, 'Force/torque K_p',
              proportional_gain(model) * to_printed, per_kilo, '' if is_rotary else PER_KN),
        _gain(f'{model}_force_ki', model, 'Force/torque K_i',
              integral_gain(model) * to_printed, per_kilo, '' if is_rotary else PER_KN),
        _gain(f'{model}_force_kv', model, 'Velocity compensation K_v',
              velocity_gain(model) * (to_printed if is_rotary else 1.0), per_million, speed),
        _gain(f'{model}_force_kf', model, 'Force damping gain K_f', damping_time(model), 1.0, ''),
    ]


def _gain(
        name: str, model: str, row: str, ours: float, factor: float, reading: str) -> Entry:
    printed = cell('table_4', row, COLUMNS[model])
    return Entry.given(name, printed, ours, around(factor * printed.number, percent=0.01), EXACT,
                       reading=reading)


def _impedance() -> list[Entry]:
    entries = []
    for model, stiffness, damping, reading in (
            (ROTARY, cell('table_4', 'Position K_p', 'Smart manifold'),
             cell('table_4', 'Position K_d', 'Smart manifold'), ''),
            (LINEAR, statement('knee_stiffness'), statement('knee_damping'),
             'erratum 12: Table 4 prints 20,000 N/mm and 9,500 Ns/mm')):
        entries += [
            _impedance_gain(f'{model}_stiffness', model, stiffness, (-1.0, 0.0), reading),
            _impedance_gain(f'{model}_damping', model, damping, (0.0, -1.0), reading)]
    return entries


def _impedance_gain(
        name: str, model: str, printed: Printed, moved: tuple[float, float],
        reading: str) -> Entry:
    """Return the force over a small displacement or speed against the setpoint."""
    sheet = model_sheet(model)
    limits = row_record(actuator_record(sheet, 0)).reu.impedance
    setpoint = rows_of(1, SETPOINT)[0]
    setpoint.stiffness, setpoint.damping = initial_gains(sheet.reu)
    small = SMALL * limits.force_out / printed.number
    force = force_reference(setpoint, moved[0] * small, moved[1] * small, limits)
    return Entry.given(name, printed, float(force / small), around(printed.number, percent=0.01),
                       EXACT, reading=reading)


def _lead_lag(model: str) -> list[Entry]:
    """Return the current controller of eq 1 in the variant `explicit`, as in the sheet."""
    loop = model_sheet(model, 'explicit').reu.current
    assert isinstance(loop, LeadLag), 'the variant has it'
    exchanged = 'erratum 9: zeta_lead and zeta_lag are exchanged'

    def entry(name: str, row: str, ours: float, read_as: str = '', reading: str = '') -> Entry:
        printed = cell('table_4', f'Current {row}', COLUMNS[model])
        meant = cell('table_4', f'Current {read_as or row}', COLUMNS[LINEAR])
        return Entry.given(f'{model}_{name}', printed, ours, as_printed(meant),
                           'half of the last printed digit', reading=reading)
    return [
        entry('current_kp', 'K_p', loop.kp_v_per_ma),
        entry('w_lead', 'w_lead', loop.lead_rad_per_s),
        entry('w_lag', 'w_lag', loop.lag_rad_per_s,
              reading='erratum 8: 25,133 rad/s for both' if model == ROTARY else ''),
        entry('zeta_lead', 'zeta_lead', loop.lead_damping, 'zeta_lag', exchanged),
        entry('zeta_lag', 'zeta_lag', loop.lag_damping, 'zeta_lead', exchanged)]


def _rates() -> list[Entry]:
    reu = model_sheet(LINEAR).reu
    assert isinstance(reu.position, Impedance), 'the shipped sheet has it'
    position, current = statement('position_loop_rate'), statement('current_loop_rate')
    return [
        Entry.given('position_rate', position, reu.position.rate_hz * MILLI,
                    around(position.number, percent=5.0), '~: 5 %'),
        Entry.given('current_rate', current, reu.current.rate_hz * MILLI,
                    around(current.number, percent=5.0), '~: 5 %'),
    ]


def _proportionality(model: str) -> Entry:
    """Compare the flow of the compensated demand with a straight line."""
    valve = plant_of(model).valve
    block, _ = _force_block(model)
    to_spool = valve.k_spool if model == ROTARY else 1.0
    full = block.compensation.knee + (
        block.limit - block.compensation.knee) / block.compensation.slope
    demands = np.linspace(0.001, 1.0, 1000) * full
    flows = [flow_curve(to_spool * dual_gain_compensation(u, block.compensation), valve)
             for u in demands]
    line = valve.k_low * to_spool * demands
    return Entry(
        name=f'{model}_compensation', source=INPUT, where='section 3, Fig 7',
        paper='DGC compensates the dual gain',
        ours=round(float(100.0 * np.abs(flows / line - 1.0).max()), 6),
        unit='percent', tolerance=(0.0, 0.3),
        tolerance_source='1.2 mA and x_dg / K_spool differ by 0.05 %, times the ratio of gains',
        reading='erratum 23: the whole demand passes the inverse flow curve')
