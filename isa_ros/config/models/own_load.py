"""The load of a single actuator: the model's values, replaced by those of a file."""

from dataclasses import replace

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.models.catalogue import DEFAULT_PRESET, Model
from isa_ros.config.models.scaling import Scaling
from isa_ros.config.text.parameter_sets import build, build_one_of
from isa_ros.config.text.sections import merge, Place, Section, SourcedValue, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.errors import ConfigError
from isa_ros.loads.drop_rig import Wheel
from isa_ros.loads.sheets import LocalLoad


def own_load(tree: Tree, place: Place, model: Model, sheet: ActuatorSheet) -> LocalLoad:
    """Return a load of one actuator: the model's of that kind with single values replaced."""
    section = load_section(written(tree, place), place, model, sheet)
    load: LocalLoad = build_one_of(LocalLoad, section, place, sheet.is_rotary)
    return load


def load_section(own: Section, place: Place, model: Model, sheet: ActuatorSheet) -> Section:
    """
    Return the values of a load: those of ``own``, else those of the model's load of that kind.

    ``sheet`` is that of an actuator made from the model: the model's values scale with it.

    Raises
    ------
    ConfigError
        The model has no load of this kind.

    """
    rest = dict(own)
    named = rest.pop('kind', None)
    kind = named.value if isinstance(named, SourcedValue) else named
    if not isinstance(kind, str) or kind not in model.loads:
        instead = ('; a load that a program gives is body: {kind: external, actuators: [NAME]}'
                   if kind == 'external' else '')
        raise ConfigError(
            f'{place}.kind = {kind!r}, must be one of {", ".join(model.loads)}{instead}')
    base = build(ActuatorSheet, model.with_preset(DEFAULT_PRESET, 'preset'), model.place)
    section = merge(Scaling(base, sheet).section(model.loads[kind], place), rest)
    of_model = section['kind']
    assert isinstance(of_model, SourcedValue)
    return section | {'kind': replace(of_model, where=str(place / 'kind'))}


def refuse_beyond_stops(
        load: LocalLoad, position: float, is_rotary: bool, where: str) -> None:
    """
    Refuse a start outside the end stops of the load.

    Raises
    ------
    ConfigError
        The start is outside, where the stops would push the load back with a jolt.

    """
    unit = 'rad' if is_rotary else 'm'
    if isinstance(load, Wheel) and not load.stop_low <= position <= load.stop_high:
        raise ConfigError(
            f'{where}: starts at {position:.4g} {unit}, must be between the stops of its load, '
            f'{load.stop_low:g} and {load.stop_high:g} {unit}')
