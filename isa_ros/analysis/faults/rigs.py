"""The rigs in which faults are tried: an ISA v5 on a pump, and machines with other parts."""

from collections.abc import Mapping
from typing import NamedTuple

from isa_ros.config.models.fault_catalogue import ACTUATOR, NamedFault
from isa_ros.config.text.yaml_text import Tree
from isa_ros.scripting.run import load, Run

DURATION_S = 2.2

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

_SINE: Tree = {'amplitude': 0.02, 'frequency_hz': 2.0, 'moves': 'position'}
_COUNTERBALANCE: Tree = {
    'kind': 'counterbalance', 'pilot_ratio': 3.0, 'setting_mpa': 10.4, 'opening_mpa': 6.0,
    'rated_lpm': 60.0, 'rated_drop_mpa': 4.0, 'check_rated_lpm': 60.0,
    'check_rated_drop_mpa': 0.6, 'lag_ms': 10.0}
_UNLOADING: Tree = {
    'kind': 'unloading', 'inlet': 'gallery', 'outlet': 'tank', 'senses': 'stored',
    'opens_mpa': 20.3, 'shuts_mpa': 20.0, 'rated_lpm': 60.0}
_PARTS = {
    'pump': 'pump', 'accumulator': 'buffer', 'line': 'press_hose', 'manifold': 'press',
    'relief': 'safety', 'check': 'kept', 'unloading': 'spill', 'block': 'tool_shut',
    'dump': 'emptied', 'filter': 'return_filter'}


class FaultRig(NamedTuple):
    """A run, and who has a fault in it."""

    run: Run
    actuator: str
    """The one that has faults of actuators, and whose signals are looked at."""
    supply: str = 'supply'
    parts: Mapping[str, str] = {}
    """Names of the parts of a circuit by kind."""

    @property
    def row(self) -> int:
        """Return the row of the actuator."""
        return self.run.configuration.index(self.actuator)

    def tree(self, fault: NamedFault, begin_s: float) -> Tree:
        """Return a fault of this rig as a scenario has it."""
        target = self.actuator if fault.of == ACTUATOR else self.supply
        found: Tree = {'t_s': begin_s, fault.of: target, 'fault': fault.name}
        return found | ({'part': self.parts[fault.part]} if self.parts and fault.part else {})


ABOUT: Mapping[str, str] = {
    'cushion_a': 'The slide of `press.yaml`, which enters the cushion at its retracted end at '
                 '0.5 s and is sent out again at 0.75 s.',
    'cushion_b': 'The same at the extended end.',
    'return_spring': 'The single-acting cylinder of `lift_table.yaml`, which lets its table down '
                     'by 40 mm at 0.6 s.',
    'hoses': 'The cylinder of `rig_hoses.yaml`, which carries 12 kN and swings by 20 mm at 2 Hz.',
    'holding': 'The same of `rig_counterbalance.yaml`, with a counterbalance valve at chamber B '
               'too.',
    'block_valves': 'The ISA v5 of above with block valves.',
    'hysteresis': 'The ISA v5 of above with a hysteresis of 3 % and a threshold of 0.5 %.',
    'circuit': 'The cylinders of `pump_station.yaml`, which swing by 30 mm at 1.5 Hz, with an '
               'unloading valve in front of its check valve. Signals are those of *left*.'}
"""What the rigs of parts do, by name."""


def rig_of(name: str) -> FaultRig:
    """Return one of the rigs of `ABOUT`."""
    if name in ('cushion_a', 'cushion_b'):
        start, end, back = (60.0, 0.0, 0.1) if name == 'cushion_a' else (190.0, 0.25, 0.15)
        return FaultRig(_run('press', {'actuators.slide.initial_position_mm': start}, {'slide': [
            {'t_s': 0.0, 'position': 'hold'},
            {'t_s': 0.37, 'position': end, 'stiffness': 2e6, 'damping': 1e4},
            {'t_s': 0.75, 'position': back}]}), 'slide')
    if name == 'return_spring':
        held = {'t_s': 0.0, 'position': 'hold', 'stiffness': 3e5, 'damping': 1e4}
        return FaultRig(_run('lift_table', {'actuators.table.initial_position_mm': 100.0}, {
            'table': [held, {'t_s': 0.6, 'position': 0.06}]}), 'table')
    if name in ('hoses', 'holding'):
        changes = {} if name == 'hoses' else {
            'actuators.boom.parameters.plant.holding_b': _COUNTERBALANCE}
        return FaultRig(_run(
            'rig_hoses' if name == 'hoses' else 'rig_counterbalance', changes, {'boom': [
                {'t_s': 0.0, 'position': 'hold', 'effort': 12000.0, 'stiffness': 4e5,
                 'damping': 1e4, 'sine': _SINE}]}), 'boom')
    if name == 'circuit':
        return FaultRig(_run('pump_station', {'supplies.station.parts.spill': _UNLOADING}, {
            own: [{'t_s': 0.0, 'position': 'hold', 'sine': {
                'amplitude': 0.03, 'frequency_hz': 1.5}}] for own in ('left', 'right')}),
            'left', 'station', _PARTS)
    key = 'actuators.ram.parameters.plant'
    return FaultRig(load(CONFIG, MOTION).replace(
        {f'{key}.block_valve': {'kind': 'poppet'}} if name == 'block_valves' else
        {f'{key}.valve': {'hysteresis_percent': 3.0, 'threshold_percent': 0.5}}), 'ram')


def _run(config: str, changes: Mapping[str, object], tracks: Tree) -> Run:
    """Return a shipped run with other values and a motion."""
    run = load(config, {'name': 'faulty', 'duration_s': DURATION_S, 'tracks': tracks})
    return run.replace(changes) if changes else run


MOTION: Tree = {
    'name': 'sine', 'duration_s': DURATION_S, 'tracks': {'ram': [
        {'t_s': 0.0, 'position': 'hold', 'stiffness': 1.0e5, 'damping': 4000.0, 'sine': _SINE}]}}
"""20 mm at 2 Hz about mid stroke; the piston is fastest where faults begin."""


def common_rigs() -> tuple[FaultRig, FaultRig]:
    """Return that of `common_faults`, without and with a link."""
    return (FaultRig(load(CONFIG, MOTION), 'ram'),
            FaultRig(load({**CONFIG, 'link': LINK}, MOTION), 'ram'))
