"""Every parameter of the plant at both ends of its range: it runs, or is refused by name."""

from collections.abc import Iterator
from dataclasses import fields
import random

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.core.parameter import Parameters
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.loads.sheets import linearised, static_force
from isa_ros.plant.linearised import LoadSide
from isa_ros.plant.plant import plant_record
from isa_ros.plant.step_limits import refuse_too_fast
import pytest
from tests.sheets import actuator_sheet, MODELS, override, own_load, setpoint, smart_actuator

TICKS = 200         # of 0.1 ms
SMALL = 1e-3        # of the shipped value, where a range begins above zero
N_PAIRS = 120


def parameters(sheet: Parameters, prefix: str = '') -> Iterator[tuple[str, list[float]]]:
    """Yield the dotted name and the ends of the range of every number of a sheet."""
    for field in fields(sheet):
        value, name = getattr(sheet, field.name), f'{prefix}{field.name}'
        if isinstance(value, Parameters):
            yield from parameters(value, f'{name}.')
        elif isinstance(value, (int, float)):
            bounds = field.metadata['bounds']
            low = bounds.get('ge', SMALL * value)
            yield name, [low, bounds['le']]


def run(model: str, changes: dict[str, float]) -> str | None:
    """Run an actuator on its own load with other values; return why they were refused."""
    sheet, load = actuator_sheet(model), own_load(model, 'mass')
    try:
        for name, value in changes.items():
            sheet = override(sheet, f'plant.{name}', value)
        refuse_too_fast(plant_record(sheet.plant)[0], sheet.plant, LoadSide(*linearised(load)))
    except (ConfigError, ParameterError) as error:
        return str(error)
    stroke = sheet.plant.drive.stroke
    actuator = smart_actuator(model, load, sheet=sheet)
    for position, goal in ((0.5, 0.6), (0.02, 0.0), (0.98, 1.0)):
        actuator.start(position * stroke, static_force(load), PAPER_SUPPLY, 0.0)
        actuator.accept(setpoint(position=goal * stroke))
        for _ in range(TICKS):
            actuator.tick()     # raises when a state is no longer finite
    return None


def ends(model: str) -> list[tuple[str, float]]:
    return [(name, value) for name, values in parameters(actuator_sheet(model).plant)
            for value in values]


@pytest.mark.slow
@pytest.mark.parametrize('model', MODELS)
def test_one_parameter_at_an_end_of_its_range(model):
    found = ends(model)
    assert len(found) > 80
    for name, value in found:
        refused = run(model, {name: value})
        assert refused is None or name.split('.')[-1] in refused, f'{name} = {value:g}: {refused}'


@pytest.mark.slow
@pytest.mark.parametrize('model', MODELS)
def test_two_parameters_at_ends_of_their_ranges(model):
    draw, found = random.Random(model), ends(model)
    for _ in range(N_PAIRS):
        changes = dict(draw.sample(found, 2))
        refused = run(model, changes)
        assert refused is None or any(
            name.split('.')[-1] in refused for name in changes), f'{changes}: {refused}'
