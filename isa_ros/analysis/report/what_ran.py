"""What was run, from the provenance of a bag: files, versions, seed, values, how to repeat it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.analysis.signals.signals import Signals
from isa_ros.bag.provenance import (
    BODY, CONFIGURATION, KERNELS, SCENARIO, STATE, VERSION, versions_of)
from isa_ros.bag.reader import Bag
from isa_ros.config.listing import rows
from isa_ros.config.models.catalogue import actuator_model
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.yaml_text import parse
from isa_ros.core.units import of_coordinate
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.text.table import Cells

VALUES_HEADER = ('actuator', 'parameter', 'here', 'shipped', 'unit')
_GAINS = 'reu.'
_DIGEST = 12    # of a digest, shown


class WhatRan(NamedTuple):
    """What was run."""

    rows: list[tuple[str, str]]
    """What, and its value."""
    values: list[Cells]
    """Gains, then other values that differ from the shipped ones; the header first."""
    commands: list[str]
    """That repeat the run."""
    files: Mapping[str, str]
    """Text by name: what the commands read."""


def what_ran(bag: Bag, name: str, signals: Signals) -> WhatRan:
    """
    Return what was run; ``name`` is that of the bag.

    Raises
    ------
    BagError
        The bag has no provenance, or it is damaged.
    ConfigError
        The scenario is not a YAML section.

    """
    run, provenance = signals.run, bag.provenance
    attachments, record = bag.provenance_records
    scenario = parse(provenance.scenario, SCENARIO)
    versions = versions_of(record)
    found = [
        ('bag', name), ('configuration', f'{run.name}, resolved from {run.source}'),
        ('scenario', str(scenario.get('name', '-'))),
        ('duration', f'{float(signals.time[-1]):.6g} s, {len(signals.time) - 1} ticks of '
         f'{run.step_ns / 1e6:g} ms'),
        ('seed', str(provenance.seed)),
        *_models(run.actuators),
        *((f'{BODY}{key}', value) for key, value in provenance.bodies.items()),
        ('versions', ', '.join(f'{name} {value}' for name, value in versions.items()
                               if name != KERNELS))]
    if KERNELS in versions:
        found.append((f'{VERSION}{KERNELS}', versions[KERNELS][:_DIGEST]))
    has_state = STATE in attachments
    restored = f' --restore {STATE}' if has_state else ''
    return WhatRan(
        found, [] if signals.problem else [VALUES_HEADER, *changed_values(signals)],
        [f'isa replay {name}',
         f'isa bringup {CONFIGURATION} --scenario {SCENARIO}{restored} --out again'],
        {name: data.decode('utf-8', 'replace') for name, data in attachments.items()})


def _models(actuators: Sequence[ActuatorConfig]) -> Iterator[tuple[str, str]]:
    """Yield each model and preset with its actuators."""
    found: dict[str, list[str]] = {}
    for own in actuators:
        found.setdefault(f'{own.model}, preset {own.preset}', []).append(own.name)
    for model, names in found.items():
        yield f'actuator{"s" * (len(names) > 1)}', f'{", ".join(names)}: {model}'


def changed_values(signals: Signals) -> Iterator[Cells]:
    """Yield the values of each actuator that its model, with its preset, has otherwise."""
    for own in signals.run.actuators:
        shipped = _shipped(own)
        if shipped is None:
            yield own.name, 'model', own.model, 'not shipped', ''
            continue
        before = {row.parameter: row for row in rows(shipped, {})}
        now = rows(own.sheet, {})
        differing = [row for row in now if row.value != (
            before[row.parameter].value if row.parameter in before else None)]
        for row in sorted(differing, key=lambda row: not row.parameter.startswith(_GAINS)):
            old = before.get(row.parameter)
            yield (own.name, row.parameter, row.value,
                   '-' if old is None else old.value, of_coordinate(row.unit, own.sheet.is_rotary))


def _shipped(own: ActuatorConfig) -> ActuatorSheet | None:
    """Return the sheet of an actuator's model, preset and variants; None: not shipped whole."""
    preset, *variants = own.preset.split(' + ')
    try:
        model = actuator_model(own.model, 'model')
        section = model.with_variants(
            model.with_preset(preset, 'preset'), variants, 'variants')
        return build(ActuatorSheet, section, model.place, own.sheet.is_rotary)
    except (ConfigError, ParameterError):
        return None
