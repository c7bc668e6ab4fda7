"""
Effect of the oil's temperature on an actuator: measured on a rig, and by its laws.

The rig holds three actuators in a bath. From what a bag contains follow

- the leakage: the mean supply flow at null,
- viscous friction: the growth of hydraulic force less measured force over that of the speed,
- the frequency of the mass on its oil: the zero crossings of the force after a push,
- the null: the spool's position without current.
"""

from dataclasses import dataclass
import math

from isa_ros.analysis.signals.signals import Signal, Signals, signals_of
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.units import MPA
from isa_ros.plant.chambers import oil_stiffness
from isa_ros.plant.oil_properties import softness, thickness
from isa_ros.plant.plant import plant_record
from isa_ros.scripting.run import load, Run
from isa_ros.text.progress import Progress
import numpy as np

RIG, SCENARIO = 'rig_temperature', 'temperature'
LEAK, RUB, SWING = 'leak', 'rub', 'swing'   # its actuators
TEMPERATURES = (30.0, 40.0, 50.0, 60.0)     # celsius

_REST_S = 0.3           # from then on the pressures at null are at rest
_SLOW_S = (0.25, 0.5)   # of the two slides: constant speed
_FAST_S = (0.59, 0.65)
_PUSH_S, _SWING_S = 0.3, 0.34   # of the push, and the end of the valve's motion


@dataclass(frozen=True)
class Effects:
    """The values that depend on the temperature."""

    leakage: float
    """Flow from supply to return at null, m3/s."""
    viscous_friction: float
    """sigma2, Ns/m."""
    frequency: float
    """Of the mass on the oil, Hz."""
    null: float
    """Spool position without current, m."""


@dataclass(frozen=True)
class Result:
    """The effects at one temperature (celsius)."""

    celsius: float
    measured: Effects
    law: Effects


def rig_at(celsius: float) -> Run:
    """Return the rig with bath, supply and air at a temperature."""
    return load(RIG, SCENARIO).replace({
        f'actuators.{actuator}.parameters.plant.thermal.{place}_celsius': celsius
        for actuator in (LEAK, RUB, SWING) for place in ('start', 'supply', 'ambient')})


def results(progress: Progress | None = None) -> list[Result]:
    """Simulate the rig at each temperature, and measure."""
    found = []
    for k, celsius in enumerate(TEMPERATURES):
        signals = signals_of(rig_at(celsius).simulate())
        found.append(Result(celsius, measured(signals), law(signals, celsius)))
        if progress is not None:
            progress(k + 1, len(TEMPERATURES))
    return found


def measured(signals: Signals) -> Effects:
    """Return the effects measured from the signals of the rig."""
    areas = signals.run.actuator(RUB).sheet.plant.drive.areas
    friction, speed = [], []
    for window in (_SLOW_S, _FAST_S):
        p_a, p_b, force, v = (
            _mean(signals.over_time(f'{RUB}.{name}'), *window)
            for name in ('pressure_a', 'pressure_b', 'force', 'velocity'))
        friction.append(areas[0] * p_a - areas[1] * p_b - force)
        speed.append(v)
    return Effects(
        leakage=_mean(signals.over_time(f'{LEAK}.supply_flow'), _REST_S, math.inf),
        viscous_friction=(friction[1] - friction[0]) / (speed[1] - speed[0]),
        frequency=_frequency(signals.over_time(f'{SWING}.force')),
        null=_mean(signals.over_time(f'{SWING}.spool'), 0.5 * _PUSH_S, _PUSH_S))


def _mean(signal: Signal, begin: float, end: float) -> float:
    return float(signal.values[(signal.t >= begin) & (signal.t < end)].mean())


def _frequency(signal: Signal) -> float:
    """Return the frequency of the crossings of the mean from below."""
    t, y = (values[signal.t >= _SWING_S] for values in signal)
    y = y - y.mean()
    k = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
    crossings = t[k] - y[k] / (y[k + 1] - y[k]) * (t[k + 1] - t[k])
    return float((len(crossings) - 1) / (crossings[-1] - crossings[0]))


def law(signals: Signals, celsius: float) -> Effects:
    """Return the effects by V6, V12, C4 and T1 to T3 from the sheets of the rig."""
    run = signals.run
    leak, swing, supply = _plant(run, LEAK), _plant(run, SWING), run.supplies[0].sheet
    thicker = float(thickness(celsius, leak.thermal.oil))
    place = _mean(signals.over_time(f'{SWING}.position'), _SWING_S, math.inf)
    k_oil = oil_stiffness(place, swing.chambers) / softness(celsius, swing.thermal.oil)
    own = swing.mechanics
    load_inertia = run.actuator(SWING).load.inertia  # type: ignore[union-attr]
    matrix = np.array([
        [(k_oil + own.k_s) / own.inertia, -own.k_s / own.inertia],
        [-own.k_s / load_inertia, own.k_s / load_inertia]])
    bias = swing.spool.bias + swing.thermal.bias_per_k * (celsius - swing.thermal.oil.celsius)
    return Effects(
        leakage=leakage_at_null(leak, supply.pressure_mpa * MPA, thicker),
        viscous_friction=float(_plant(run, RUB).friction.sigma2) * thicker,
        frequency=math.sqrt(float(np.linalg.eigvals(matrix).min())) / (2.0 * math.pi),
        null=float(swing.valve.k_spool * bias))


def leakage_at_null(plant: np.record, supply: float, thicker: float) -> float:
    """
    Return the flow from supply to return with both ports shut, in m3/s  (V6, V9, V16, T3).

    ``supply`` (Pa) is the drop over the valve, ``thicker`` the viscosity over the sheet's.
    """
    valve, own = plant.valve, plant.thermal
    lands = valve.q_0 * valve.per_root_drop * sum(
        f * g / math.hypot(f, g)
        for f, g in ((valve.f_pa, valve.f_at), (valve.f_pb, valve.f_bt)))
    factor = 1.0 + own.laminar_share * (1.0 / thicker - 1.0)
    return float((valve.c_tare + lands * factor) * math.sqrt(supply))


def _plant(run: RunConfig, actuator: str) -> np.record:
    plant: np.record = plant_record(run.actuator(actuator).sheet.plant)[0]
    return plant
