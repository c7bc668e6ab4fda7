"""
Parameters that are too fast for the plant's step, found before a run breaks.

`isa_ros.plant.linearised` has the equations; here are the parameters that they come from.
"""

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
import math
from typing import Any, NamedTuple

from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.core.units import MILLI, of_coordinate, quantity
from isa_ros.errors import ParameterError
from isa_ros.plant.hose import soft_volume
from isa_ros.plant.linearised import fastest_rate, is_followed, LoadSide
from isa_ros.plant.load_holding import least_lag, NO_HOLDING
from isa_ros.plant.plant import MotorPlant, RotaryPlant
from isa_ros.plant.thermal import coldest, warm
import numpy as np

_FACTORS = 1e9      # a parameter is looked for between a value and that many times less or more
_HALVINGS = 60
_NAMED = 5          # parameters in one message
_SLOWER = 0.9           # half of a parameter that makes the plant fast leaves less of its rate
_KELVIN = 0.01      # within which a least temperature is found
_HOTTEST = 120.0    # celsius: beyond it seals fail, and mineral oil decays


class _Knob(NamedTuple):
    """One parameter: its name, its fields in a section of `PLANT`, whether less of it helps."""

    name: str
    section: str
    fields: tuple[str, ...]
    less_helps: bool


_KNOBS = (
    _Knob('mechanics.inertia', 'mechanics', ('inertia',), False),
    _Knob('mechanics.sensor_stiffness', 'mechanics', ('k_s',), True),
    _Knob('mechanics.sensor_damping', 'mechanics', ('d_s',), True),
    _Knob('mechanics.stop_stiffness', 'mechanics', ('k_stop',), True),
    _Knob('mechanics.stop_damping', 'mechanics', ('d_stop',), True),
    _Knob('friction.bristle_stiffness', 'friction', ('sigma0',), True),
    _Knob('friction.bristle_damping', 'friction', ('sigma1',), True),
    _Knob('friction.viscous', 'friction', ('sigma2',), True),
    _Knob('drive.bore_mm', 'chambers', ('area_a', 'area_b'), True),
    _Knob('drive.displacement_cc_per_rad', 'chambers', ('area_a', 'area_b'), True),
    _Knob('oil.dead_volume_ml', 'chambers', ('dead_volume',), False),
    _Knob('cushion_a.trapped_ml', 'cushion_a', ('dead',), False),
    _Knob('cushion_b.trapped_ml', 'cushion_b', ('dead',), False),
    _Knob('oil.effective_bulk_modulus', 'chambers', ('beta',), True),
    _Knob('oil.cross_port_leakage', 'chambers', ('c_li',), True),
    _Knob('spool.natural_frequency_rad_per_s', 'spool', ('w_n',), True),
    _Knob('spool.damping_ratio', 'spool', ('zeta',), True),
    _Knob('spool.loop_gain_per_s', 'spool', ('k_loop',), True),
    _Knob('coil.coil_inductance', 'coil', ('inductance',), False),
    _Knob('coil.bandwidth_rad_per_s', 'coil', ('p_c',), True))
_PARTS = ('cushion_a', 'cushion_b')
_OF_LOAD = (('inertia', 'kg | kg m2', False), ('stiffness', 'N/m | Nm/rad', True),
            ('damping', 'Ns/m | Nms/rad', True))


def refuse_too_fast(plant: np.record, sheet: object, load: LoadSide) -> None:
    """
    Refuse a `PLANT` record with a motion that the plant's step cannot follow.

    Raises
    ------
    ParameterError
        Names the parameters of ``sheet`` of which the change of a single one suffices, the
        smallest change first, and their bounds.

    """
    _refuse_lags(plant)
    _refuse(plant, sheet, load, '')
    if plant.thermal.is_on:
        for celsius in (coldest(plant.thermal), _HOTTEST):
            warmed = plant.copy()
            warm(celsius, warmed)
            _refuse(warmed, sheet, load, f' with oil at {celsius:g} celsius')


def coldest_followed(plant: np.record, load: LoadSide, least: float) -> float:
    """
    Return the least temperature of its oil, from ``least`` celsius on, that the step can follow.

    ``plant`` is a `PLANT` with a temperature of its own, which the step follows at the values of
    its sheet. -inf: it follows all.
    """
    def follows(celsius: float) -> bool:
        warmed = plant.copy()
        warm(celsius, warmed)
        return is_followed(warmed, load)
    if follows(least):
        return -math.inf
    cold, enough = least, coldest(plant.thermal)
    while enough - cold > _KELVIN:
        middle = 0.5 * (cold + enough)
        cold, enough = (cold, middle) if follows(middle) else (middle, enough)
    return float(enough)


def _refuse_lags(plant: np.record) -> None:
    """Refuse a load-holding valve that swings on its oil faster than a step resolves."""
    if not plant.hoses.is_on:
        return
    at_hose = plant.hoses.beta / soft_volume(plant.hoses)
    at_chamber = plant.chambers.beta / plant.chambers.dead_volume
    for name in ('holding_a', 'holding_b'):
        own = plant[name]
        if own.kind == NO_HOLDING:
            continue
        least = least_lag(own, at_chamber, at_hose, plant.relief.p_open)
        if own.lag < least:
            raise ParameterError(
                f'plant.{name}.lag_ms = {own.lag / MILLI:g} ms, must be >= {least / MILLI:.3g} ms '
                'with its flow, its opening_mpa and the oil at both ends, for the plant step of '
                f'{PLANT_STEP_NS / 1e3:g} us')


def _refuse(plant: np.record, sheet: object, load: LoadSide, when: str) -> None:
    """Refuse a `PLANT` record as `refuse_too_fast`; ``when`` ends the message."""
    if is_followed(plant, load):
        return
    changes = [*_changes_of_plant(plant, sheet, load), *_changes_of_load(plant, sheet, load)]
    changes.sort(key=lambda change: change.size)
    bounds = '; or '.join(change.bound for change in changes[:_NAMED]) or (
        'moving part, force sensor, oil, friction and load are too fast together')
    text = f'{bounds}, for the plant step of {PLANT_STEP_NS / 1e3:g} us{when}'
    if len(changes) < _NAMED and (reasons := _reasons(plant, sheet, load)):
        text += f'; {" and ".join(reasons)} make it fast together'
    raise ParameterError(text)


def _reasons(plant: np.record, sheet: object, load: LoadSide) -> list[str]:
    """Return the parameters of which no single one suffices, but half of it slows the plant."""
    fastest, found = fastest_rate(plant, load), []
    for knob, value, unit in _values(sheet):
        def follows(factor: float) -> bool:
            return is_followed(_scaled(plant, knob, factor), load)
        slower = fastest_rate(_scaled(plant, knob, 0.5 if knob.less_helps else 2.0), load)
        if slower < _SLOWER * fastest and _least_factor(follows, knob.less_helps) is None:
            found.append(f'plant.{knob.name} = {quantity(f"{value:g}", unit)}')
    return found


class _Change(NamedTuple):
    """A single parameter's change that suffices."""

    factor: float
    bound: str
    is_part: bool = False
    """Whether it is that of a part, which is named before half as large ones of the whole."""

    @property
    def size(self) -> float:
        """Return how large the change is, as a factor above 1."""
        size = max(self.factor, 1.0 / self.factor)
        return 0.5 * size if self.is_part else size


def _changes_of_plant(plant: np.record, sheet: object, load: LoadSide) -> Iterator[_Change]:
    for knob, value, unit in _values(sheet):
        def follows(factor: float) -> bool:
            return is_followed(_scaled(plant, knob, factor), load)
        factor = _least_factor(follows, knob.less_helps)
        if factor is not None:
            found = _change(f'plant.{knob.name}', value, unit, factor, knob.less_helps)
            yield found._replace(is_part=knob.section in _PARTS)


def _values(sheet: object) -> Iterator[tuple[_Knob, float, str]]:
    """Yield the knobs that a sheet has, their values and units; '' for a property."""
    for knob in _KNOBS:
        part, name = knob.name.split('.')
        own: Any = getattr(sheet, part, None)
        value = getattr(own, name, 0.0)
        if value > 0.0:
            unit = {f.name: f.metadata.get('unit', '') for f in fields(own)}.get(name, '')
            yield knob, value, of_coordinate(unit, _is_rotary(sheet))


def _is_rotary(sheet: object) -> bool:
    return isinstance(sheet, (RotaryPlant, MotorPlant))


def _scaled(plant: np.record, knob: _Knob, factor: float) -> np.record:
    """Return the record for ``factor`` times the parameter."""
    changed = plant.copy()
    section = changed[knob.section]
    if knob.name == 'drive.bore_mm':        # with the rod as it is
        rod = section['area_a'] - section['area_b']
        section['area_a'] *= factor * factor
        section['area_b'] = section['area_a'] - rod
        section['swept_a'], section['swept_b'] = section['area_a'], section['area_b']
        return changed
    for name in knob.fields:
        section[name] *= factor
    if knob.section == 'chambers' and 'area_a' in knob.fields and section['swept_a']:
        section['swept_a'], section['swept_b'] = section['area_a'], section['area_b']
    return changed


def _changes_of_load(plant: np.record, sheet: object, load: LoadSide) -> Iterator[_Change]:
    for (field, unit, less_helps), name in zip(_OF_LOAD, load.names):
        value = getattr(load, field)

        def follows(factor: float) -> bool:
            return is_followed(plant, replace(load, **{field: value * factor}))
        if 0.0 < value < math.inf and (
                factor := _least_factor(follows, less_helps)) is not None:
            yield _change(f'load.{name}', value, of_coordinate(unit, _is_rotary(sheet)), factor,
                          less_helps)


def _change(name: str, value: float, unit: str, factor: float, less_helps: bool) -> _Change:
    sign = '<=' if less_helps else '>='
    return _Change(factor, f'{name} = {quantity(f"{value:g}", unit)}, must be {sign} '
                   f'{quantity(f"{value * factor:.3g}", unit)}')


def _least_factor(follows: Callable[[float], bool], less_helps: bool) -> float | None:
    """Return the factor nearest to 1 with which the step follows, or None."""
    widest = 1.0 / _FACTORS if less_helps else _FACTORS
    if not follows(widest):
        return None
    enough, too_little = 1.0, 0.0       # exponents of the widest factor
    for _ in range(_HALVINGS):
        middle = 0.5 * (enough + too_little)
        if follows(widest ** middle):
            enough = middle
        else:
            too_little = middle
    return float(widest ** enough)
