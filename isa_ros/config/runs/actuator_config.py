"""One actuator of a run: its keys, and its sheet, made from a model or given as a whole."""

import math
from typing import Any, NamedTuple

from isa_ros.actuator.link import LinkSheet
from isa_ros.actuator.overload import refuse_overload
from isa_ros.actuator.setpoint_range import BEYOND_RANGE
from isa_ros.actuator.sheet import ActuatorSheet, refuse_wiring
from isa_ros.actuator.tunable import refuse_unusable
from isa_ros.actuator.usable import refuse_timeout
from isa_ros.config.models.catalogue import actuator_model, DEFAULT_PRESET, Model
from isa_ros.config.models.links import LINK, link_of
from isa_ros.config.models.own_load import load_section, refuse_beyond_stops
from isa_ros.config.models.scaling import scaled_sheet
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import (
    ANY_NAME, choice_of, FLAG, InText, Key, Layer, NAMES, number, of_type, TEXT)
from isa_ros.config.text.parameter_sets import build, build_one_of, members
from isa_ros.config.text.sections import merge, Place, Section
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.loads.sheets import linearised, LocalLoad
from isa_ros.plant.linearised import LoadSide
from isa_ros.plant.plant import plant_record
from isa_ros.plant.step_limits import refuse_too_fast
from isa_ros.reu.wiring import mode_of

_ROUNDING = 1e-12   # m or rad, of a position given in mm or deg


@frozen
class ActuatorConfig:
    """One actuator with its whole data sheet."""

    name: str
    model: str
    preset: str
    sheet: ActuatorSheet
    load: LocalLoad | None
    """Its own load; None where it moves the body."""
    initial_position: float
    """m or rad."""
    beyond_range: str | None = None
    """Treatment of a setpoint beyond the range, one of `BEYOND_RANGE`; None: the first."""
    auto_enable: bool = True
    """Whether it is enabled once it is initialised."""
    mode: str | None = None
    """Mode at t = 0; None: the one with every block that is on."""


ACTUATOR = KeyTable((
    Key('model', ANY_NAME, 'the packaged model', None, 'required', InText.ALWAYS),
    Key('preset', TEXT, 'the gains of the model', DEFAULT_PRESET),
    Key('variants', NAMES, 'variants of the model, in their order', [], in_text=InText.NEVER),
    Key('parameters', Layer(ActuatorSheet), 'values of the sheet that replace those of the model',
        {}, in_text=InText.NEVER),
    Key(LINK, Layer(LinkSheet), 'its own link; what it leaves out is as for all', {},
        in_text=InText.NEVER),
    number('initial_position_mm', 'mm', 'start of a linear actuator on a load of its own', None,
           meant='mid stroke', in_text=InText.NEVER),
    number('initial_position_deg', 'deg', 'start of a rotary actuator on a load of its own', None,
           meant='mid stroke', in_text=InText.NEVER),
    number('initial_position', 'm | rad', 'start of any actuator, in SI', None,
           in_text=InText.ONLY,
           instead_of=('initial_position_mm', 'initial_position_deg')),
    Key('beyond_range', choice_of(BEYOND_RANGE), 'treatment of a setpoint beyond the range', None,
        meant=BEYOND_RANGE[0]),
    Key('auto_enable', FLAG, 'whether it is enabled once it is initialised', True),
    Key('mode', TEXT, 'mode at t = 0', None, meant='every block that is on'),
    Key('load', Layer(LocalLoad),
        'its own load, by a kind of the model; values that it leaves out are those of the model; '
        'an actuator of a body has none', None, 'required'),
    Key('sheet', Layer(ActuatorSheet),
        'the whole sheet inline: of the model only the name is used, and `load` is complete', None,
        in_text=InText.ONLY)))


class Around(NamedTuple):
    """The part of a run that the section of an actuator depends on."""

    step_ns: int
    link: Section
    """Of all actuators."""
    moved: tuple[BodyConfig, str] | None
    """The body and its joint that it moves."""
    is_checked: bool
    """False for a text that was checked when it was written, perhaps by another version."""


def actuator_of(
        name: str, values: dict[str, Any], place: Place,
        around: Around) -> tuple[ActuatorConfig, dict[str, Section]]:
    """
    Return an actuator, and the sections that its sheet and load were built from.

    ``values`` are those of `ACTUATOR`.

    Raises
    ------
    ConfigError
        The model, preset or a variant does not exist, or values do not fit together.

    """
    sheet, layers, model = _sheet(values, place, around)
    load, load_side = None, LoadSide()
    if around.moved is not None:
        position = _joint_position(values, place, *around.moved, sheet)
    else:
        position = _initial_position(values, place, sheet)
        own = _load_section(values, place, model, sheet, around)
        if own is not None:
            layers['load'] = own
            load = build_one_of(LocalLoad, own, place / 'load', sheet.is_rotary)
            load_side = LoadSide(*linearised(load))
    if around.is_checked:
        if load is not None:
            refuse_beyond_stops(load, position, sheet.is_rotary, str(place))
        check(str(place / 'initial_position'), position, {
            'doc': 'within the stroke', 'unit': 'rad' if sheet.is_rotary else 'm',
            'bounds': {'ge': 0.0, 'le': sheet.plant.drive.stroke + _ROUNDING}})
        _refuse_sheet(sheet, load, load_side, place, around.step_ns)
    beyond, mode = values['beyond_range'], values['mode']
    if mode is not None:
        mode_of(mode, sheet.reu, str(place / 'mode'))
    label = ' + '.join([values['preset'], *values['variants']])
    return ActuatorConfig(
        name, values['model'], label, sheet, load, position,
        None if beyond == BEYOND_RANGE[0] else beyond, values['auto_enable'],
        mode), layers


def _sheet(
        values: dict[str, Any], place: Place,
        around: Around) -> tuple[ActuatorSheet, dict[str, Section], Model | None]:
    """Return sheet, its section by the key ``sheet``, and the model unless it is inline."""
    parameters, link, inline = values['parameters'], values[LINK], values['sheet']
    if inline is not None:
        of_type(values['model'], str, place / 'model')
        section = merge(inline, parameters)
        given, below = {**around.link, **link}, section.get(LINK, {})
        if given and isinstance(below, dict):
            section[LINK] = link_of(below, given, around.step_ns, place)
        return build(ActuatorSheet, section, place / 'sheet'), {'sheet': section}, None
    model = actuator_model(values['model'], f'{place}.model')
    of_model = model.with_variants(
        model.with_preset(values['preset'], f'{place}.preset'), values['variants'],
        f'{place}.variants') | {LINK: link_of(around.link, link, around.step_ns, place)}
    own = merge(of_model, parameters)
    model.refuse_unstated(own, of_model, place / 'parameters')
    sheet, section = scaled_sheet(
        own, of_model, model.place, place / 'parameters')
    return sheet, {'sheet': section}, model


def _joint_position(
        values: dict[str, Any], place: Place, body: BodyConfig, joint: str,
        sheet: ActuatorSheet) -> float:
    """Return where an actuator starts that moves a joint of a body, m or rad."""
    start = body.position_of(joint)
    unused = ['load'] if start is None else [
        'load', 'initial_position_mm', 'initial_position_deg',
        *(['initial_position'] if values['sheet'] is None else [])]
    for key in unused:
        if values[key] is not None:
            raise ConfigError(
                f'{place / key} is not used: the actuator moves {joint} of {body.called}, '
                f'which gives its load{"" if start is None else " and start"}')
    if start is None:
        return _initial_position(values, place, sheet)
    if values['initial_position'] is not None:
        return values['initial_position']  # type: ignore[no-any-return]
    body.refuse_reach(joint, sheet, str(place))
    return start


def _initial_position(values: dict[str, Any], place: Place, sheet: ActuatorSheet) -> float:
    """
    Return where an actuator on its own load starts, m or rad; by default at mid stroke.

    Raises
    ------
    ConfigError
        The key has the other kind's unit, or the value is outside the stroke.

    """
    key, other, unit, scale = (
        ('initial_position_deg', 'initial_position_mm', 'deg', math.radians(1.0))
        if sheet.is_rotary
        else ('initial_position_mm', 'initial_position_deg', 'mm', MILLI))
    kind = 'rotary' if sheet.is_rotary else 'linear'
    if values[other] is not None:
        raise ConfigError(f'{place / other} is unknown: the actuator is {kind}, the key is {key}')
    stroke = sheet.plant.drive.stroke
    if values[key] is None:
        given: float | None = values['initial_position']
        return 0.5 * stroke if given is None else given
    check(f'{place / key}', values[key], {
        'doc': 'within the stroke', 'unit': unit, 'bounds': {'ge': 0.0, 'le': stroke / scale}})
    return float(values[key]) * scale


def _load_section(
        values: dict[str, Any], place: Place, model: Model | None, sheet: ActuatorSheet,
        around: Around) -> Section | None:
    if values['load'] is None:
        if not around.is_checked:
            return None
        kinds = members(LocalLoad) if model is None else model.loads
        raise ConfigError(
            f'{place} has no load and moves no joint of a body; valid kinds of '
            f'load: {", ".join(kinds)}')
    load: Section = values['load']
    return load if model is None else load_section(
        load, place / 'load', model, sheet)


def _refuse_sheet(
        sheet: ActuatorSheet, load: LocalLoad | None, side: LoadSide, place: Place,
        step_ns: int) -> None:
    """Refuse blocks that do not fit, unusable values, an overload, and too fast a plant."""
    try:
        refuse_wiring(sheet)
        refuse_unusable(sheet)
        refuse_timeout(sheet, step_ns / NS_PER_SECOND)
        refuse_overload(sheet.plant, load)
        refuse_too_fast(plant_record(sheet.plant)[0], sheet.plant, side)
    except (ConfigError, ParameterError) as error:
        raise ConfigError(f'{place}: {error}') from error
