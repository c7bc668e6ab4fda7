"""
Measure the readings of Table 4 and write their tables into docs/paper-errata.md.

    python scripts/measure_readings.py [--page FILE]

Takes about a minute. The tables stand between two markers of the page; the rest is not touched.

Table 4 leaves open where K_f enters (its unit is s) and, for the ISA v5, the unit of the force
gains: the printed "mm/N" saturates (erratum 11). Each reading is simulated with everything else as
shipped.
"""

import argparse
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
import math
from pathlib import Path
from typing import Any

from isa_ros.analysis.response.rig import Choice, Rig, rig
from isa_ros.config.runs.changed_parameters import with_parameters
from isa_ros.core.frozen import frozen
from isa_ros.core.units import MILLI
from isa_ros.errors import SimulationDiverged
from isa_ros.reu.block import Pid
from isa_ros.text.marked import with_parts
from isa_ros.text.table import markdown
from isa_ros.validation import knee_rig, rotary_disturbances, rotary_rig
from isa_ros.validation.actuators import SHIPPED
from isa_ros.validation.torque_step import bandwidths, measured_step, TorqueStep

PAGE = Path(__file__).parents[1] / 'docs' / 'paper-errata.md'
TABLE_4 = 'table_4'
ROTARY, LINEAR = 'smart_manifold', 'isa_v5'
MARKERS = {ROTARY: 'readings of the rotary column', LINEAR: 'readings of the ISA v5 column'}
ROTARY_HEAD = ('reading', 'rise 10-90 / 0-90 / 0-100, ms', 'overshoot, %', 'settling, ms',
               '-3 dB / -90 deg, Hz', 'torque error, sine / trot, %',
               'position control: settling x, peak x')
LINEAR_HEAD = ('reading', 'rise 10-90 / 0-90 / 0-100, ms', 'overshoot, %',
               '-3 dB / -90 deg, Hz', 'sine: position %, force N',
               'drop: peak N, over reference, tracking %')


@frozen
class Reading:
    """One reading: a preset with other values, by keys of `isa params`."""

    name: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    preset: str = TABLE_4


def _force(**values: Any) -> dict[str, Any]:
    return {f'reu.force.{key}': value for key, value in values.items()}


def _gains(model: str) -> Pid:
    force = rig(Choice(name=model, loop='force', preset=TABLE_4)).config.sheet.reu.force
    assert isinstance(force, Pid)
    return force


def rotary_readings() -> tuple[Reading, ...]:
    """Return where K_f may enter, with the gains of the rotary column as printed."""
    gains = _gains(ROTARY)
    in_proportional = {'feedback_damping': 'proportional'}
    return (
        Reading('K_f in front of the whole PID (shipped)'),
        Reading('K_f in the proportional part only', _force(**in_proportional)),
        Reading('the same, and the reference in the integral only (b = 0)',
                _force(**in_proportional, setpoint_weight=0.0)),
        Reading("K_f on the derivative of the error, K_p K_f (r' - y')",
                _force(kf=0.0, kd=gains.kp * gains.kf)),
        Reading('preset `default`', preset='default'))


def linear_readings() -> tuple[Reading, ...]:
    """Return the units that the force gains of the ISA v5 may have, and the places of K_f."""
    gains = _gains(LINEAR)

    def unit(micrometres: float) -> dict[str, Any]:
        """Return the gains with so much spool for each printed "mm"; as read it is 1."""
        return _force(kp=micrometres * gains.kp, ki=micrometres * gains.ki,
                      kv=micrometres * gains.kv)
    proportional = _force(feedback_damping='proportional')
    return (
        Reading('mm/kN (erratum 11), as shipped in `table_4`'),
        Reading('the same, K_f in the proportional part only', proportional),
        Reading('mm/N, as printed', _force(kp=1e3 * gains.kp, ki=1e3 * gains.ki)),
        Reading('mm/kN, K_v x4', _force(kv=4.0 * gains.kv)),
        Reading('mm/kN, K_v x4, K_f in the proportional part only',
                {**proportional, **_force(kv=4.0 * gains.kv)}),
        Reading('4.07 um of spool per printed "mm"', unit(4.07)),
        Reading('4.07 um, K_f in the proportional part only', {**proportional, **unit(4.07)}),
        Reading('3.56 um (percent of 10 mA times K_spool), load cell of 1e7 N/m',
                {**unit(3.56), 'plant.mechanics.sensor_stiffness': 1e7}),
        Reading('preset `default`', preset='default'))


def table(readings: Sequence[Reading], model: str) -> list[tuple[str, ...]]:
    """Return the table of one model's readings, its header first."""
    measure, head = ((rotary_row, ROTARY_HEAD) if model == ROTARY
                     else (linear_row, LINEAR_HEAD))
    rows = []
    for reading in readings:
        try:
            rows.append((reading.name, *measure(reading)))
        except SimulationDiverged:
            rows.append((reading.name, *(['diverges'] * (len(head) - 1))))
    return [head, *rows]


def rotary_row(reading: Reading) -> tuple[str, ...]:
    """Return the cells of a reading of the rotary column: Figs 12, 13, 17 and 18."""
    bench = _blocked(reading, ROTARY)
    found = measured_step(bench, rotary_rig.STEP_NM)
    runs = {scenario: rotary_rig.of_preset(SHIPPED, scenario, reading.preset).replace(
        _in_file(reading, rotary_rig.ROTOR)).simulate()
        for scenario in ('wheel_sine', 'trot', 'weight')}
    weight = rotary_disturbances.dropped(runs['weight'])
    position = rotary_disturbances.dropped(
        SHIPPED.run(rotary_disturbances.POSITION_RIG, 'weight').simulate())
    return (*_step_cells(found), _number(found.settling / MILLI),
            _pair(bandwidths(bench, rotary_rig.STEP_NM)),
            _pair(rotary_rig.torque_error(runs[name]) for name in ('wheel_sine', 'trot')),
            _pair((position.settling_time / weight.settling_time, position.peak / weight.peak)))


def linear_row(reading: Reading) -> tuple[str, ...]:
    """Return the cells of a reading of the ISA v5's column: Figs 19 and 20, section 6."""
    bench = _blocked(reading, LINEAR)
    found = measured_step(bench, bench.loop.amplitude)
    sine, drop = (knee_rig.of_preset(SHIPPED, knee_rig.RIG, scenario, reading.preset).replace(
        _in_file(reading, knee_rig.KNEE)).simulate(seconds)
        for scenario, seconds in (('knee_sine', None), ('drop', knee_rig.DROP_S)))
    dropped = knee_rig.drop_figures(drop)
    return (*_step_cells(found), _pair(bandwidths(bench)),
            _pair(knee_rig.tracking(sine, sine.time, knee_rig.KNEE)),
            f'{dropped.peak:.0f} / {_number(dropped.over_reference)} / '
            f'{_number(dropped.tracking)}')


def _blocked(reading: Reading, model: str) -> Rig:
    bench = rig(Choice(name=model, loop='force', preset=reading.preset))
    return bench.with_config(with_parameters(bench.config, reading.changes, bench.run.source))


def _in_file(reading: Reading, actuator: str) -> dict[str, Any]:
    return {f'actuators.{actuator}.parameters.{key}': value
            for key, value in reading.changes.items()}


def _step_cells(found: TorqueStep) -> tuple[str, str]:
    return (' / '.join(_number(value / MILLI) for value in found.rise.values()),
            f'{found.overshoot:.0f}' if found.overshoot >= 10.0 else _number(found.overshoot))


def _pair(values: Iterable[float]) -> str:
    return ' / '.join(_number(value) for value in values)


def _number(value: float) -> str:
    return '-' if not math.isfinite(value) else f'{value:.3g}' if value < 999.5 else f'{value:.0f}'


def main() -> None:
    """Measure, and replace the tables of the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1])
    parser.add_argument('--page', type=Path, default=PAGE, metavar='FILE')
    page_path = parser.parse_args().page
    page = page_path.read_text(encoding='utf-8')
    for model, readings in ((ROTARY, rotary_readings()), (LINEAR, linear_readings())):
        lines = markdown(table(readings, model))
        print('\n'.join(lines))
        page = with_parts(page, {MARKERS[model]: lines})
    page_path.write_text(page, encoding='utf-8')


if __name__ == '__main__':
    main()
