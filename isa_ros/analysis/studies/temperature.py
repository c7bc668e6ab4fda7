"""
Effect of the oil's temperature on an actuator: measured on a rig, and by its laws.

The rig holds three actuators in a bath. From what a bag contains follow

- the leakage: the mean supply flow at null,
- viscous friction: the growth of hydraulic force less measured force over that of the speed,
- the frequency of the mass on its oil: the zero crossings of the force after a push,
- the null: the spool's position without current.

The study is shown as text, as JSON, and as the page docs/temperature.md.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields
import math
from typing import Any

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.analysis.signals.signals import Signal, Signals, signals_of
from isa_ros.analysis.studies.own_study import OwnStudy
from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.parameter_sets import build
from isa_ros.core.frozen import frozen
from isa_ros.core.oil_properties import softness, thickness
from isa_ros.core.record import rows_of
from isa_ros.core.units import LPM, MICRO, MPA
from isa_ros.plant.chambers import oil_stiffness
from isa_ros.plant.plant import plant_record
from isa_ros.plant.thermal import heat, THERMAL_STATE
from isa_ros.scripting.run import load, Run
from isa_ros.text.page import Page
from isa_ros.text.progress import Progress, told
from isa_ros.text.table import digits, RIGHT
import numpy as np

NAME, TITLE = 'temperature', 'Temperature of the oil, from 30 to 60 celsius'
RIG, SCENARIO = 'rig_temperature', 'temperature'
LEAK, RUB, SWING = 'leak', 'rub', 'swing'   # its actuators
TEMPERATURES = (30.0, 40.0, 50.0, 60.0)     # celsius

_REST_S = 0.3           # from then on the pressures at null are at rest
_SLOW_S = (0.25, 0.5)   # of the two slides: constant speed
_FAST_S = (0.59, 0.65)
_PUSH_S, _SWING_S = 0.3, 0.34   # of the push, and the end of the valve's motion

_COLUMNS: Mapping[str, tuple[str, float]] = {
    'leakage': ('leakage, l/min', LPM), 'viscous_friction': ('friction, Ns/m', 1.0),
    'frequency': ('on the oil, Hz', 1.0), 'null': ('null, um', MICRO)}
"""Title and SI of one unit of each column, by field of `Effects`."""
_SUPPLY = 20.7 * MPA
_MOMENTS = (1, 10, 60, 600, 3600)   # s
_HEAD = """# Temperature of the oil

By default the oil of an actuator keeps the temperature of its sheet,
`plant.oil.temperature_celsius`. With the variant `thermal` of a model its losses heat it:

    actuators:
      kfe: {model: isa_v5, variants: [thermal]}

Two heat capacities, the oil in the chambers and the body, are solved exactly once a tick (T4 to T6
of [equations.md](equations.md)). Leakage, throttling and relief heat the oil, which is cooled by
the oil that flows through: this enters with `supply_celsius` and leaves with the temperature of
the actuator. Friction, end stops and coils heat the body, which gives heat to the air.
`./isa params isa_v5 --variant thermal` lists the parameters `plant.thermal` with their sources.
The temperature is a field of each sample, in Python `result['kfe.temperature']`, and a message of
`/kfe/temperature` each second.

The temperature of the oil acts on viscosity (T1: Walther's equation, ASTM D341, through two points
of the oil's data sheet), and through it on leakage and viscous friction; on the bulk modulus (T2:
compressibility that grows by 0.45 % of that of the sheet per kelvin, from the factors 1.10 at 60
and 0.86 at 160 degF of The Lee Company); and on the null of the valve (V12). At the temperature of
the sheet all factors are exactly 1. A linearising block and gains keep the model of the sheet.
Neglected: the density's change, heat of compression, which is a fifth of the heat of throttling,
and the influence of the viscosity on turbulent flow, on spool and pilot stage. A temperature of
start, supply or air at which friction is too fast for the plant's step is refused, as -30 celsius
is for the ISA v5.

A supply that is a circuit may have a temperature of its own
([parts.md](parts.md#temperature-of-the-oil)). Its oil then flows in with that temperature instead
of `supply_celsius`, which in the run file is refused beside it, and the heat that it takes along
comes back to the tank (T10).

This page is written by

    ./isa study temperature --out docs
"""
_EFFECTS = f"""Three ISA v5 in a bath, `{RIG}` under the scenario `{SCENARIO}`: the supply flow of
a valve at null, the growth of friction from 0.04 to 0.3 m/s, the frequency of 50 kg on the oil
behind a shut valve, and the spool's position without current. In brackets the same by the laws,
from the sheet; a test measures it from a bag."""
_STANDING = """An actuator that holds still at null, with oil of 40 celsius from the supply, in air
of 25 celsius, by the same equations: the leakage heats the oil within seconds and the body within
minutes, to at most 20.7 MPa/(rho c) = 12.2 K above the supply. Last columns: oil, celsius."""


@frozen
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


@frozen
class TemperatureEffects:
    """The effects at one temperature (celsius)."""

    celsius: float
    measured: Effects
    law: Effects


def rig_at(celsius: float) -> Run:
    """Return the rig with bath, supply and air at a temperature."""
    return load(RIG, SCENARIO).replace({
        f'actuators.{actuator}.parameters.plant.thermal.{place}_celsius': celsius
        for actuator in (LEAK, RUB, SWING) for place in ('start', 'supply', 'ambient')})


def results(progress: Progress | None = None) -> list[TemperatureEffects]:
    """Simulate the rig at each temperature, and measure."""
    found = []
    for celsius in told(TEMPERATURES, progress):
        signals = signals_of(rig_at(celsius).simulate())
        found.append(TemperatureEffects(celsius, measured(signals), law(signals, celsius)))
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


def _numbers(found: Sequence[TemperatureEffects]) -> dict[str, Any]:
    return {'outcomes': [asdict(result) for result in found]}


def _fill(page: Page, found: Sequence[TemperatureEffects]) -> None:
    page.section('From 30 to 60 celsius')
    page.paragraph(_EFFECTS)
    page.table(_table(found), RIGHT)
    page.section('Standing')
    page.paragraph(_STANDING)
    page.table(list(_standing()), RIGHT)


def _table(found: Sequence[TemperatureEffects]) -> list[tuple[str, ...]]:
    return [('celsius', *(title for title, _ in _COLUMNS.values())),
            *((f'{result.celsius:g}', *_cells(result)) for result in found)]


def _cells(result: TemperatureEffects) -> Iterator[str]:
    for f in fields(Effects):
        of_unit = _COLUMNS[f.name][1]
        shown, expected = (getattr(effects, f.name) / of_unit
                           for effects in (result.measured, result.law))
        yield f'{digits(shown, 4)} ({digits(expected, 4)})'


def _standing() -> Iterator[tuple[str, ...]]:
    yield ('model', 'oil, J/K', 'body, J/K', 'leakage, l/min', 'heat, W',
           *(f'after {seconds} s' for seconds in _MOMENTS))
    for name in model_names():
        model = actuator_model(name, 'study')
        if 'thermal' not in model.variants:
            continue
        section = model.with_variants(model.with_preset('default', 'study'), ['thermal'], 'study')
        plant = plant_record(build(ActuatorSheet, section, model.place).plant)[0]
        own = plant.thermal
        flow = leakage_at_null(plant, _SUPPLY, float(thickness(own.start, own.oil)))
        yield (name, digits(own.oil_capacity, 3), digits(own.body_capacity, 3),
               digits(flow / LPM, 3), digits(flow * _SUPPLY, 3),
               *(f'{celsius:.1f}' for celsius in _warmed_up(plant)))


def _warmed_up(plant: np.record) -> Iterator[float]:
    """Yield the oil's temperature (celsius) at the moments of the table."""
    own = plant.thermal
    state = rows_of(1, THERMAL_STATE)[0]
    state.oil = state.body = own.start
    for second in range(1, _MOMENTS[-1] + 1):
        flow = leakage_at_null(plant, _SUPPLY, float(thickness(state.oil, own.oil)))
        heat(1.0, flow * _SUPPLY, 0.0, flow, own.supply, own, state)
        if second in _MOMENTS:
            yield float(state.oil)


STUDY = OwnStudy(NAME, TITLE, results, _table, _numbers, _HEAD, _fill)
