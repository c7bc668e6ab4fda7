"""
Write the tables of docs/real_data.md: measured against simulated, and two machines.

    python -m scripts.fetch_records records
    python -m scripts.write_real_data records

takes minutes. Without a directory only the table of the run of our own is written.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
import sys
from tempfile import TemporaryDirectory
from typing import Any

import isa_ros
from isa_ros.analysis.measured.against import Against, against, NONE
from isa_ros.analysis.measured.beside import fits_of
from isa_ros.analysis.measured.closing import Closed
from isa_ros.analysis.measured.fit import Fit
from isa_ros.core.atomic_file import replace_file
from isa_ros.core.units import of_coordinate
from isa_ros.text.marked import with_parts
from isa_ros.text.table import digits, markdown
from scripts.made_measurement import CLOCK_PPM, measured

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / 'docs' / 'real_data.md'
MAPPINGS = ROOT / 'config' / 'measurements'
OWN, RECORDS = 'own run', 'records'
OWN_S, PRESS_S = 4.0, 25.0
TRUE = {'load.inertia': 65.0, 'plant.friction.viscous': 520.0,
        'plant.oil.effective_bulk_modulus': 9e8, 'clock_ppm': CLOCK_PPM}
"""What the machine of our own has, by the free parameter that looks for it."""
PRESS: dict[str, Any] = {
    'name': 'press', 'supply': {
        'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
    'actuators': {'ram': {
        'model': 'cylinder', 'load': {'kind': 'mass'}, 'initial_position_mm': 75.0,
        'parameters': {'plant': {
            'drive': {'bore_mm': 50.0, 'rod_mm': 36.0, 'stroke_mm': 150.0,
                      'rated_pressure_mpa': 20.7},
            'valve': {'flow': {'rated_flow_lpm': 40.0, 'rated_current_ma': 10.0}}}}}}}
"""Assumed: of the press of the record neither cylinder nor valve is published."""
LOOP = 'reu.position.stiffness', 'reu.position.damping'


def place_of(key: str) -> str:
    """Return the key of a run file by that of a free parameter of our own machine."""
    return f'actuators.ram.{"" if key.startswith("load") else "parameters."}{key}'


def own_run(duration: float, free: Sequence[str] = tuple(TRUE)) -> Against:
    """Return our own machine, measured for ``duration`` s, against rig_linear."""
    changes = {place_of(key): TRUE[key] for key in TRUE if key != 'clock_ppm'}
    with TemporaryDirectory() as folder:
        path, mapping = measured(Path(folder), duration, changes)
        return against(path, mapping, isa_ros.load('rig_linear'), free)


def own_lines(found: Against) -> list[str]:
    """Return the table of the parameters, and the fits before and after."""
    rows = [('parameter', 'configured', 'true', 'found', '95 % interval'), *(
        _cells(own, found.is_rotary) for own in found.parameters)]
    return [*markdown(rows), '', *markdown([
        ('signal', 'NRMSE before', 'NRMSE after'), *(
            (quantity, _nrmse(found.fits[quantity]), _nrmse(found.improved_fits[quantity]))
            for quantity in found.fits)])]


def _cells(own: Closed, is_rotary: bool) -> tuple[str, ...]:
    free = own.free
    unit = of_coordinate(free.unit, is_rotary)
    named = f'`{free.key}`' + (f', {unit}' if unit and free.key != 'clock_ppm' else '')
    low, high = own.value - own.half_width, own.value + own.half_width
    return (named, f'{free.start:g}', f'{TRUE[free.key]:g}', f'{own.value:.4g}',
            f'{low:.3g} to {high:.3g}' if own.is_determined else 'not determined')


def _nrmse(found: Fit | str) -> str:
    return found if isinstance(found, str) else digits(found.nrmse, 3)


def record_lines(directory: Path) -> list[str]:
    """Return the table of the public records in a directory."""
    damper = directory / 'mts_damper.txt'
    command, response = MAPPINGS / 'mts_damper_command.yaml', MAPPINGS / 'mts_damper.yaml'
    run = isa_ros.load(PRESS)
    tuned = against(damper, response, run, LOOP, PRESS_S)
    rows = [('expected', 'actual', 'signal', 'NRMSE', 'delay', 'gain', 'left')]
    for expected, actual, fits in (
            ('its command', 'the press', fits_of(damper, damper, [command, response])),
            ('the press, 25 s', 'a model, assumed', against(
                damper, response, run, [NONE], PRESS_S).fits),
            ('the press, 25 s', 'the model, its position loop free', tuned.improved_fits),
            ('rotary actuator 1', 'rotary actuator 2', fits_of(
                directory / 'rotary_1.txt', directory / 'rotary_2.txt',
                [MAPPINGS / 'rotary.yaml']))):
        rows += _rows(expected, actual, fits)
    return markdown(rows)


def _rows(
        expected: str, actual: str, fits: Mapping[str, Fit | str]) -> list[tuple[str, ...]]:
    return [(expected, actual, quantity, own, '-', '-', '-') if isinstance(own, str) else (
        expected, actual, quantity, digits(own.nrmse, 3), f'{1e3 * own.delay:.2f} ms',
        digits(own.gain, 4), digits(own.left, 3)) for quantity, own in fits.items()]


def main(arguments: Sequence[str]) -> int:
    """Write the tables; print the page."""
    parts = {OWN: own_lines(own_run(OWN_S))}
    if arguments:
        parts[RECORDS] = record_lines(Path(arguments[0]))
    page = with_parts(PAGE.read_text(encoding='utf-8'), parts)
    replace_file(PAGE, page.encode(), is_durable=False)
    print(PAGE)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
