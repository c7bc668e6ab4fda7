"""The rig into which faults are injected: an ISA v5 that moves a mass, on a pump."""

from isa_ros.config.text.yaml_text import Tree

STEP_S = 1e-3
BEGIN_S, END_S, DURATION_S = 0.5, 1.0, 2.2
"""Time of every fault, and length of the run."""
CLEAR_S = 1.1
"""When what the device has kept of a fault is cleared: the causes of all have ended by then."""

CONFIG: Tree = {
    'name': 'fault_rig', 'step_ms': 1.0, 'controller_offset_ms': 0.12, 'tick_timeout_s': 5.0,
    'supply': {
        'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0,
        'gas_volume_l': 0.32, 'precharge_mpa': 12.0, 'polytropic_exponent': 1.3,
        'line_volume_l': 0.5, 'bulk_modulus': 1.0e9, 'pump_flow_lpm': 12.0, 'pump_lag_s': 0.03,
        'pump_band_mpa': 0.5, 'relief_mpa': 22.5, 'relief_lpm_per_mpa': 10.0,
        'return_line': {'kind': 'held'}},
    'actuators': {'ram': {
        'model': 'isa_v5', 'preset': 'default', 'load': {'kind': 'mass'},
        'initial_position_mm': 50.0}}}
"""A mass of 50 kg, and an accumulator that feeds its motion."""
LINK: Tree = {'kind': 'ethercat', 'delay_cycles': 1, 'watchdog_ms': 10.0}
"""Between commander and REU, for the faults of a link; the others have none."""

MOTION: Tree = {
    'name': 'sine', 'duration_s': DURATION_S, 'tracks': {'ram': [
        {'t_s': 0.0, 'position': 'hold', 'stiffness': 1.0e5, 'damping': 4000.0,
         'sine': {'amplitude': 0.02, 'frequency_hz': 2.0, 'moves': 'position'}}]}}
"""20 mm at 2 Hz about mid stroke; at `BEGIN_S` the piston is fastest."""
