"""A drop of the leg with all that disturbs a run: noise, faults, lossy links, emergency stops."""

from pathlib import Path

import isa_ros
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.text.changes import values_of
from isa_ros.scripting.run import Run

TICKS = 300
SEED = 5
FAULTS = (
    '{t_s: 0.05, actuator: kfe, fault: internal_leak, until_s: 0.2}',
    '{t_s: 0.08, actuator: hfe, fault: load_cell_offset}',
    '{t_s: 0.1, actuator: haa, fault: link_lost, until_s: 0.15}',
    '{t_s: 0.12, supply: supply, fault: supply_low, until_s: 0.22}',
    '{t_s: 0.2, emergency_stop: hip, until_s: 0.24}',
    '{t_s: 0.24, actuator: kfe, set: {plant.sensors.pressure_a.lost: 1.0}}')
"""
A leak, a sensor, a cable, which trips `link_lost`, half of the supply pressure, an emergency stop,
and a wire, whose trip stops the other cylinder and dumps the supply.
"""
OPTIONS = (
    *(text for name in ('haa', 'hfe', 'kfe')
      for text in ('--set', f'actuators.{name}.variants=[data_sheet_sensors]')),
    '--set', 'leg.imus.trunk={link: slider_link, accelerometer_sigma: 0.03, gyro_sigma: 6.0e-4}',
    '--set', 'link={kind: ethercat, cycle_ms: 0.5, delay_cycles: 2, jitter_us: 200, loss: 0.1, '
             'watchdog_ms: 8}',
    '--set', 'supply.dump={kind: lag}',
    '--set', 'actuators.kfe.parameters.plant.block_valve={kind: poppet}',
    '--set', 'emergency_stops={hip: {actuators: [haa], dumps: never}, '
             'cylinders: {actuators: [hfe, kfe], dumps: at_once}}',
    '--set', f'scenario.faults=[{", ".join(FAULTS)}]')
"""Of the command line, for leg.yaml with drop.yaml."""


def disturbed_run() -> Run:
    """Return the run in memory."""
    config, scenario = (Path(find(name, place)) for name, place in (
        ('leg.yaml', CONFIG), ('drop.yaml', SCENARIOS)))
    return isa_ros.load(config, scenario, seed=SEED, duration=TICKS * 1e-3).replace(
        values_of(OPTIONS[1::2], '--set'))
