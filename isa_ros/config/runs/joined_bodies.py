"""The bodies of a run file, and which actuator moves which joint of them."""

from collections.abc import Mapping, Sequence
from typing import Any

from isa_ros.config.runs.body_config import BODY, BodyConfig
from isa_ros.config.runs.body_kinds import BODY_KINDS
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.config.runs.supplies import SUPPLY
from isa_ros.config.text.names import COORDINATOR, flat
from isa_ros.config.text.sections import Place, Section
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError


def bodies_of(
        values: dict[str, Any], place: Place, step_ns: int,
        is_checked: bool) -> tuple[tuple[BodyConfig, ...], dict[str, Section]]:
    """Return the bodies that the actuators move, and the sections they were built from."""
    leg, body, named = values['leg'], values[BODY], values['bodies']
    if leg is not None and body is not None:
        raise ConfigError(place.has('has leg and body, must have one; leg is a body of that kind'))
    found = {BODY: (BODY, place / BODY, body)} if body is not None else {
        name: (f'bodies.{name}', place / 'bodies' / name, own)
        for name, own in (named or {}).items()}
    if leg is not None:
        found = {BODY: (BODY, place / 'leg', {'kind': LegConfig.kind} | leg)}
    taken = [COORDINATOR, *values['actuators'], *(values['supplies'] or [SUPPLY])]
    if is_checked:
        _refuse_shared_names(values, place)
    bodies: list[BodyConfig] = []
    origins: dict[str, Section] = {}
    for name, (key, below, own) in found.items():
        if name != BODY and name in taken:
            raise ConfigError(f'{below}: the name {name!r} is taken; taken: {", ".join(taken)}')
        config, sections = BODY_KINDS[own['kind']].of(name, own, below, step_ns, is_checked)
        bodies.append(config)
        origins |= {f'{key}.{own_key}': section for own_key, section in sections.items()}
    return tuple(bodies), origins


def _refuse_shared_names(values: dict[str, Any], place: Place) -> None:
    """Refuse an actuator of the name of a supply or body: columns and topics have these names."""
    others = dict.fromkeys(values['supplies'] or [SUPPLY], 'a supply')
    if values['leg'] is not None or values[BODY] is not None:
        others[BODY] = 'the body'
    for name in values['actuators']:
        if name in others:
            raise ConfigError(
                f'{place / "actuators" / name}: the name {name!r} is taken by {others[name]}; '
                'columns and topics have these names')
    flat_names: dict[str, str] = {}
    for name in (*values['actuators'], *others, *(values['bodies'] or ())):
        other = flat_names.setdefault(flat(name), name)
        if other != name:
            raise ConfigError(
                f'{place}: the names {other!r} and {name!r} must differ in more than the '
                'slash, which names of files do not have')


def moved_by(
        bodies: Sequence[BodyConfig], actuators: Mapping[str, Any],
        place: Place) -> dict[str, tuple[BodyConfig, str]]:
    """Return what each actuator on a body moves: the body, and its joint."""
    if not actuators:
        raise ConfigError(f'{place / "actuators"} is empty, must name at least one actuator')
    moved: dict[str, tuple[BodyConfig, str]] = {}
    for body in bodies:
        for joint, name in body.joints:
            where = f'{place}: {body.key_of(joint)} = {name!r}'
            if name not in actuators:
                raise ConfigError(f'{where} is not an actuator; {alternatives(name, actuators)}')
            if name in moved:
                other, taken = moved[name]
                raise ConfigError(f'{where} already moves {taken}' + (
                    '' if other is body else f' of {other.called}'))
            moved[name] = body, joint
    return moved
