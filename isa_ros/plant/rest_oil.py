"""The pressures of an actuator at rest: in its chambers, and in the hoses before them."""

from isa_ros.core.kernel import kernel_function
from isa_ros.plant.chambers import hydraulic_force
from isa_ros.plant.return_spring import spring_force, vent_pressure
from isa_ros.plant.service_lines import rest_lines
import numpy as np


@kernel_function
def null_pressures(plant: np.record, supply: float, back: float) -> tuple[float, float]:
    """
    Return the pressures (Pa) into which the leaking lands divide that of the supply at null.

    An open chamber has that of its port.
    """
    lands, span = plant.valve, supply - back
    share_a = lands.f_pa * lands.f_pa / (lands.f_pa * lands.f_pa + lands.f_at * lands.f_at)
    if plant.spring.is_on:
        return back + span * share_a, vent_pressure(back, plant.spring)
    share_b = lands.f_pb * lands.f_pb / (lands.f_pb * lands.f_pb + lands.f_bt * lands.f_bt)
    return back + span * share_a, back + span * share_b


@kernel_function
def _possible(p: float, supply: float, back: float) -> float:
    """Return the pressure between return and supply that is nearest."""
    return min(max(p, back), supply)


@kernel_function
def rest_pressures(
        plant: np.record, supply: float, back: float, force: float) -> tuple[float, float]:
    """
    Return the gauge pressures (Pa) that hold ``force`` (N or Nm) with the valve near null.

    At null the leaking lands divide the supply pressure; the rest of the force comes in equal
    parts from both chambers, as far as their pressures stay between return and supply. The force
    includes that of a spring.
    """
    oil = plant.chambers
    p_a, p_b = null_pressures(plant, supply, back)
    if plant.spring.is_on:
        return _possible((force + oil.area_b * p_b) / oil.area_a, supply, back), p_b
    lacking = force - hydraulic_force(p_a, p_b, oil)
    p_a, p_b = p_a + 0.5 * lacking / oil.area_a, p_b - 0.5 * lacking / oil.area_b
    if p_b != _possible(p_b, supply, back):
        p_b = _possible(p_b, supply, back)
        p_a = (force + oil.area_b * p_b) / oil.area_a
    elif p_a != _possible(p_a, supply, back):
        p_a = _possible(p_a, supply, back)
        p_b = (oil.area_a * p_a - force) / oil.area_b
    return _possible(p_a, supply, back), _possible(p_b, supply, back)


@kernel_function
def rest_oil(
        plant: np.record, supply: float, back: float, force: float, state: np.record) -> None:
    """
    Put chambers and hoses of a `PLANT_STATE` at the pressures of rest, where its piston is.

    ``force`` is what the actuator holds outside; the oil holds its spring, too. A hose has the
    pressure of its chamber, or behind a load-holding valve that of the null if it is lower: a
    higher one would enter the chamber.
    """
    if plant.spring.is_on:
        force += spring_force(state.mechanics.position, plant.spring)
    state.chambers.p_a, state.chambers.p_b = rest_pressures(plant, supply, back, force)
    null_a, null_b = null_pressures(plant, supply, back)
    p_a, p_b = float(state.chambers.p_a), float(state.chambers.p_b)
    rest_lines(plant, (min(p_a, null_a) if plant.holding_a.kind else p_a,
                       min(p_b, null_b) if plant.holding_b.kind else p_b), state.lines)
