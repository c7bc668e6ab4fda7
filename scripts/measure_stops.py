"""
Stops of moving and loaded actuators: how far they go, what they cost, and whether they rest.

The yardstick of a travel is `v^2/2a + v T`, with the speed v of the piston, the declared
deceleration a and the lag T of the valve, which starts to close that much late.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from isa_ros.actuator.ratings import valve_lag
from isa_ros.actuator.rows import Memory
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.device import ENABLED, FAULT_REACTION, QUICK_STOP
from isa_ros.core.record import row_record
from isa_ros.plant.plant import plant_record
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import numpy as np
from numpy.typing import NDArray

STEP_S = 2e-4
LONGEST_S = 1.0
"""Within which a speed is reached."""
SOFT: Mapping[str, float] = {'stiffness': 1e4, 'damping': 300.0}
ACCUMULATOR: Tree = {
    'kind': 'accumulator', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0, 'gas_volume_l': 0.32,
    'precharge_mpa': 12.0, 'polytropic_exponent': 1.3, 'line_volume_l': 0.5,
    'bulk_modulus': 1.0e9, 'pump_flow_lpm': 12.0, 'pump_lag_s': 0.03, 'pump_band_mpa': 0.5,
    'relief_mpa': 22.5, 'relief_lpm_per_mpa': 10.0, 'return_line': {'kind': 'held'}}


class Stopped(NamedTuple):
    """What a stop was, SI of the actuator."""

    speed: float
    """Of the piston or rotor, at the command."""
    peak_speed: float
    """Largest from the command on: what the oil has stored still drives the load."""
    expected: float
    """v^2/2a + v T of the speed at the command."""
    expected_of_peak: float
    """That of the largest speed."""
    travel: float
    """From the command to the farthest position in the direction of the speed."""
    bounce: float
    """Back from there, at most."""
    peak_force: float
    """Largest of the force sensor, without its sign."""
    swing: float
    """Largest less smallest force in the last tenth of the time."""
    drift: float
    """Largest distance from the held position in the same time."""

    @property
    def ratio(self) -> float:
        """Return the travel over the expected one."""
        return self.travel / self.expected


def rig(model: str = 'isa_v5', *, mass: float = 50.0, force: float = 0.0,
        position: float = 0.5, supply: Tree | None = None, load_kind: str = 'mass',
        supply_mpa: float = 20.7, variants: tuple[str, ...] = (),
        parameters: Tree | None = None, stroke: float = 0.1) -> Tree:
    """
    Return the run file of one actuator with a mass (kg | kg m2), under a force (N | Nm).

    ``position`` is the share of the ``stroke`` (m | rad) at which it starts.
    """
    own: dict[str, Any] = {'kind': load_kind}
    if load_kind == 'mass':
        own |= {'inertia': mass, 'force': force}
    place = position * stroke
    start: Tree = ({'initial_position_deg': float(np.degrees(place))}
                   if model == 'smart_manifold' else {'initial_position_mm': 1e3 * place})
    constant: Tree = {'kind': 'constant', 'pressure_mpa': supply_mpa, 'return_pressure_mpa': 0.0}
    return {
        'name': 'stop_rig', 'step_ms': 1e3 * STEP_S, 'controller_offset_ms': 0.02,
        'tick_timeout_s': 5.0, 'supply': supply or constant,
        'actuators': {'ram': {
            'model': model, 'load': own, **start, 'variants': list(variants),
            'parameters': parameters or {}}}}


def simulation_of(config: Tree | str, changes: Mapping[str, Any] | None = None) -> Simulation:
    """Return the run, with values by key changed, ready at t = 0."""
    run = load(config)
    return (run.replace(changes) if changes else run).simulation()


def lag_of(simulation: Simulation, name: str) -> float:
    """Return the lag of an actuator's valve in s."""
    sheet = simulation.scenario.run.actuator(name).sheet
    return valve_lag(plant_record(sheet.plant)[0], sheet.reu)


def advance(simulation: Simulation, seconds: float, name: str = 'ram') -> NDArray[np.float64]:
    """
    Advance; return position, exact speed, force, current and state of each tick, (n, 5).

    The estimated speed is late by some ms.
    """
    step_s = simulation.scenario.run.step_ns * 1e-9
    memory = memory_of(simulation, name)
    rows = []
    for _ in range(round(seconds / step_s)):
        own = simulation.step()[name]
        rows.append((own.position, exact_speed(memory), own.force, own.current_reference,
                     own.device_state))
    return np.array(rows)


def accelerate(simulation: Simulation, speed: float, name: str = 'ram') -> None:
    """
    Advance until the estimated speed (m/s | rad/s) is reached.

    Raises
    ------
    ValueError
        It is not within `LONGEST_S`.

    """
    own = simulation.samples[name]
    begin = simulation.t
    while abs(own.velocity) < speed:
        if simulation.t - begin > LONGEST_S:
            raise ValueError(f'{name}: {abs(own.velocity):g} m/s after {LONGEST_S:g} s, '
                             f'must reach {speed:g} m/s')
        simulation.step()


def memory_of(simulation: Simulation, name: str) -> Memory:
    """Return the records of an actuator."""
    return simulation.group.actuators[simulation.names.index(name)].memory


def exact_speed(memory: Memory) -> float:
    """Return the speed of an actuator's piston or rotor, m/s | rad/s."""
    return float(row_record(memory.continuous).plant.mechanics.velocity)


def stop(simulation: Simulation, seconds: float = 0.25, name: str = 'ram',
         begin: Callable[[Simulation], None] | None = None) -> Stopped:
    """
    Stop a running actuator, by a quick stop or by ``begin``; return what happened.

    It counts until the outputs are off: afterwards a load sinks with the leakage.
    """
    sheet = simulation.scenario.run.actuator(name).sheet
    own = simulation.samples[name]
    memory = memory_of(simulation, name)
    speed, start = exact_speed(memory), float(own.position)
    if begin is None:
        simulation.command(name, quick_stop=True)
    else:
        begin(simulation)
    found = advance(simulation, seconds, name)
    found = found[np.isin(found[:, 4], (ENABLED, QUICK_STOP, FAULT_REACTION))]
    gone = (1.0 if speed >= 0.0 else -1.0) * (found[:, 0] - start)
    deceleration, lag = sheet.reu.device.quick_stop_deceleration, lag_of(simulation, name)

    def expected(of: float) -> float:
        return of * of / (2.0 * deceleration) + of * lag

    peak = max(abs(speed), float(np.abs(found[:, 1]).max()))
    farthest = int(gone.argmax())
    tail = found[-max(1, round(0.1 * len(found))):]
    place = float(memory.reu['status']['flow']['place'][0])
    return Stopped(
        speed=speed, peak_speed=peak,
        expected=expected(abs(speed)), expected_of_peak=expected(peak),
        travel=float(max(0.0, gone[farthest])),
        bounce=float(gone[farthest] - gone[farthest:].min()),
        peak_force=float(np.abs(found[:, 2]).max()), swing=float(np.ptp(tail[:, 2])),
        drift=float(np.abs(tail[:, 0] - place).max()))
