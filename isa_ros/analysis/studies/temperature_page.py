"""The study of the oil's temperature as text, as JSON, and as the page docs/temperature.md."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.analysis.studies.temperature import Effects, leakage_at_null, Result, RIG, SCENARIO
from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.config.text.parameter_sets import build
from isa_ros.core.units import LPM, MICRO, MPA
from isa_ros.plant.oil_properties import thickness
from isa_ros.plant.plant import plant_record
from isa_ros.plant.thermal import heat, THERMAL_STATE
from isa_ros.text.page import Page
from isa_ros.text.table import aligned, digits, RIGHT
import numpy as np

NAME, TITLE = 'temperature', 'Temperature of the oil, from 30 to 60 celsius'
PAGE = 'temperature.md'

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


def as_text(found: Sequence[Result]) -> str:
    """Return the text for a terminal."""
    return '\n'.join([TITLE, *aligned(_table(found), RIGHT)])


def as_tree(found: Sequence[Result]) -> dict[str, Any]:
    """Return the study for JSON, SI."""
    return {'name': NAME, 'title': TITLE, 'outcomes': [asdict(result) for result in found]}


def write_page(found: Sequence[Result], directory: Path) -> list[Path]:
    """Write temperature.md into a directory; return its path."""
    page = Page(PAGE, _HEAD)
    page.section('From 30 to 60 celsius')
    page.paragraph(_EFFECTS)
    page.table(_table(found), RIGHT)
    page.section('Standing')
    page.paragraph(_STANDING)
    page.table(list(_standing()), RIGHT)
    return page.write(directory)


def _table(found: Sequence[Result]) -> list[tuple[str, ...]]:
    return [('celsius', *(title for title, _ in _COLUMNS.values())),
            *((f'{result.celsius:g}', *_cells(result)) for result in found)]


def _cells(result: Result) -> Iterator[str]:
    for f in fields(Effects):
        of_unit = _COLUMNS[f.name][1]
        measured, law = (getattr(effects, f.name) / of_unit
                         for effects in (result.measured, result.law))
        yield f'{digits(measured, 4)} ({digits(law, 4)})'


def _standing() -> Iterator[tuple[str, ...]]:
    yield ('model', 'oil, J/K', 'body, J/K', 'leakage, l/min', 'heat, W',
           *(f'after {seconds} s' for seconds in _MOMENTS))
    for name in model_names():
        model = actuator_model(name, 'study')
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
    state = np.zeros(1, THERMAL_STATE).view(np.recarray)[0]
    state.oil = state.body = own.start
    for second in range(1, _MOMENTS[-1] + 1):
        flow = leakage_at_null(plant, _SUPPLY, float(thickness(state.oil, own.oil)))
        heat(1.0, flow * _SUPPLY, 0.0, flow, own, state)
        if second in _MOMENTS:
            yield float(state.oil)
