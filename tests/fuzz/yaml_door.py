"""The YAML door: types and values of every key of run files, models and scenarios are altered."""

from collections.abc import Iterator
import copy
import math
from pathlib import Path
import random
from typing import Any

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.models import catalogue
from isa_ros.config.models.own_load import own_load
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.run_config import RUN, RunConfig
from isa_ros.config.runs.run_reading import run_of, run_of_tree
from isa_ros.config.text.keys import differences
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse, read
from isa_ros.scenario.scenario import read_scenario, scenario_of
from tests.fuzz.property import refused

ODD: list[Any] = [
    None, True, False, 0, 1, 5, -1, 10**30, -10**290, 0.0, -0.0, 1e-320, 1.5, -1e308, math.nan,
    math.inf, -math.inf, '', 'x', 'off', 'hold', 'default', '5', 'a b', '\x1b[2J', 'x' * 5000,
    'null\n', '/', '*', '../../x', 'é', '\ud800', [], ['x'], [1], [[]], [None], [{}], {},
    {'a': 1}, {'kind': 'off'}, {'kind': 5}, {'kind': {'a': 1}}, {'kind': []}, {'value': 1.0},
    {'value': {}, 'source': []}, {'': ''}, {'x' * 5000: 1}]
"""What stands in the place of a value or beside it."""

RUNS = ('rig_rotary', 'rig_linear', 'rig_rotary_position', 'rig_leakage', 'leg')
SCENARIO_OF = (
    ('leg', 'drop'), ('rig_rotary', 'wheel_sine'), ('rig_rotary', 'trot'),
    ('rig_linear', 'identify_linear'), ('rig_rotary', 'weight'))
MODELS = ('isa_v2', 'isa_v5', 'smart_manifold')


def places(tree: Any) -> Iterator[tuple[Any, Any]]:
    """Yield (section or list, key or index) of every value below."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in list(items):
        yield tree, key
        if isinstance(value, (dict, list)):
            yield from places(value)


def altered(tree: Any, dice: random.Random) -> Any:
    """Return a copy with one to three values replaced, removed, renamed or added."""
    tree = copy.deepcopy(tree)
    for _ in range(dice.choice((1, 1, 1, 2, 3))):
        found = list(places(tree))
        if not found:
            return tree
        owner, key = dice.choice(found)
        act = dice.random()
        if act < 0.75:
            owner[key] = copy.deepcopy(dice.choice(ODD))
        elif act < 0.85:
            del owner[key]
        elif isinstance(owner, dict):
            name = dice.choice(('kind', 'x', '', 'model', 'load', 'y' * 300, 'feeds', 'material'))
            owner[name] = copy.deepcopy(dice.choice(ODD))
        else:
            owner.append(copy.deepcopy(dice.choice(ODD)))
    return tree


def values(value: Any) -> Iterator[float]:
    """Yield every number of a tree."""
    if isinstance(value, dict):
        for below in value.values():
            yield from values(below)
    elif isinstance(value, list):
        for below in value:
            yield from values(below)
    elif isinstance(value, (int, float)):
        yield value


def assert_well_defined(run: RunConfig) -> None:
    """Its text reads back as the same run, and every number of it is finite."""
    tree = RUN.tree(run)
    assert all(math.isfinite(value) for value in values(tree)), tree
    assert run_of_tree(tree, 'resolved.yaml') == run


def _path(name: str, directory: str) -> Path:
    return find(name, directory)


def fuzz(cases: int, seed: int) -> int:
    """Read that many altered files; return how many were refused."""
    dice = random.Random(seed)
    runs = [read(_path(name, CONFIG)) for name in RUNS]
    scenarios = [(run_of(read(_path(run, CONFIG)), Place('run.yaml'))[0],
                  read(_path(scenario, SCENARIOS))) for run, scenario in SCENARIO_OF]
    texts = [_path(name, CONFIG).read_text(encoding='utf-8') for name in RUNS]
    resolved = [run_of(tree, Place('run.yaml'))[0] for tree in runs[:1]]
    models = [read(catalogue._MODELS / f'{name}.yaml') for name in MODELS]
    doors = {
        'run': lambda: _run(altered(dice.choice(runs), dice)),
        'scenario': lambda: _scenario(*dice.choice(scenarios), dice),
        'resolved': lambda: _resolved(dice.choice(resolved), dice),
        'model': lambda: _model(altered(dice.choice(models), dice)),
        'text': lambda: parse(_garbled(dice.choice(texts), dice), 'text.yaml')}
    n_refused = 0
    for k in range(cases):
        door = dice.choices(list(doors), (5, 3, 2, 2, 4))[0]
        n_refused += refused(doors[door], f'case {k} of seed {seed}, {door}')
    return n_refused


def _garbled(text: str, dice: random.Random) -> str:
    """Return a piece of a text with some characters replaced."""
    start = dice.randrange(len(text))
    piece = list(text[start:start + dice.randrange(1, 400)])
    for _ in range(dice.randrange(5)):
        piece[dice.randrange(len(piece))] = dice.choice('{}[]:,-&*!|>%@`"\'#?~\t\n\0\x1b 0.e+')
    return ''.join(piece)


def _run(tree: Any) -> None:
    assert_well_defined(run_of(tree, Place('run.yaml'))[0])


def _scenario(run: RunConfig, tree: Any, dice: random.Random) -> None:
    scenario = read_scenario(altered(tree, dice), Place('scenario.yaml'), run)
    assert_well_defined(scenario.run)
    assert scenario_of(scenario.to_yaml(), scenario.run).tracks == scenario.tracks


def _resolved(run: RunConfig, dice: random.Random) -> None:
    tree = altered(RUN.tree(run), dice)
    for difference in differences(RUN, tree, Place('resolved.yaml')):
        assert difference.text
    assert_well_defined(run_of_tree(tree, 'resolved.yaml'))


def _model(tree: Any) -> None:
    model = catalogue.model_of(tree, 'own.yaml')
    sheets = [build(ActuatorSheet, model.with_preset(preset, 'preset'), model.place)
              for preset in model.presets]
    for variant in model.variants:
        model.with_variants(model.sheet, [variant], 'variants')
    own_load({'kind': model.default_load}, model.place, model, sheets[0])
