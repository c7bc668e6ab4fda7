"""Runs of any number of actuators, those of one leg after another, each with its own load."""

from copy import deepcopy
from pathlib import Path

from isa_ros.bench.spec import LEG, ONE_PROCESS, QUADRUPED, Spec
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.text.yaml_text import dump, Tree
from isa_ros.run.options import Request

TICK_S = 1e-3
SHIPPED = {LEG: 'drop.yaml', QUADRUPED: 'quadruped_trot.yaml'}
"""Scenarios of the plants that are shipped run files."""
_PATTERN: tuple[tuple[str, Tree], ...] = (
    ('haa', {
        'model': 'smart_manifold', 'load': {'kind': 'wheel'}, 'initial_position_deg': 50.0}),
    ('hfe', {'model': 'isa_v5', 'load': {'kind': 'mass'}, 'initial_position_mm': 50.0}),
    ('kfe', {'model': 'isa_v5', 'load': {'kind': 'mass'}, 'initial_position_mm': 50.0}),
)


def rigs_file(n_actuators: int) -> str:
    """Return a run file of ``n_actuators`` that hold their positions: HAA, HFE, KFE, HAA, ..."""
    actuators: Tree = {}
    for k in range(n_actuators):
        leg, joint = divmod(k, len(_PATTERN))
        name, tree = _PATTERN[joint]
        # A copy: run files must not contain aliases.
        actuators[f'{name}_{leg + 1}'] = deepcopy(tree) | {'preset': 'default'}
    return dump({
        'name': f'rigs_{n_actuators}', 'step_ms': 1e3 * TICK_S, 'controller_offset_ms': 0.12,
        'tick_timeout_s': 5.0,
        'supply': {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
        'actuators': actuators})


def config_of(plant: str, directory: Path) -> Path:
    """Return the run file of a spec's plant, which may be new in ``directory``."""
    if plant in SHIPPED:
        return find(f'{plant}.yaml', CONFIG)
    config = directory / f'rigs_{plant}.yaml'
    config.write_text(rigs_file(int(plant)), encoding='utf-8')
    return config


def request_of(spec: Spec, directory: Path) -> Request:
    """Return the request of a spec's run; its files are in ``directory``."""
    return Request(
        config=config_of(spec.plant, directory),
        scenario=find(SHIPPED[spec.plant], SCENARIOS) if spec.plant in SHIPPED else None,
        out=directory / 'bag',
        duration_s=spec.ticks * TICK_S, in_process=spec.way == ONE_PROCESS, join_timeout_s=120.0,
        is_alone=True)
