"""Runs that are hard and sound: fast, heavy, light, cold, noisy, on weak and rich supplies."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import isa_ros
from isa_ros.config.text.yaml_text import Tree

GAINS = {'stiffness': 1e5, 'damping': 4000.0}
MASSES = (1.0, 5.0, 20.0, 50.0, 100.0, 200.0, 500.0)
TWO = (20.0, 200.0)
PUSH, HUNTS = 'push 3 kN', 5.0
"""On 5 kg the force loop, tuned for 50, swings by 5 kN while 3 kN push: `oscillation` warns."""


class HardRun(NamedTuple):
    """A shipped configuration with its changes, and a scenario."""

    name: str
    config: str
    scenario: str | Tree
    changes: Mapping[str, Any] = {}

    def load(self) -> isa_ros.Run:
        """Return the run."""
        return isa_ros.load(self.config, self.scenario).replace(self.changes)


def _track(actuator: str, gains: Mapping[str, float], *events: Tree, **more: Any) -> Tree:
    begin = {'t_s': 0.0, 'position': 'hold', **gains}
    return {'name': 'hard', 'duration_s': 1.2, 'tracks': {actuator: [begin, *events]}, **more}


def _wave(amplitude: float, hz: float, **more: Any) -> Tree:
    return {'t_s': 0.1, 'position': 'hold',
            'sine': {'amplitude': amplitude, 'frequency_hz': hz, **more}}


def _chirp(amplitude: float, end_hz: float, **more: Any) -> Tree:
    return {'t_s': 0.1, 'position': 'hold', 'chirp': {
        'amplitude': amplitude, 'start_hz': 0.5, 'end_hz': end_hz, 'duration_s': 1.0,
        'sweep': 'exponential', **more}}


def _push(actuator: str, force: float) -> Tree:
    return {'changes': [
        {'t_s': 0.2, 'actuator': actuator, 'set': {'load.force': force}, 'until_s': 0.5},
        {'t_s': 0.6, 'actuator': actuator, 'set': {'load.force': -force}, 'until_s': 0.9}]}


def _device(actuator: str, gains: Mapping[str, float], amplitude: float) -> dict[str, Tree]:
    """Return movements that are disabled, stopped, and led by another block on their way."""
    wave = _wave(amplitude, 2.0)
    return {
        'disabled on the way': _track(actuator, gains, wave, {'t_s': 0.3, 'enabled': False},
                                      {'t_s': 0.4, 'enabled': True}),
        'quick stop': _track(actuator, gains, wave, {'t_s': 0.3, 'quick_stop': True},
                             {'t_s': 0.7, 'enabled': True}),
        'spool': _track(actuator, gains, wave, {'t_s': 0.3, 'mode': 'spool', 'spool': 4e-5},
                        {'t_s': 0.4, 'spool': -4e-5}, {'t_s': 0.5, 'mode': 'impedance'}),
        'current': _track(actuator, gains, wave, {'t_s': 0.3, 'mode': 'current', 'current': 1e-3},
                          {'t_s': 0.4, 'current': -1e-3}, {'t_s': 0.5, 'mode': 'impedance'}),
        'force': _track(actuator, gains, wave, {'t_s': 0.3, 'mode': 'force'},
                        {'t_s': 0.5, 'mode': 'impedance'})}


LINEAR = {
    'sine 30 mm 1 Hz': _track('ram', GAINS, _wave(0.03, 1.0)),
    'sine 20 mm 3 Hz': _track('ram', GAINS, _wave(0.02, 3.0)),
    'sine 3 mm 10 Hz': _track('ram', GAINS, _wave(0.003, 10.0)),
    'chirp 2 mm to 40 Hz': _track('ram', GAINS, _chirp(0.002, 40.0)),
    'step 20 mm': _track('ram', GAINS, {'t_s': 0.1, 'position': 0.07},
                         {'t_s': 0.6, 'position': 0.04}),
    'stiff step 5 mm': _track('ram', {'stiffness': 1e6, 'damping': 2e4},
                              {'t_s': 0.1, 'position': 0.055}, {'t_s': 0.6, 'position': 0.05}),
    PUSH: _track('ram', GAINS, **_push('ram', 3000.0)),
    'effort 2 kN 20 Hz': _track('ram', GAINS, _wave(2000.0, 20.0, moves='effort'))}
ROTARY_GAINS = {'stiffness': 300.0, 'damping': 20.0}
ROTARY = {
    'sine 0.35 rad 1.7 Hz': _track('rotor', ROTARY_GAINS, _wave(0.35, 1.7)),
    'sine 0.05 rad 8 Hz': _track('rotor', ROTARY_GAINS, _wave(0.05, 8.0)),
    'chirp 0.05 rad to 20 Hz': _track('rotor', ROTARY_GAINS, _chirp(0.05, 20.0)),
    'step 0.4 rad': _track('rotor', ROTARY_GAINS, {'t_s': 0.1, 'position': 1.2},
                           {'t_s': 0.6, 'position': 0.6}),
    'push 60 Nm': _track('rotor', ROTARY_GAINS, **_push('rotor', 60.0))}
HARD = ('sine 20 mm 3 Hz', 'step 20 mm', PUSH)
SUPPLIES: Mapping[str, Tree] = {
    f'{mpa} MPa': {'kind': 'constant', 'pressure_mpa': mpa, 'return_pressure_mpa': back}
    for mpa, back in ((12.0, 0.0), (16.0, 0.5), (20.7, 2.0), (21.5, 0.0))} | {
    'accumulator': {
        'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.3,
        'gas_volume_l': 0.3, 'precharge_mpa': 12.0, 'polytropic_exponent': 1.3,
        'line_volume_l': 0.2, 'bulk_modulus': 7e8, 'pump_flow_lpm': 10.0, 'pump_lag_s': 0.05,
        'pump_band_mpa': 0.5, 'relief_mpa': 21.5, 'relief_lpm_per_mpa': 20.0,
        'return_line': {'kind': 'volume', 'oil_volume_l': 0.3, 'bulk_modulus': 7e8,
                        'tank_lpm_per_mpa': 40.0}}}
PLANT = 'actuators.ram.parameters.plant.'
OILS: Mapping[str, Mapping[str, Any]] = {
    'cold, 0 celsius': {'oil.temperature_celsius': 0.0},
    'warm, 70 celsius': {'oil.temperature_celsius': 70.0},
    'soft oil': {'oil.effective_bulk_modulus': 5e8},
    'stiff oil': {'oil.effective_bulk_modulus': 1.0e9},
    'air 1 %': {'oil.entrained_air': 0.01}, 'air 3 %': {'oil.entrained_air': 0.03},
    'old seals': {'oil.cross_port_leakage': 2e-13},
    'tight seals': {'friction.stiction': 300.0, 'friction.coulomb': 250.0},
    'smooth seals': {'friction.stiction': 20.0, 'friction.coulomb': 15.0},
    'worn lands': {'valve.null_leakage_lpm': 0.1},
    'overlap 3 um': {f'valve.lap.{land}_um': 3.0 for land in ('pa', 'at', 'bt', 'pb')},
    'underlap 3 um': {f'valve.lap.{land}_um': -3.0 for land in ('pa', 'at', 'bt', 'pb')},
    'null 0.2 mA': {'spool.null_bias.current_ma': 0.2},
    'null -0.2 mA': {'spool.null_bias.current_ma': -0.2}}
SENSORS: Mapping[str, Mapping[str, Any]] = {
    '11 bits': {'sensors.adc_bits': 11}, '16 bits': {'sensors.adc_bits': 16},
    'force sensor 10 N': {'sensors.force.sigma': 10.0},
    'force sensor 0.5 % off': {'sensors.force.bias': 50.0},
    'force sensor 1 % large': {'sensors.force.scale': 1.01},
    'pressures 0.05 MPa': {'sensors.pressure_a.sigma': 5e4, 'sensors.pressure_b.sigma': 5e4},
    'pressures 0.1 MPa off': {'sensors.pressure_a.bias': 1e5, 'sensors.pressure_b.bias': -1e5},
    'spool 1 um': {'sensors.spool.sigma': 1e-6}, 'current 50 uA': {'sensors.current.sigma': 5e-5},
    'encoder 2 um': {'sensors.position.sigma': 2e-6}}
VARIANTS = ('explicit', 'position_control', 'feedback_linearisation', 'data_sheet_sensors',
            'thermal')
PRESSED = {name: _track('ram', {'effort': 0.0, **GAINS}, *events, beyond_range='accept')
           for name, events in {
    'sine 3 MPa 3 Hz': (_wave(3e6, 3.0, moves='effort'),),
    'sine 1 MPa 15 Hz': (_wave(1e6, 15.0, moves='effort'),),
    'steps of 3 MPa': ({'t_s': 0.1, 'position': 'hold', 'effort': 3e6},
                       {'t_s': 0.6, 'position': 'hold', 'effort': -3e6})}.items()}
"""What a loop of the pressures presses against a wall; its effort is the load pressure, Pa."""
LINKS: Mapping[str, Tree] = {
    'link 1 ms': {'cycle_ms': 1.0, 'delay_cycles': 1},
    'link 0.25 ms': {'cycle_ms': 0.25, 'delay_cycles': 2},
    'link with jitter': {'cycle_ms': 1.0, 'delay_cycles': 2, 'jitter_us': 900.0},
    'lossy link': {'cycle_ms': 1.0, 'delay_cycles': 1, 'loss': 0.05, 'watchdog_ms': 50.0},
    'slow link': {'cycle_ms': 4.0, 'delay_cycles': 2, 'watchdog_ms': 50.0}}
CYLINDERS = ((25.0, 16.0, 100.0, 10.0, 21.0), (32.0, 20.0, 150.0, 10.0, 16.0),
             (40.0, 25.0, 200.0, 20.0, 14.0), (63.0, 36.0, 300.0, 40.0, 10.0),
             (80.0, 45.0, 400.0, 60.0, 14.0))   # bore, rod, stroke, l/min, MPa
SHIPPED = (
    ('leg', 'drop'), ('leg', 'trot_leg'), ('hyq_leg', 'drop'),
    ('rig_knee', 'force_step_high'), ('rig_knee', 'force_step_low'), ('rig_knee', 'knee_sine'),
    ('rig_rotary', 'impact'), ('rig_rotary', 'trot'), ('rig_rotary', 'weight_stiff'),
    ('rig_rotary', 'weight_soft'), ('rig_rotary', 'weight'), ('rig_rotary', 'step'),
    ('rig_rotary', 'wheel_sine'), ('rig_rotary', 'identify'), ('rig_rotary', 'torque_bandwidth'),
    ('rig_rotary_position', 'weight'), ('rig_rotary_position', 'wheel_sine'),
    ('rig_linear', 'identify_linear'), ('rig_linear', 'force_bandwidth'),
    ('rig_cylinder', 'identify_linear'), ('rig_temperature', 'temperature'),
    ('rig_leakage', 'leakage'), ('rig_valve', 'current_step'), ('rig_valve', 'flow_gain'),
    ('rig_valve', 'valve_response'))
IN_SHORT = frozenset({
    'ram 500 kg, sine 20 mm 3 Hz', 'ram 1 kg, chirp 2 mm to 40 Hz', 'accumulator, push 3 kN',
    'air 3 %, step 20 mm', 'data_sheet_sensors, sine 20 mm 3 Hz', 'wheel 2 kg m2, push 60 Nm',
    'lossy link', 'ram 20 kg, quick stop', 'leg falls 15 cm on metal'})
"""Names of the runs that the suite always has."""


def hard_runs() -> Iterator[HardRun]:
    """Yield all runs; no two have the same name."""
    yield from _of_masses()
    yield from _of_sheets()
    yield from _of_times()
    yield from _of_the_leg()
    for config, scenario in SHIPPED:
        yield HardRun(f'{config} {scenario}', config, scenario)


def _of_masses() -> Iterator[HardRun]:
    for mass in MASSES:
        load = {'actuators.ram.load': {'kind': 'mass', 'inertia': mass}}
        for name, scenario in LINEAR.items():
            if mass != HUNTS or name != PUSH:
                yield HardRun(f'ram {mass:g} kg, {name}', 'rig_linear', scenario, load)
    for mass in TWO:
        load = {'actuators.ram.load': {'kind': 'mass', 'inertia': mass}}
        for name, scenario in _device('ram', GAINS, 0.02).items():
            yield HardRun(f'ram {mass:g} kg, {name}', 'rig_linear', scenario, load)
        for name, scenario in (     # it bears 1.8 kN retracting
                *((name, LINEAR[name]) for name in HARD[:2]),
                ('push 1 kN', _track('ram', GAINS, **_push('ram', 1000.0)))):
            yield HardRun(f'ISA v2 {mass:g} kg, {name}', 'rig_linear', scenario, {
                'actuators.ram': {'model': 'isa_v2', 'initial_position_mm': 50.0,
                                  'load': {'kind': 'mass', 'inertia': mass}}})
    for inertia in (0.1, 0.36, 0.9, 2.0):
        load = {'actuators.rotor.load': {'kind': 'wheel', 'inertia': inertia}}
        for name, scenario in ROTARY.items():
            yield HardRun(f'wheel {inertia:g} kg m2, {name}', 'rig_rotary', scenario, load)
    for name, scenario in _device('rotor', ROTARY_GAINS, 0.3).items():
        if name != 'spool':     # a valve with mechanical feedback has no such block
            yield HardRun(f'wheel, {name}', 'rig_rotary', scenario)
    for bore, rod, stroke, flow, pressure in CYLINDERS:
        area = 0.785e-6 * bore * bore
        force = 0.3 * area * pressure * 1e6
        for kind, scenario in (
                ('moves', _track('ram', {}, _wave(0.1e-3 * stroke, 2.0))),
                ('is pushed', _track('ram', {}, **_push('ram', force)))):
            yield HardRun(f'cylinder {bore:g}/{rod:g} mm {kind}', 'rig_cylinder', scenario, {
                'supply.pressure_mpa': pressure,
                'actuators.ram.parameters.plant': {
                    'drive': {'bore_mm': bore, 'rod_mm': rod, 'stroke_mm': stroke,
                              'rated_pressure_mpa': pressure},
                    'valve': {'flow': {'rated_flow_lpm': flow, 'rated_current_ma': 10.0}}}})


def _of_sheets() -> Iterator[HardRun]:
    """Yield what another supply, oil, valve, seal or sensor does to the hard movements."""
    for name in HARD:
        for supply, tree in SUPPLIES.items():
            yield HardRun(f'{supply}, {name}', 'rig_linear', LINEAR[name], {'supply': tree})
        for oil, values in OILS.items():
            yield HardRun(f'{oil}, {name}', 'rig_linear', LINEAR[name],
                          {f'{PLANT}{key}': value for key, value in values.items()})
        for variant in VARIANTS:
            yield HardRun(f'{variant}, {name}', 'rig_linear', LINEAR[name],
                          {'actuators.ram.variants': [variant]})
    for name, scenario in PRESSED.items():
        yield HardRun(f'pressure_control, {name}', 'rig_linear', scenario, {
            'actuators.ram.variants': ['pressure_control'],
            'actuators.ram.load': {'kind': 'blocked'}})
    for seed, (sensor, values) in enumerate(SENSORS.items()):
        for name in ('sine 20 mm 3 Hz', 'push 3 kN'):
            yield HardRun(f'{sensor}, {name}', 'rig_linear', LINEAR[name],
                          {f'{PLANT}{key}': value for key, value in values.items()}
                          | {'seed': seed})


def _of_times() -> Iterator[HardRun]:
    """Yield other ticks, conversions and links."""
    for step, offset in ((0.2, 0.0), (0.5, 0.12), (1.0, 0.5), (2.0, 0.12), (5.0, 1.0)):
        for name in HARD:
            yield HardRun(f'tick {step:g} ms, {name}', 'rig_linear', LINEAR[name],
                          {'step_ms': step, 'controller_offset_ms': offset})
    for link, tree in LINKS.items():
        yield HardRun(link, 'rig_linear', LINEAR['sine 20 mm 3 Hz'],
                      {'link': {'kind': 'ethercat', **tree}})


def _of_the_leg() -> Iterator[HardRun]:
    for ground in ('wood', 'rubber', 'metal'):
        for height in (50.0, 100.0, 150.0):
            yield HardRun(f'leg falls {height / 10.0:g} cm on {ground}', 'leg', 'drop', {
                'leg.ground': ground, 'scenario.leg.foot_height_mm': height})
    for stiffness, damping in ((5e4, 2000.0), (2e5, 6000.0)):
        yield HardRun(f'leg falls on {stiffness:g} N/m', 'leg', 'drop', {
            f'scenario.tracks.{joint}[0].{key}': value for joint in ('hfe', 'kfe')
            for key, value in (('stiffness', stiffness), ('damping', damping))})
    for supply in ('16.0 MPa', 'accumulator'):
        for scenario in ('drop', 'trot_leg'):
            yield HardRun(f'leg, {supply}, {scenario}', 'leg', scenario,
                          {'supply': SUPPLIES[supply]})
    for joint in ('hfe', 'kfe'):
        yield HardRun(f'data_sheet_sensors in {joint}', 'leg', 'drop',
                      {f'actuators.{joint}.variants': ['data_sheet_sensors']})
