"""
Digests of the SI records of every shipped sheet, and of each with one parameter moved by 0.05 %.

A bag shows only what its run depends on; here a wrong factor, a swapped field or a forgotten one
of any builder changes a digest. After a wanted change of a record or a value, record them again:

    python -m tests.plant.records
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
import hashlib
from pathlib import Path
from typing import Any

from isa_ros.actuator.sheet import actuator_record, ActuatorSheet
from isa_ros.config.models.catalogue import actuator_model, leg_names, leg_section, model_names
from isa_ros.config.text.parameter_sets import build
from isa_ros.core.parameter import Parameters, replaced
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import own_record
from isa_ros.surroundings.bodies.leg.inertial import Imu, imu_record
from isa_ros.surroundings.bodies.leg.sheet import leg_record, LegSheet
from isa_ros.surroundings.return_line import return_record, VolumeReturn
from isa_ros.surroundings.supply import AccumulatorSupply, supply_record
from isa_ros.text.json_file import write_tree
import numpy as np
from tests.sheets import actuator_sheet, own_load

STORED = Path(__file__).parent / 'records.json'
SHARE = 5e-4
REFUSED = 'refused'
"""Such as a rate that must be a divisor of another one."""
OFFSET_STEPS = 6
SUPPLY = AccumulatorSupply(
    pressure_mpa=20.0, return_pressure_mpa=0.1, gas_volume_l=1.0, precharge_mpa=12.0,
    polytropic_exponent=1.3, line_volume_l=0.4, bulk_modulus=1e9, pump_flow_lpm=30.0,
    pump_lag_s=0.1, pump_band_mpa=1.0, relief_mpa=22.0, relief_lpm_per_mpa=40.0)
_HEX = 10   # digits of a digest

Builder = Callable[[Any], np.ndarray]


def digests(only: str = '') -> dict[str, str]:
    """Return a digest by sheet, and by sheet and moved parameter; ``only`` of this sheet."""
    found: dict[str, str] = {}
    for name, sheet, builder, others in _sheets():
        if only not in ('', name):
            continue
        found[name] = _digest(builder(sheet))
        for key, (value, of_zero) in numbers(sheet):
            if others.get(key) != (value, of_zero):
                found[f'{name} {key}'] = _moved(sheet, key, value, of_zero, builder)
    return found


def numbers(parameters: Parameters, prefix: str = '') -> Iterator[tuple[str, tuple[Any, float]]]:
    """Yield by key every number, or list of numbers, of a set and what one that is 0 becomes."""
    for f in fields(parameters):
        value, declared = getattr(parameters, f.name), f.metadata
        if isinstance(value, Parameters):
            yield from numbers(value, f'{prefix}{f.name}.')
        elif declared.get('unit'):
            most = declared['bounds'].get('le', declared['bounds'].get('lt', 1.0))
            yield f'{prefix}{f.name}', (value, 1.0 if 'is_whole' in declared else SHARE * most)


def _sheets() -> Iterator[tuple[str, Any, Builder, Mapping[str, Any]]]:
    """Yield name, sheet, builder, and the values whose parameters are moved in another sheet."""
    for model in model_names():
        own = actuator_model(model, 'records')
        plain = dict(numbers(actuator_sheet(model)))
        for preset in own.presets:
            for variant in ('', *own.variants):
                sheet = actuator_sheet(model, preset, *([variant] if variant else []))
                is_plain = not variant and preset == 'default'
                yield (f'{model}, {preset}, {variant or "plain"}', sheet, _actuator,
                       {} if is_plain else plain)
        for kind in own.loads:
            yield f'{model}, load {kind}', own_load(model, kind), own_record, {}
    for leg in leg_names():
        yield f'leg {leg}', build(LegSheet, *leg_section(leg, 'records')), leg_record, {}
    absent = {f.name: f.metadata['absent'] for f in fields(Imu) if 'absent' in f.metadata}
    imu = Imu(link='thigh', **absent)
    yield 'imu', imu, lambda sheet: imu_record(sheet, 0), {}
    yield 'supply', SUPPLY, supply_record, {}
    line = VolumeReturn(oil_volume_l=0.5, bulk_modulus=1e9, tank_lpm_per_mpa=40.0)
    yield 'return line', line, lambda line: return_record(line, 1e5), {}


def _actuator(sheet: ActuatorSheet) -> np.ndarray:
    return actuator_record(sheet, OFFSET_STEPS)


def _moved(sheet: Any, key: str, value: Any, of_zero: float, builder: Builder) -> str:
    """Return the digest with a parameter moved up, or down, or by 1 where that is refused."""
    for other in (_other(value, SHARE, of_zero), _other(value, -SHARE, of_zero), _next(value)):
        try:
            return _digest(builder(replaced(sheet, key, other)))
        except ConfigError:
            continue
    return REFUSED


def _other(value: Any, share: float, of_zero: float) -> Any:
    if isinstance(value, (list, tuple)):
        return tuple(_other(one, share, of_zero) for one in value)
    return value * (1.0 + share) if value else of_zero


def _next(value: Any) -> Any:
    return value if isinstance(value, (list, tuple)) else value + 1.0


def _digest(record: Any) -> str:
    return hashlib.sha256(np.asarray(record).tobytes()).hexdigest()[:_HEX]


if __name__ == '__main__':
    write_tree(digests(), STORED)
