"""One run with the parts of a machine: hoses, load holding, return spring, motor, cushions."""

from pathlib import Path

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.text.yaml_text import dump
import yaml

FILES = ('rig_counterbalance', 'lift_table', 'winch', 'press')
TICKS = 300
SCENARIO = {
    'name': 'parts', 'duration_s': TICKS * 1e-3,
    'tracks': {
        'boom': [{'t_s': 0.0, 'position': 'hold', 'effort': 12000.0, 'stiffness': 4e5,
                  'damping': 1e4},
                 {'t_s': 0.02, 'position': 'hold', 'sine': {'amplitude': 0.02,
                                                            'frequency_hz': 2.0}}],
        'table': [{'t_s': 0.0, 'position': 0.02},
                  {'t_s': 0.02, 'position': 0.06, 'stiffness': 3e5, 'damping': 1e4}],
        'drum': [{'t_s': 0.0, 'position': 'hold'}, {'t_s': 0.02, 'position': 3.0}],
        'slide': [{'t_s': 0.0, 'position': 0.005},
                  {'t_s': 0.02, 'position': 0.1, 'stiffness': 2e6, 'damping': 1e4},
                  {'t_s': 0.12, 'position': 0.0}]},
    'faults': [{'t_s': 0.2, 'actuator': 'boom', 'set': {'plant.hoses.burst_a': 1.0}},
               {'t_s': 0.22, 'actuator': 'table', 'set': {'plant.return_spring.broken': 1.0}}]}


def written(directory: Path) -> tuple[Path, Path]:
    """Write run file and scenario into a directory, and return both."""
    trees = [yaml.safe_load(Path(find(f'{name}.yaml', CONFIG)).read_text()) for name in FILES]
    config, scenario = directory / 'parts.yaml', directory / 'motion.yaml'
    config.write_text(dump({
        **trees[0], 'name': 'parts', 'seed': 3,
        'actuators': {key: own for tree in trees for key, own in tree['actuators'].items()}}))
    scenario.write_text(dump(SCENARIO))
    return config, scenario
