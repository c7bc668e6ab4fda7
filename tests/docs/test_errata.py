"""The list of errata: complete, and every place in it exists."""

from dataclasses import replace
import math
from pathlib import Path
import re

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import merge, Section
from isa_ros.plant.coil import circuit
from isa_ros.plant.valve_record import flow_slope
from isa_ros.reu.lead_lag import lead_lag_record, LeadLag
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / 'docs' / 'paper-errata.md').read_text(encoding='utf-8')
ROWS = {int(row.split(' | ')[0].strip('| ')): row
        for row in TEXT.splitlines() if re.match(r'\| \d+ \|', row)}


def keys(section: Section, prefix: str = '') -> set[str]:
    """Return the dotted path of every section and value."""
    found = set()
    for key, below in section.items():
        found.add(f'{prefix}{key}')
        if isinstance(below, dict):
            found |= keys(below, f'{prefix}{key}.')
    return found


def model_keys() -> set[str]:
    """Return every path of every shipped model with its presets and variants."""
    found: set[str] = set()
    for name in model_names():
        model = actuator_model(name, 'test')
        found |= keys(model.sheet)
        for gains in model.presets.values():
            found |= keys(merge(model.sheet, {'reu': gains}))
        for variant in model.variants.values():
            found |= keys(variant)
    return found


def test_there_are_26_with_five_columns() -> None:
    assert sorted(ROWS) == list(range(1, 27))
    assert all(row.count(' | ') == 4 for row in ROWS.values())


def test_every_key_they_name_is_one_of_a_model() -> None:
    named = set(re.findall(r'`((?:plant|reu)\.[a-z0-9_.]+)`', TEXT))
    assert len(named) > 20 and named - model_keys() == set()


def test_every_file_they_name_exists() -> None:
    named = set(re.findall(r'`((?:plant|reu|loads)/[a-z_.]*)`', TEXT))
    assert named and all((ROOT / 'isa_ros' / name).exists() for name in named)


def test_every_function_they_name_is_in_its_file() -> None:
    named = re.findall(r'`([a-z_]+)` in `([a-z_/]+\.py)`', TEXT)
    assert len(named) > 1
    for function, file in named:
        assert f'def {function}(' in (ROOT / 'isa_ros' / file).read_text(encoding='utf-8')


def test_every_equation_they_name_is_documented() -> None:
    equations = (ROOT / 'docs' / 'equations.md').read_text(encoding='utf-8')
    for row in ROWS.values():
        for number in re.findall(r'\b[VCMR]\d+\b', row.rpartition(' | ')[2]):
            assert f'| {number} |' in equations


def current_loop_poles(lag: float, lead_damping: float, lag_damping: float) -> np.ndarray:
    """Return the poles z of the sampled current loop around the explicit coil's first order."""
    model = actuator_model('smart_manifold', 'test')
    section = model.with_variants(model.with_preset('table_4', 'test'), ['explicit'], 'test')
    sheet = build(ActuatorSheet, section, model.place)
    assert isinstance(sheet.reu.current, LeadLag)
    coils = circuit(sheet.plant.coil)
    loop = lead_lag_record(replace(
        sheet.reu.current, lag_rad_per_s=lag, lead_damping=lead_damping,
        lag_damping=lag_damping))
    decay = math.exp(-coils.resistance / coils.inductance / sheet.reu.current.rate_hz)
    poles: np.ndarray = np.roots(np.polyadd(
        np.polymul([loop.b_0, loop.b_1, loop.b_2], [0.0, (1.0 - decay) / coils.resistance]),
        np.polymul([1.0, loop.a_1, loop.a_2], [1.0, -decay])))
    return poles


def least_damping(poles: np.ndarray) -> float:
    """Return the damping ratio of the least damped pole in continuous time."""
    s = np.log(poles[np.abs(poles) > 1e-9].astype(complex))
    return float((-s.real / np.abs(s)).min())


def test_errata_8_and_9_are_what_the_loop_does() -> None:
    """Rows 8 and 9: unstable, ringing, hardly damped, and as read."""
    as_printed, exchanged = (0.65, 0.1), (0.1, 0.65)
    assert least_damping(current_loop_poles(2513.3, *as_printed)) < 0.0
    assert 0.1 < least_damping(current_loop_poles(2513.3, *exchanged)) < 0.25
    assert 0.0 < least_damping(current_loop_poles(25133.0, *as_printed)) < 0.1
    as_read = current_loop_poles(25133.0, *exchanged)
    # real poles only: no oscillation except the alternation of samples, which decays
    assert all(as_read.imag == 0.0) and max(np.abs(as_read)) < 0.8


@pytest.mark.parametrize('gain, slope', [(0.4, '0.18727'), (2.5, '1.17041')])
def test_the_slopes_of_erratum_1_are_those_of_the_code(gain: float, slope: str) -> None:
    assert f'{flow_slope(gain, 0.0356):.5f}' == slope and slope in ROWS[1]
