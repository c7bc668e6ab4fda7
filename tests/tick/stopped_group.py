"""Three actuators on one supply, two of which stop together."""

import isa_ros
from isa_ros.config.text.yaml_text import Tree
from isa_ros.scripting.run import Run
from isa_ros.simulation import Simulation

SHIFTED = {'plant.spool.null_bias.current_ma': 2.0}
SUPPLY = {
    'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0, 'gas_volume_l': 0.32,
    'precharge_mpa': 12.0, 'polytropic_exponent': 1.3, 'line_volume_l': 0.5,
    'bulk_modulus': 1e9, 'pump_flow_lpm': 12.0, 'pump_lag_s': 0.03, 'pump_band_mpa': 0.5,
    'relief_mpa': 22.5, 'relief_lpm_per_mpa': 10.0, 'dump': {'kind': 'valve'}}
LINKED = {'kind': 'ethercat', 'cycle_ms': 1.0, 'delay_cycles': 1.0, 'jitter_us': 0.0,
          'loss': 0.0, 'watchdog_ms': 8.0}
ENDED_MS = 300  # ramp, 200 ms at rest, and closing poppets
SCENARIO: Tree = {
    'name': 'stopped', 'duration_s': 0.6,
    'tracks': {'right': [{'t_s': 0.0, 'position': 0.07},
                         {'t_s': 0.56, 'enabled': True, 'position': 'hold'}]},
    'faults': [{'t_s': 0.04, 'emergency_stop': 'pair', 'until_s': 0.45},
               {'t_s': 0.2, 'actuator': 'left', 'set': SHIFTED}]}


def tree(group: Tree | None = None, **more: object) -> Tree:
    """Return a run file of three actuators with block valves; ``left`` and ``right`` stop both."""
    protection = {'spool_deviation': {'delay_ms': 10.0, 'reaction': 'block'}}
    actuator: Tree = {
        'model': 'isa_v5', 'load': {'kind': 'mass'}, 'initial_position_mm': 50.0,
        'parameters': {'plant': {'block_valve': {'kind': 'poppet'}},
                       'reu': {'protection': protection}}}
    return {
        'name': 'three', 'supply': SUPPLY,
        'actuators': {name: actuator for name in ('left', 'right', 'other')},
        'emergency_stops': {'pair': {'actuators': ['left', 'right']} | (group or {})}} | more


def run(group: Tree | None = None, **more: object) -> Run:
    return isa_ros.load(tree(group, **more))


def advance(simulation: Simulation, n_ticks: int) -> None:
    for _ in range(n_ticks):
        simulation.step()


def states(simulation: Simulation) -> list[int]:
    return [int(simulation.samples[name].device_state) for name in simulation.names]


def lifts(simulation: Simulation) -> list[float]:
    return [float(own._body.plant.block.lift) for own in simulation.group.actuators]


def dumped(simulation: Simulation) -> float:
    return float(simulation.supply_samples['supply'].dump_opening)


def moving(group: Tree | None = None, **more: object) -> Simulation:
    """Return a run in which all three move."""
    simulation = run(group, **more).simulation()
    for name in simulation.names:
        simulation.command(name, position=0.07)
    advance(simulation, 40)
    return simulation
