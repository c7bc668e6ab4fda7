"""The ends of declared ranges: 5 ms of a run keep to finite numbers, or end in one line."""

from collections.abc import Iterator
from dataclasses import fields
import math
import random
from typing import NamedTuple
import warnings

from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.config.runs.model_run import full_key, model_run
from isa_ros.config.runs.run_reading import run_of
from isa_ros.config.text.changes import changed
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core import parameter
from isa_ros.core.parameter import Parameters, SMALLEST
from isa_ros.core.record import first_not_finite
from isa_ros.errors import ConfigError, ParameterError, SimulationDiverged
from isa_ros.plant.friction import LEAST_STICTION
from isa_ros.scenario.scenario import idle
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import pytest
from tests.fuzz.property import Broken, refused

CASES, TICKS = 24, 5
TINY = (math.ulp(0.0), 1e-308, SMALLEST)


class Case(NamedTuple):
    """One value of one parameter of an actuator, at an end of its range."""

    tree: Tree
    model: str
    key: str
    value: float
    kind: type[Parameters] = Parameters
    """The set that declares it."""


def ends(bounds: dict[str, float]) -> set[float]:
    """Return the values at declared bounds, and the smallest ones where 0 is the lower one."""
    found = {bound if name in ('ge', 'le') else math.nextafter(
        bound, math.inf if name == 'gt' else -math.inf) for name, bound in bounds.items()}
    least = bounds.get('ge', bounds.get('gt', -math.inf))
    return found | (set(TINY) if least <= 0.0 else set())


def numbers(
        parameters: Parameters, prefix: str = ''
        ) -> Iterator[tuple[str, dict[str, float], type[Parameters]]]:
    """Yield key, bounds and owner of every single number of a set."""
    for field in fields(parameters):
        value, key = getattr(parameters, field.name), f'{prefix}{field.name}'
        if isinstance(value, Parameters):
            yield from numbers(value, f'{key}.')
        elif 'bounds' in field.metadata and 'length' not in field.metadata:
            yield key, field.metadata['bounds'], type(parameters)


def cases(model: str, variants: tuple[str, ...] = (), load: str | None = None) -> Iterator[Case]:
    """Yield the ends of every number of a model and its load."""
    tree = model_run(model, None, variants)
    if load is not None:
        tree = changed(tree, {full_key('load.kind', model): load}, model)
    own = run_of(tree, Place(model))[0].actuators[0]
    assert own.load is not None
    for key, bounds, kind in (*numbers(own.sheet), *numbers(own.load, 'load.')):
        of_run = f'actuators.{model}.{key}' if key.startswith('link.') else full_key(key, model)
        for value in sorted(ends(bounds)):
            yield Case(tree, model, of_run, value, kind)


def attempt(case: Case) -> None:
    """Run 5 ms; a number that is not finite is to be an error with the actuator's name."""
    simulation = Simulation(idle(run_of(changed(
        case.tree, {case.key: case.value}, case.model), Place(case.model))[0], 1.0))
    try:
        for _ in range(TICKS):
            simulation.step()
    except SimulationDiverged as error:
        assert error.field.startswith(f'{case.model}: ') and error.exit_code == 4
        raise
    assert first_not_finite(simulation.group.samples) is None


def fuzz(drawn: list[Case]) -> int:
    """Return how many cases were refused or diverged; warnings of numpy are errors."""
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        return sum(refused(lambda: attempt(case), f'{case.key} = {case.value!r}')
                   for case in drawn)


def test_a_value_at_the_end_of_its_range_runs_or_is_refused_in_one_line():
    drawn = random.Random(1).sample(list(cases('isa_v5')), CASES)
    assert 0 < fuzz(drawn) < CASES


@pytest.mark.long
@pytest.mark.parametrize('model', model_names())
def test_every_end_of_every_range_runs_or_is_refused_in_one_line(model):
    """Of every variant and load: each number once for the kind of part that it belongs to."""
    shipped = actuator_model(model, 'test')
    found = {(case.key, case.kind, case.value): case for variants, load in (
        *(((name,), None) for name in shipped.variants),
        *(((), name) for name in shipped.loads), ((), None))
        for case in cases(model, variants, load)}
    assert 0 < fuzz(list(found.values())) < len(found)


@pytest.mark.parametrize(('key', 'value', 'message'), [
    ('plant.oil.dead_volume_ml', 1e-308,
     'dead_volume_ml = 1e-308 ml, must be 0 or at least 1e-60 ml in magnitude'),
    ('plant.friction.stiction', SMALLEST, 'stiction = 1e-60, must be >= 1e-12 coulomb')])
def test_a_tiny_value_is_refused_with_its_key(key, value, message):
    tree = changed(model_run('isa_v5'), {full_key(key, 'isa_v5'): value}, 'isa_v5')
    with pytest.raises(ParameterError) as caught:
        run_of(tree, Place('isa_v5'))
    assert message in str(caught.value) and caught.value.exit_code == 2


def test_at_its_least_the_stiction_is_not_lost():
    """Divided by g(0) > 0: the run keeps to finite numbers."""
    tree = model_run('isa_v5')
    coulomb = run_of(tree, Place('x'))[0].actuators[0].sheet.plant.friction.coulomb
    attempt(Case(tree, 'isa_v5', full_key('plant.friction.stiction', 'isa_v5'),
                 1.001 * LEAST_STICTION * coulomb))


@pytest.mark.parametrize('force', [-2e7, 2e7])
def test_a_force_that_no_actuator_holds_is_refused_with_what_it_holds(force):
    with pytest.raises(ConfigError, match='load.force = -?2e.07 N, must be -1.557e.04 to 2.15'):
        attempt(Case(model_run('isa_v5'), 'isa_v5', full_key('load.force', 'isa_v5'), force))


@pytest.mark.parametrize('force', [-2e7, 2e7])
def test_a_push_that_no_actuator_holds_ends_with_actuator_and_quantity(force):
    """For a tick it might be held, so that nothing refuses it."""
    push = {'t_s': 0.002, 'actuator': 'isa_v5', 'set': {'load.force': force}}
    run = load(model_run('isa_v5'), duration=0.02)
    with pytest.raises(SimulationDiverged, match='^isa_v5: plant.chambers.p_a = nan at t = '):
        run.simulate(faults=[push])


def test_a_guard_that_is_missing_is_found(monkeypatch):
    """Without the smallest magnitude a chamber's stiffness overflows."""
    monkeypatch.setattr(parameter, 'SMALLEST', 0.0)
    key = full_key('plant.oil.dead_volume_ml', 'isa_v5')
    with pytest.raises(Broken, match='RuntimeWarning'):
        fuzz([Case(model_run('isa_v5'), 'isa_v5', key, 1e-308)])
