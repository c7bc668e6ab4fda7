"""`isa params`: every parameter of a model, a leg or a run with unit, range and source."""

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, get_type_hints, NamedTuple

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.usable import narrowed, Usable, usable
from isa_ros.config.models.catalogue import (
    actuator_model, leg_names, leg_section, Model, model_names)
from isa_ros.config.models.wires import wire
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.model_run import full_keys, model_run
from isa_ros.config.runs.robots import FileOf, run_with_robots
from isa_ros.config.runs.run_config import ROBOTS, RUN, RunConfig
from isa_ros.config.runs.run_reading import Origins
from isa_ros.config.text.changes import changed, Values
from isa_ros.config.text.keys import Leaf
from isa_ros.config.text.parameter_sets import build, build_one_of, kind_of, members
from isa_ros.config.text.sections import merge, Place, Section, section_at, SourcedValue, written
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.core.frozen import fields_of
from isa_ros.core.parameter import Parameters
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad
from isa_ros.plant.sheet_fit import fits, SheetFit
from isa_ros.surroundings.bodies.leg.sheet import LegSheet
from isa_ros.text.table import aligned

SET = '--set'
"""Source of a value that the command line gives."""
_SYMBOLS = {'gt': '>', 'ge': '>=', 'lt': '<', 'le': '<='}


class ListedValue(NamedTuple):
    """One parameter, as text."""

    parameter: str
    value: str
    unit: str
    bounds: str
    source: str
    meaning: str


HEADER = ListedValue('parameter', 'value', 'unit', 'range', 'source', 'meaning')


def describe(name: str, preset: str | None = None, variants: Sequence[str] = (),
             values: Values = MappingProxyType({})) -> str:
    """
    Return the table of a packaged model or leg, or of a run file.

    ``preset`` (None: the default one) and ``variants`` apply to a model; a run file has its
    own. ``values`` replace others by their keys: those of the run file, or of the actuator
    where there is one only. A model with other values is listed on its own load alone.

    Raises
    ------
    ConfigError
        The name is unknown, the run file cannot be run, a preset or variants are given for
        a leg or a run file, or a value is refused.

    """
    if name in model_names():
        if values:
            return _described(model_run(name, preset, variants), Place(name), values)
        preset = preset or 'default'
        model = actuator_model(name, 'model')
        section = model.with_variants(
            model.with_preset(preset, 'preset'), variants, 'variant')
        sheet = build(ActuatorSheet, section, model.place)
        named = ' + '.join([preset, *variants])
        return '\n\n'.join([
            _table(f'{name}, preset {named}', rows(sheet, section)), *_load_tables(model),
            f'presets: {", ".join(model.presets)}\nvariants: {", ".join(model.variants)}'])
    for option, given in (('--preset', preset), ('--variant', variants)):
        if given:
            raise ConfigError(
                f'{option} is not used: {name} is not a model, and a run file has its own; '
                f'models: {", ".join(model_names())}')
    if name in leg_names():
        section, place = leg_section(name, 'leg')
        section = merge(section, written(changed({}, values, name), Place(SET)))
        return _table(name, rows(build(LegSheet, section, place), section))
    path = find(name, CONFIG, {'models': model_names(), 'legs': leg_names()})
    return _described(read(path), Place.of(path), values)


def _described(tree: Tree, place: Place, values: Values) -> str:
    """Return the tables of a run file's tree with other values."""
    names = list(section_at(tree.get('actuators', {}), place / 'actuators'))
    if len(names) == 1:
        values = full_keys(values, names[0])
    given = changed(tree, values, place.file)
    run, origins = run_with_robots(given, place)
    return '\n\n'.join(_run_tables(
        run, origins, tuple(values), FileOf(given, place, run.source), given))


def rows(parameters: Parameters, section: Section) -> list[ListedValue]:
    """Return a row for each parameter of a set and for each kind, in the order declared."""
    narrower = usable(parameters) if isinstance(parameters, ActuatorSheet) else {}
    return list(_rows(parameters, sources(section), '', narrower))


def _rows(
        parameters: Parameters, source_of: Mapping[str, str], prefix: str,
        narrower: Mapping[str, Usable]) -> Iterator[ListedValue]:
    hints = get_type_hints(type(parameters))
    for f in fields_of(type(parameters)):
        value, path = getattr(parameters, f.name), f'{prefix}{f.name}'
        if isinstance(value, Parameters):
            if not isinstance(hints[f.name], type):
                yield _kind_row(path, value, hints[f.name], source_of)
            yield from _rows(value, source_of, f'{path}.', narrower)
        else:
            own = narrowed(path, f.metadata, narrower)
            yield ListedValue(path, _value(value), own.get('unit', ''), _range(own),
                              source_of.get(path, own.get('source', '')), own['doc'])


def _kind_row(
        path: str, value: Parameters, union: Any, source_of: Mapping[str, str]) -> ListedValue:
    doc = (type(value).__doc__ or '').strip().splitlines()[0].rstrip('.')
    return ListedValue(f'{path}.kind', kind_of(value, union), '', ' | '.join(members(union)),
                       source_of.get(f'{path}.kind', ''), doc)


def _run_tables(
        run: RunConfig, origins: Origins, changes: Sequence[str],
        file_of: FileOf, given: Tree) -> Iterator[str]:
    """Return the tables of the run ``given``; values at ``changes`` have the source `SET`."""
    yield _table(f'values of {run.source}', [
        _single(leaf, SET if _is_among(leaf.key, changes) else
                'default' if _is_unwritten(leaf, given) else file_of(leaf.key))
        for leaf in RUN.leaves(run, '') if not isinstance(leaf.value, Parameters)])
    kinds = dict.fromkeys(run.actuator(name).sheet.link.kind for name in run.linked)
    wires = [_table(f'wire of links: {kind}', rows(*wire(kind))) for kind in kinds]
    for key, parameters, _ in RUN.leaves(run, ''):
        if not isinstance(parameters, Parameters):
            continue
        if key.startswith('actuators.'):
            yield from wires
            wires = []
        title, about = _title(run, key, parameters)
        section = origins.get(key)
        found = (rows(parameters, section) if section is not None else
                 list(_rows(parameters, _given(parameters, file_of(key)), '', {})))
        yield _table(title + about, [
            row._replace(source=SET) if _is_among(f'{title}.{row.parameter}', changes) else row
            for row in found])
        if isinstance(parameters, ActuatorSheet) and (fitted := fits(parameters.plant)):
            yield _fitted(title, fitted)


def _given(parameters: Parameters, source: str, prefix: str = '') -> dict[str, str]:
    """Return the source of all values that are not those of a file which leaves them out."""
    found = {f'{prefix}kind': source}
    for f in fields_of(type(parameters)):
        value = getattr(parameters, f.name)
        if isinstance(value, Parameters):
            found |= _given(value, source, f'{prefix}{f.name}.')
        elif value != f.metadata.get('absent') or not f.metadata.get('source'):
            found[f'{prefix}{f.name}'] = source
    return found


def _fitted(title: str, found: Sequence[SheetFit]) -> str:
    """Return the table of what a data sheet states, and what the model of the valve has."""
    head = ('of the data sheet', 'stated', 'model', 'unit')
    rows = [(one.what, '-' if one.stated is None else f'{one.stated:.4g}', f'{one.model:.4g}',
             one.unit) for one in found]
    return '\n'.join([f'{title}: fitted', *aligned([head, *rows])])


def _single(leaf: Leaf, source: str) -> ListedValue:
    """Return the row of a single value that is the default, or else from ``source``."""
    row = leaf.row
    if row.kind.tree(leaf.value) == row.default:
        return ListedValue(leaf.key, row.default_words, row.kind.unit, '', 'default', row.meaning)
    return ListedValue(leaf.key, _value(leaf.value), row.kind.unit, '', source, row.meaning)


def _is_unwritten(leaf: Leaf, given: Tree) -> bool:
    """Return whether a run file has a value in no unit; a robot's file may have it instead."""
    ways = (leaf.key, *leaf.row.instead_of)
    return (len(ways) > 1 and '.' not in leaf.key and ROBOTS not in given
            and not any(key in given for key in ways))


def _title(run: RunConfig, key: str, parameters: Parameters) -> tuple[str, str]:
    """Return the key in a run file of a set of a resolved text, and what is said about it."""
    head, _, name = key.partition('.')
    if head == 'supplies':
        return name, f' of {run.source}'
    if head == 'actuators':
        name, _, part = name.partition('.')
        if part == 'load':
            return key, f': {kind_of(parameters, LocalLoad)}'
        actuator = run.actuator(name)
        return (f'{head}.{name}.parameters',
                f': {actuator.model}, preset {actuator.preset}')
    for body in run.bodies:
        of_body = f'bodies.{body.name}.' if head == 'bodies' else 'body.'
        if key.startswith(of_body):
            own = key.removeprefix(of_body)
            if own == 'sheet':
                return f'{body.label}.parameters', f': {body.model}'
            return f'{body.label}.{own}'.removesuffix('.sheet'), ''
    return key, ''


def _is_among(key: str, changes: Sequence[str]) -> bool:
    """Return whether a key, or a section that it is in, is among those of changes."""
    ways = [key]                    # the same place of a run file
    for old, new in (('leg.', 'body.'), ('', 'supplies.')):
        if key.startswith(old):
            ways.append(new + key.removeprefix(old))
    return any(f'{way}.'.startswith(f'{change}.') for change in changes for way in ways)


def _load_tables(model: Model) -> Iterator[str]:
    for name, section in model.loads.items():
        load = build_one_of(LocalLoad, section, model.place / 'loads' / name)
        kind = kind_of(load, LocalLoad)
        yield _table(f'load {name}' + (f', a {kind}' if kind != name else ''),
                     rows(load, section))


def _value(value: Any) -> str:
    if isinstance(value, tuple):
        return ', '.join(_value(one) for one in value) or 'none'
    return f'{value:.10g}' if isinstance(value, float) else str(value)


def _range(declared: Any) -> str:
    if 'names' in declared:
        return ' | '.join(declared['names'])
    return ', '.join(f'{_SYMBOLS[name]} {bound:g}'
                     for name, bound in declared.get('bounds', {}).items())


def _table(title: str, body: list[ListedValue]) -> str:
    return '\n'.join([title, *aligned([HEADER, *body])])


def sources(section: Section, prefix: str = '') -> dict[str, str]:
    """Return the source of every value by its dotted path."""
    paths: dict[str, str] = {}
    for key, entry in section.items():
        if isinstance(entry, SourcedValue):
            scales = f'; scales with {entry.scales_with}' if entry.scales_with else ''
            paths[f'{prefix}{key}'] = entry.source + scales
        else:
            paths |= sources(entry, f'{prefix}{key}.')
    return paths
