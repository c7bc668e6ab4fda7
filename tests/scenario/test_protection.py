"""No shipped scenario trips, and none of them makes a sound sensor implausible."""

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.conditions import BITS
from isa_ros.scenario.scenario import load_scenario
from isa_ros.simulation import Simulation
import pytest

SOUND = 1 << BITS['load_cell_implausible'] | 1 << BITS['encoder_jump']
"""Bits that only a broken sensor may set."""


@pytest.mark.parametrize(('config', 'scenario'), [
    ('leg', 'drop'), ('leg', 'trot_leg'), ('hyq_leg', 'drop'), ('rig_knee', 'force_step_high'),
    ('rig_rotary', 'impact'), ('rig_rotary', 'trot'), ('rig_rotary', 'weight_stiff'),
    ('rig_rotary', 'identify'), ('rig_rotary_position', 'weight'),
    ('rig_linear', 'identify_linear'), ('rig_cylinder', 'identify_linear'),
    ('rig_leakage', 'leakage'), ('rig_valve', 'current_step'), ('rig_valve', 'flow_gain')])
def test_no_shipped_scenario_trips(config: str, scenario: str) -> None:
    """Drops, trots, impacts, hits of the end stops, and valves at full opening."""
    run = load_run(find(config, CONFIG))
    simulation = Simulation(load_scenario(find(scenario, SCENARIOS), run))
    n_ticks = simulation.scenario.n_ticks
    assert n_ticks
    trips = warnings = 0
    for _ in range(min(n_ticks, 2000 if run.step_ns >= 1_000_000 else 6000)):
        for sample in simulation.step().values():
            trips |= int(sample.trips)
            warnings |= int(sample.warnings)
    assert (trips, warnings & SOUND) == (0, 0)
    for actuator in simulation.group.actuators:  # nor did any begin and end within a tick
        assert not actuator.memory.reu['protection']['trip_since'].any()
