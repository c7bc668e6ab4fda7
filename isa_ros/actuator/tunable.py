"""
Parameters that may change during a run: gains of the control blocks, and those that fail.

Gains and limits are in SI and named by block and parameter: ``force.kp``,
``position.stiffness``, ``force.compensation.knee``. Rates, filters and kinds define the
structure of the loops and are fixed. The gains of the impedance are part of every setpoint;
tuning one is a setpoint that changes this gain alone.

All other parameters that may change are faults. They have key and unit of `isa params`:
``plant.spool.stuck``, ``plant.spool.null_bias.current_ma``, ``reu.frozen``.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
import math
from typing import Any, NamedTuple

from isa_ros.actuator.link import NO_LINK
from isa_ros.actuator.sheet import ActuatorSheet, refuse_wiring
from isa_ros.actuator.usable import largest_gains, REASON
from isa_ros.core.changeable import Changeable, changeables, with_changes
from isa_ros.core.parameter import check, Parameters, with_value
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MILLI, MPA, of_coordinate
from isa_ros.errors import ConfigError
from isa_ros.plant.plant import plant_record
from isa_ros.plant.step_limits import LoadSide, refuse_too_fast
from isa_ros.reu.wiring import active, VARIABLES

GAINS = {'position.stiffness': 'stiffness', 'position.damping': 'damping'}
"""The gains that are part of every setpoint, and their names in a `COMMAND`."""


class _Si(NamedTuple):
    unit: str
    scale: float  # SI per unit of the sheet


_KPA = 1e3
_IN_SI = {
    'kPa': _Si('Pa', _KPA), 'MPa': _Si('Pa', MPA), 'V/mA': _Si('V/A', 1.0 / MILLI),
    'V/(mA s)': _Si('V/(A s)', 1.0 / MILLI), 'V s/mA': _Si('V s/A', 1.0 / MILLI)}
_MEASURED = {
    'position': 'm | rad', 'force': 'N | Nm', 'pressure': 'Pa', 'spool': 'm', 'current': 'A'}
"""Unit of what each block controls; the current is that of coils in series."""
_VALVE = 'm | A'  # unit, in a sheet, of an output that commands the valve


@dataclass(frozen=True)
class Tunable:
    """One parameter that may be tuned, SI."""

    name: str
    value: float
    unit: str
    bounds: Mapping[str, float]
    """Any of ``gt``, ``ge``, ``lt``, ``le``; of a gain not more than `largest_gains`."""
    doc: str
    path: tuple[str, ...]
    """Its path in the sheet's REU."""
    scale: float
    """SI per unit of the sheet."""


def tunables(sheet: ActuatorSheet) -> dict[str, Tunable]:
    """Return the tunable parameters of the blocks that are on, by name, outermost first."""
    return {tunable.name: tunable for variable in active(sheet.reu)
            for tunable in _of_block(sheet, variable)}


def _of_block(sheet: ActuatorSheet, variable: str) -> Iterator[Tunable]:
    inner = VARIABLES[VARIABLES.index(variable) + 1:]
    on = active(sheet.reu)
    output = next((_MEASURED[name] for name in inner if name in on), 'V')
    largest = largest_gains(sheet)
    for path, value, declared in _declared(getattr(sheet.reu, variable), (variable,)):
        si = _IN_SI.get(declared['unit'], _Si(declared['unit'], 1.0))
        unit = si.unit.replace(_VALVE, 'output')
        for word, means in (('output', output), ('measured', _MEASURED[variable])):
            unit = unit.replace(word, of_coordinate(means, sheet.is_rotary))
        name, bounds, doc = '.'.join(path), dict(declared['bounds']), declared['doc']
        if largest.get(name, math.inf) < bounds.get('le', math.inf):
            bounds['le'], doc = largest[name], f'{doc}; {REASON}'
        yield Tunable(
            name='.'.join((*path[:-1], declared['tunable'] or path[-1])),
            value=value * si.scale, unit=of_coordinate(unit, sheet.is_rotary),
            bounds={name: bound * si.scale for name, bound in bounds.items()},
            doc=doc, path=path, scale=si.scale)


def _declared(
        block: Parameters, path: tuple[str, ...]
        ) -> Iterator[tuple[tuple[str, ...], float, Mapping[str, Any]]]:
    """Yield path, value and declaration of every tunable number of a block."""
    for f in fields(block):
        value = getattr(block, f.name)
        if isinstance(value, Parameters):
            yield from _declared(value, (*path, f.name))
        elif 'tunable' in f.metadata:
            yield (*path, f.name), value, f.metadata


def refuse_unusable(sheet: ActuatorSheet) -> None:
    """
    Refuse gains that no loop of this actuator can use.

    Raises
    ------
    ParameterError
        A gain is greater than `largest_gains`.

    """
    for tunable in tunables(sheet).values():
        _check(f'reu.{tunable.name}', tunable.value, tunable)


def _check(name: str, value: float, tunable: Tunable) -> None:
    check(name, value, {'doc': tunable.doc, 'unit': tunable.unit, 'bounds': tunable.bounds})


def tuned(sheet: ActuatorSheet, values: Mapping[str, float]) -> ActuatorSheet:
    """
    Return a sheet with other values of its `tunables`, SI.

    Raises
    ------
    ConfigError
        An unknown name, a value out of its range, or beyond the stop of the spool.

    """
    known = tunables(sheet)
    reu = sheet.reu
    for name, value in values.items():
        if name not in known:
            raise ConfigError(f'{name} is unknown; {alternatives(name, known)}')
        tunable = known[name]
        _check(name, value, tunable)
        if value != tunable.value:  # an equal value is kept: converting it would round it
            reu = with_value(reu, tunable.path, value / tunable.scale)
    if reu is not sheet.reu:
        sheet = replace(sheet, reu=reu)
        refuse_wiring(sheet)
    return sheet


def changing(sheet: ActuatorSheet) -> dict[str, Tunable | Changeable]:
    """Return all that may change during a run, by name: `tunables`, then `changeables`."""
    return {**tunables(sheet), **changeables(sheet)}


def with_changed(sheet: ActuatorSheet, values: Mapping[str, float]) -> ActuatorSheet:
    """
    Return a sheet with other values of what may change, as `changing` has it.

    Raises
    ------
    ConfigError
        As `tuned` and `with_changes`, or the plant becomes too fast for its step or does not
        fit its REU.

    """
    known = changing(sheet)
    for name in values:
        if name not in known:
            raise ConfigError(f'{name} is unknown; {alternatives(name, known)}')
    own = {name: value for name, value in values.items() if isinstance(known[name], Tunable)}
    other = {name: value for name, value in values.items() if name not in own}
    changed = with_changes(tuned(sheet, own), other)
    if changed.link is not sheet.link and changed.link.kind == NO_LINK.kind:
        key = next(name for name in other if name.startswith('link.'))
        raise ConfigError(f'{key} is not used: there is no link, link.kind = {NO_LINK.kind}')
    if changed.plant is not sheet.plant:
        refuse_wiring(changed)
        refuse_too_fast(plant_record(changed.plant)[0], changed.plant, LoadSide())
    return changed


def with_si_names(sheet: ActuatorSheet, values: Mapping[str, float]) -> dict[str, float]:
    """
    Return values by the names of `changing`, given by these or by the keys of `isa params`.

    A gain by its key, ``reu.force.kp_v_per_ma``, is in the unit of its sheet.
    """
    by_key = {f'reu.{".".join(gain.path)}': gain for gain in tunables(sheet).values()}
    return {by_key[key].name if key in by_key else key:
            value * by_key[key].scale if key in by_key else value
            for key, value in values.items()}
