"""Creates the actuators of a run and their surroundings from its configuration."""

from collections.abc import Mapping, Sequence
import math
from types import MappingProxyType

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.request_range import RequestRange
from isa_ros.actuator.setpoint_range import SetpointRange
from isa_ros.actuator.timing import Timing
from isa_ros.config.runs.actuator_config import ActuatorConfig
from isa_ros.config.runs.body_config import BodyFactory, BodyInputs
from isa_ros.config.runs.external_config import at_rest
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.core.signals import START
from isa_ros.loads.sheets import linearised, static_force
from isa_ros.plant.linearised import LoadSide
from isa_ros.plant.plant import plant_record
from isa_ros.plant.servo_valve import largest_flow_slope
from isa_ros.plant.step_limits import coldest_followed
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.circuits.warmth import COLDEST
from isa_ros.surroundings.feeding import SupplyCircuit
from isa_ros.surroundings.surroundings import Surroundings
import numpy as np


def timing_of(run: RunConfig) -> Timing:
    """Return the timing of every actuator of a run."""
    return Timing(run.step_ns, run.controller_offset_ns, run.seed, run.start_ns)


def group_of(run: RunConfig) -> ActuatorGroup:
    """Return the actuators of a run, each at its initial position."""
    return ActuatorGroup(run.actuators, timing_of(run))


def request_range_of(run: RunConfig) -> RequestRange:
    """Return what checks the requests of the controllers of a run."""
    return RequestRange([
        SetpointRange(actuator.name, actuator.sheet, actuator.beyond_range)
        for actuator in run.actuators])


def surroundings_of(
        run: RunConfig, factories: Mapping[str, BodyFactory] = MappingProxyType({})
        ) -> Surroundings:
    """
    Return the supplies of a run and the bodies that its actuators move, in their state at t = 0.

    ``factories`` by name make the bodies that are external.

    Raises
    ------
    ParameterError
        A supply is too small for the length of the tick.
    ConfigError
        The initial pose of a body is not possible, or an external one has no factory.

    """
    plants = [plant_record(actuator.sheet.plant)[0] for actuator in run.actuators]
    circuits = []
    for supply in run.supplies:
        rows = [run.index(name) for name in supply.feeds]
        slope = 0.0
        for row in rows:  # in this order: `sum` of Python 3.12 rounds differently
            slope += largest_flow_slope(plants[row].valve, supply.span)
        circuits.append(SupplyCircuit(
            supply.name, supply.sheet, rows, slope, _fed(run, supply, plants)))
    starts = np.zeros(len(run.actuators), START)
    starts['position'] = [actuator.initial_position for actuator in run.actuators]
    starts['force'] = [static_force(actuator.load) for actuator in run.actuators]
    bodies = {}
    for own in run.bodies:
        rows = [run.index(name) for _, name in own.joints]
        bodies[own.name] = own.body(BodyInputs(
            run.step_ns, run.seed, rows, factories.get(own.name),
            [run.actuators[row] for row in rows], run.source))
    return Surroundings(
        circuits, bodies, starts, [plant.mechanics.k_s for plant in plants], run.step_ns,
        [group.name for group in run.stop_groups])


def _fed(run: RunConfig, supply: SupplyConfig, plants: Sequence[np.record]) -> tuple[Fed, ...]:
    """Return the manifolds of a circuit that feed actuators, with their rows."""
    rows: dict[str, list[int]] = {}
    for place, name in zip(supply.places, supply.feeds):
        rows.setdefault(place, []).append(run.index(name))
    found = []
    for place, own in rows.items():
        slope = 0.0
        for row in own:
            slope += largest_flow_slope(plants[row].valve, supply.span)
        heated = [row for row in own if supply.is_warm and plants[row].thermal.is_on]
        found.append(Fed(place, slope, tuple(own), tuple(heated), max((
            _coldest(run.actuators[row], plants[row]) for row in heated), default=-math.inf)))
    return tuple(found)


def _coldest(actuator: ActuatorConfig, plant: np.record) -> float:
    """Return the least temperature of oil that an actuator's steps can follow, celsius."""
    load = LoadSide() if actuator.load is None else LoadSide(*linearised(actuator.load))
    return coldest_followed(plant, load, COLDEST)


def surroundings_in_form(run: RunConfig) -> Surroundings:
    """
    Return surroundings whose external bodies are at rest at zero, without their simulators.

    Raises as `surroundings_of`, but for external bodies.
    """
    return surroundings_of(run, bodies_in_form(run))


def bodies_in_form(run: RunConfig) -> dict[str, BodyFactory]:
    """Return what makes the external bodies of a run at rest at zero, without simulators."""
    return {own.name: at_rest for own in run.bodies if own.is_given}
