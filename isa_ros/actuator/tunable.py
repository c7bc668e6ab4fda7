"""
Parameters that may change during a run: gains of the control blocks, those that fail, the load.

Users name each by the key and give it in the unit of `isa params`: ``reu.force.kp``,
``plant.spool.stuck``, ``load.force``. Rates, filters and kinds define the
structure of the loops and are fixed. The gains of the impedance are part of every setpoint;
tuning one is a setpoint that changes this gain alone.

Messages and saved states have gains and limits in SI, by names without ``reu.`` and without a
unit: ``force.kp``, ``current.kp`` in V/A for ``reu.current.kp_v_per_ma``. `named` is the only
place that translates; such names are also accepted from users, as before.
"""

from collections.abc import Iterable, Mapping

from isa_ros.actuator.link import NO_LINK
from isa_ros.actuator.overload import force_bounds
from isa_ros.actuator.sheet import ActuatorSheet, refuse_wiring
from isa_ros.actuator.usable import narrowed, unlinked, usable
from isa_ros.core.changeable import Changeable, changeables, marked, with_changes
from isa_ros.core.parameter import check
from isa_ros.core.remembered import remembered
from isa_ros.core.units import in_si, of_coordinate
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import linearised, LocalLoad
from isa_ros.plant.linearised import LoadSide
from isa_ros.plant.plant import plant_record
from isa_ros.plant.step_limits import refuse_too_fast
from isa_ros.reu.wiring import active, VARIABLES

GAINS = {'position.stiffness': 'stiffness', 'position.damping': 'damping'}
"""The gains that are part of every setpoint, and their names in a `COMMAND`."""
LOAD = 'load.'
"""How the names of values of the load begin."""
PROTECTION = 'reu.protection.'
"""How the names of what the conditions of the protection compare, and do, begin."""
_MEASURED = {
    'position': 'm | rad', 'force': 'N | Nm', 'pressure': 'Pa', 'spool': 'm', 'current': 'A'}
"""Unit of what each block controls; the current is that of coils in series."""
_FORCE = f'{LOAD}force'
_VALVE = 'm | A'  # unit, in a sheet, of an output that commands the valve


@remembered
def tunables(sheet: ActuatorSheet) -> Mapping[str, Changeable]:
    """Return the gains and limits of the blocks that are on, SI, outermost first."""
    on, narrower = active(sheet.reu), usable(sheet)
    found = {}
    for variable in on:
        inner = VARIABLES[VARIABLES.index(variable) + 1:]
        output = next((_MEASURED[name] for name in inner if name in on), 'V')
        block = getattr(sheet.reu, variable)
        for key, value, declared in marked(block, 'tunable', f'{variable}.'):
            si = in_si(declared['unit'])
            unit = si.si.replace(_VALVE, 'output')
            for word, means in (('output', output), ('measured', _MEASURED[variable])):
                unit = unit.replace(word, of_coordinate(means, sheet.is_rotary))
            of_its_own = narrowed(f'reu.{key}', declared, narrower)
            name = key
            if declared['tunable']:
                name = f'{key.rpartition(".")[0]}.{declared["tunable"]}'
            found[name] = Changeable(name, value * si.scale, {
                'doc': of_its_own['doc'], 'unit': of_coordinate(unit, sheet.is_rotary),
                'bounds': {bound: limit * si.scale
                           for bound, limit in of_its_own['bounds'].items()}},
                f'reu.{key}', si.scale, declared['unit'] if si.scale != 1.0 else '')
    return found


def refuse_unusable(sheet: ActuatorSheet) -> None:
    """
    Refuse gains that no loop of this actuator can use.

    Raises
    ------
    ParameterError
        A gain or limit is beyond what is `usable`.

    """
    for gain in tunables(sheet).values():
        check(f'reu.{gain.name}', gain.value, gain.declared)


@remembered
def changing(sheet: ActuatorSheet, load: LocalLoad | None = None) -> Mapping[str, Changeable]:
    """
    Return all that may change during a run: `tunables` by their names, then all others.

    Those of a ``load`` of its own have ``load.`` in front; None: it moves a body.
    """
    narrower = {**usable(sheet), **unlinked(sheet)}
    others = changeables(sheet) | ({} if load is None else {
        name: own._replace(key=name) for name, own in changeables(load, LOAD).items()})
    if _FORCE in others:
        own = others[_FORCE]
        others[_FORCE] = own._replace(declared={
            **own.declared, 'doc': f'{own.doc}{_lasting(sheet, load)}'})
    return {**tunables(sheet), **{
        name: own._replace(declared={
            **narrowed(name, own.declared, narrower),
            'unit': of_coordinate(own.unit, sheet.is_rotary)})
        for name, own in others.items()}}


def _lasting(sheet: ActuatorSheet, load: LocalLoad | None) -> str:
    """Return the words for what may stay as force on a load; empty: nothing bounds it."""
    bounds = force_bounds(sheet.plant, load)
    if bounds is None:
        return ''
    unit = of_coordinate('N | Nm', sheet.is_rotary)
    return (f'; for longer than a push {bounds[0]:.4g} to {bounds[1]:.4g} {unit}, which the '
            'relief valves of the file and the end stop bear')


def with_changed_load(
        load: LocalLoad, values: Mapping[str, float], known: Mapping[str, Changeable]
        ) -> LocalLoad:
    """
    Return a load with other values by the names of `changing`, which is ``known``.

    Values of others are left out.

    Raises
    ------
    ParameterError
        A value is out of its range.

    """
    return with_changes(load, {
        name: own._replace(key=name.removeprefix(LOAD)) for name, own in known.items()
        if name.startswith(LOAD)}, {
        name: value for name, value in values.items() if name.startswith(LOAD)})


def refuse_load(names: Iterable[str], load: LocalLoad | None) -> None:
    """
    Refuse names of values of a load where the actuator has none of its own.

    Raises
    ------
    ConfigError
        It moves a body.

    """
    if load is None:
        for name in names:
            if name.startswith(LOAD):
                raise ConfigError(f'{name} is not used: the actuator moves a body')


def changed_together(
        sheet: ActuatorSheet, load: LocalLoad | None, values: Mapping[str, float],
        known: Mapping[str, Changeable]) -> tuple[ActuatorSheet, LocalLoad | None]:
    """
    Return sheet and load with other values by the names of `changing`, which is ``known``.

    Raises
    ------
    ConfigError
        As `with_changed`, the load becomes too fast for the plant's step, or the actuator has no
        load of its own.

    """
    refuse_load(values, load)
    of_load = [name for name in values if name.startswith(LOAD)]
    changed = with_changed(
        sheet, {name: value for name, value in values.items() if name not in of_load}, known)
    if load is None or not of_load:
        return changed, load
    moved = with_changed_load(load, values, known)
    if linearised(moved) != linearised(load):
        refuse_too_fast(plant_record(changed.plant)[0], changed.plant,
                        LoadSide(*linearised(moved)))
    return changed, moved


def with_changed(
        sheet: ActuatorSheet, values: Mapping[str, float],
        known: Mapping[str, Changeable] | None = None) -> ActuatorSheet:
    """
    Return a sheet with other values by the names of `changing`, which is ``known``.

    Raises
    ------
    ConfigError
        As `with_changes`, a limit is beyond the stop of the spool, or the plant becomes too fast
        for its step or does not fit its REU.

    """
    if sheet.link.kind == NO_LINK.kind:
        for name in values:
            if name.startswith('link.') and values[name] != 0.0:
                raise ConfigError(
                    f'{name} is not used: there is no link, link.kind = {NO_LINK.kind}')
    changed = with_changes(sheet, changing(sheet) if known is None else known, values)
    if changed.reu is not sheet.reu or changed.plant is not sheet.plant:
        _refuse_unwatched(changed, values)
        refuse_wiring(changed)
    if changed.plant is not sheet.plant:
        refuse_too_fast(plant_record(changed.plant)[0], changed.plant, LoadSide())
    return changed


def _refuse_unwatched(sheet: ActuatorSheet, names: Iterable[str]) -> None:
    """Refuse to change what the protection compares where it is switched off."""
    if sheet.reu.protection.switch == 'off':
        for name in names:
            if name.startswith(PROTECTION):
                raise ConfigError(f'{name} is not used: {PROTECTION}switch = off')


def named(known: Mapping[str, Changeable], values: Mapping[str, float]) -> dict[str, float]:
    """
    Return values by the names of ``known``, given by its keys in the unit of the sheet.

    Names given as they are, as messages have them, stay: ``force.kp`` for ``reu.force.kp``.

    Raises
    ------
    ParameterError
        A value is out of its range.

    """
    by_key = {own.key: own for own in known.values() if own.key != own.name}
    found = {}
    for name, value in values.items():
        if name in by_key:
            own = by_key[name]
            check(name, value, own.keyed.declared)
            name, value = own.name, value * own.scale
        elif name in known:
            value = known[name].number(name, value)
        found[name] = value
    return found
