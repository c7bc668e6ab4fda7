"""`isa params`: every parameter of a model, a leg or a run with unit, range and source."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any, get_type_hints, NamedTuple

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.catalogue import actuator_model, leg_names, leg_section, Model, model_names
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.run_file import read_run
from isa_ros.config.sections import build, build_one_of, Entry, kind_of, members, Section
from isa_ros.config.wires import wire
from isa_ros.core.parameter import Parameters
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad
from isa_ros.surroundings.leg.sheet import LegSheet
from isa_ros.text.table import aligned

_SYMBOLS = {'gt': '>', 'ge': '>=', 'lt': '<', 'le': '<='}


class Row(NamedTuple):
    """One parameter, as text."""

    parameter: str
    value: str
    unit: str
    bounds: str
    source: str
    meaning: str


HEADER = Row('parameter', 'value', 'unit', 'range', 'source', 'meaning')


def describe(name: str, preset: str | None = None, variants: Sequence[str] = ()) -> str:
    """
    Return the table of a packaged model or leg, or of a run file.

    ``preset`` (None: the default one) and ``variants`` apply to a model; a run file has its
    own.

    Raises
    ------
    ConfigError
        The name is unknown, the run file cannot be run, or a preset or variants are given for
        a leg or a run file.

    """
    if name in model_names():
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
        return _table(name, rows(build(LegSheet, section, place), section))
    try:
        path = find(name, CONFIG)
    except ConfigError as error:
        known = ', '.join([*model_names(), *leg_names()])
        raise ConfigError(f'{error}; models and legs: {known}') from error
    return '\n\n'.join(_run_tables(str(path)))


def rows(parameters: Parameters, section: Section) -> list[Row]:
    """Return a row for each parameter of a set and for each kind, in the order declared."""
    return list(_rows(parameters, sources(section), ''))


def _rows(parameters: Parameters, source_of: Mapping[str, str], prefix: str) -> Iterator[Row]:
    hints = get_type_hints(type(parameters))
    for f in fields(parameters):
        value, path = getattr(parameters, f.name), f'{prefix}{f.name}'
        if isinstance(value, Parameters):
            if not isinstance(hints[f.name], type):
                yield _kind_row(path, value, hints[f.name], source_of)
            yield from _rows(value, source_of, f'{path}.')
        else:
            yield Row(path, _value(value), f.metadata.get('unit', ''), _range(f.metadata),
                      source_of.get(path, f.metadata.get('source', '')), f.metadata['doc'])


def _kind_row(path: str, value: Parameters, union: Any, source_of: Mapping[str, str]) -> Row:
    doc = (type(value).__doc__ or '').strip().splitlines()[0].rstrip('.')
    return Row(f'{path}.kind', kind_of(value, union), '', ' | '.join(members(union)),
               source_of.get(f'{path}.kind', ''), doc)


def _run_tables(path: str) -> Iterator[str]:
    run, origins = read_run(path)
    given = f'{run.source}'
    for supply in run.supplies:
        yield _table(f'{supply.name} of {given}', [
            row._replace(source=given) for row in rows(supply.sheet, {})])
    yield _table('record', [
        row._replace(source=given) for row in rows(run.record.storage, {})])
    for kind in dict.fromkeys(run.actuator(name).sheet.link.kind for name in run.linked):
        yield _table(f'wire of links: {kind}', rows(*wire(kind)))
    for actuator in run.actuators:
        title = (f'actuators.{actuator.name}.parameters: {actuator.model}, '
                 f'preset {actuator.preset}')
        origin = origins.actuators[actuator.name]
        yield _table(title, rows(actuator.sheet, origin.sheet))
        if actuator.load is not None:
            yield _table(f'actuators.{actuator.name}.load: {kind_of(actuator.load, LocalLoad)}',
                         rows(actuator.load, origin.load))
    if run.leg is not None and origins.leg is not None:
        yield _table('leg.start', [
            row._replace(source=given) for row in rows(run.leg.start, {})])
        for imu in run.leg.imus:
            yield _table(f'leg.imus.{imu.name}', [
                row._replace(source=given) for row in rows(imu.sheet, {})])
        yield _table(f'leg.parameters: {run.leg.model}', rows(run.leg.sheet, origins.leg))


def _load_tables(model: Model) -> Iterator[str]:
    for name, section in model.loads.items():
        load = build_one_of(LocalLoad, section, model.place / 'loads' / name)
        kind = kind_of(load, LocalLoad)
        yield _table(f'load {name}' + (f', a {kind}' if kind != name else ''),
                     rows(load, section))


def _value(value: Any) -> str:
    if isinstance(value, tuple):
        return ', '.join(_value(one) for one in value)
    return f'{value:.10g}' if isinstance(value, float) else str(value)


def _range(declared: Any) -> str:
    if 'names' in declared:
        return ' | '.join(declared['names'])
    return ', '.join(f'{_SYMBOLS[name]} {bound:g}' for name, bound in declared['bounds'].items())


def _table(title: str, body: list[Row]) -> str:
    return '\n'.join([title, *aligned([HEADER, *body])])


def sources(section: Section, prefix: str = '') -> dict[str, str]:
    """Return the source of every value by its dotted path."""
    paths: dict[str, str] = {}
    for key, entry in section.items():
        if isinstance(entry, Entry):
            scales = f'; scales with {entry.scales_with}' if entry.scales_with else ''
            paths[f'{prefix}{key}'] = entry.source + scales
        else:
            paths |= sources(entry, f'{prefix}{key}.')
    return paths
