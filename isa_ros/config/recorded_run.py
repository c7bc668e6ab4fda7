"""
The run of a bag to read its signals by, also where another version wrote the configuration.

Signals need names, kinds and feeds of a run, but no gain and no area: where the configuration
cannot be read, a stand-in has these, and the values of the shipped models.
"""

from typing import Any, NamedTuple

from isa_ros.config.differences import modern
from isa_ros.config.models.catalogue import leg_names, model_names
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_reading import run_of_tree
from isa_ros.config.text.yaml_text import parse, Tree
from isa_ros.errors import ConfigError

_LINEAR, _ROTARY = 'isa_v5', 'smart_manifold'
_KEPT = ('name', 'source', 'step_ns', 'start_time_s')
_STATED = 'cylinder'        # a model that needs values of the run file
_SUPPLY: Tree = {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0}
_START: Tree = {
    'haa_deg': 0.0, 'hfe_deg': 41.3, 'kfe_deg': -80.0, 'foot_height_mm': 0.0, 'release_s': 0.0}


class RecordedRun(NamedTuple):
    """A run to read signals by."""

    run: RunConfig
    problem: str
    """The reason why the configuration cannot be read, so that ``run`` is a stand-in; or ''."""


def recorded_run(text: str, name: str) -> RecordedRun:
    """
    Return the run of the resolved configuration in a bag; messages begin with ``name``.

    Raises
    ------
    ConfigError
        It cannot be read, and does not even name its actuators with their models.

    """
    tree = parse(text, name)
    try:
        return RecordedRun(run_of_tree(tree, name), '')
    except ConfigError as error:
        try:
            return RecordedRun(run_of_tree(_stand_in(modern(tree)), name), str(error))
        except (ConfigError, AttributeError, KeyError, TypeError):
            raise error from None


def _stand_in(tree: Any) -> Tree:
    """Return the names, kinds and feeds of a configuration, as far as signals need them."""
    found: Tree = {key: tree[key] for key in _KEPT if key in tree}
    bodies = dict(tree.get('bodies') or {})
    if 'body' in tree:
        found['body'] = _body(tree['body'])
    if bodies:
        found['bodies'] = {name: _body(body) for name, body in bodies.items()}
    moved = {actuator for body in (*bodies.values(), *([tree['body']] if 'body' in tree else []))
             for actuator in body.get('joints', {}).values()}
    found['supplies'] = {
        name: _SUPPLY | {'feeds': supply['feeds']} for name, supply in tree['supplies'].items()}
    found['actuators'] = {
        name: {'model': _model(own)} | ({} if name in moved else {'load': {'kind': 'blocked'}})
        for name, own in tree['actuators'].items()}
    return found


def _body(body: Any) -> Tree:
    """Return a body with the shipped leg's values; another kind as it is."""
    if body['kind'] != 'leg':
        return dict(body)
    model = body.get('model')
    return {'kind': 'leg', 'model': model if model in leg_names() else leg_names()[0],
            'joints': body['joints'], 'start': _START, 'imus': body.get('imus', {})}


def _model(own: Any) -> str:
    """Return the model of an actuator, or a shipped one of its kind."""
    model = str(own['model'])
    if model in model_names() and model != _STATED:
        return model
    return _ROTARY if own['sheet']['plant']['kind'] == 'rotary' else _LINEAR
