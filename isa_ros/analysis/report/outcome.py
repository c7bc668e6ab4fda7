"""Results of a run as a table of text: motion, force, pressure, settling and oil."""

from isa_ros.analysis.report.ground import upward_forces
from isa_ros.analysis.report.key_figures import (
    pressure_range, settling_time, shown_position)
from isa_ros.analysis.signals.signals import Signals
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.units import LITRE
from isa_ros.text.table import aligned, digits
import numpy as np

_HEADER = ('', 'from', 'to', '', 'peak', '', 'pressure, MPa', 'settled, s', 'oil, l')


def outcome(signals: Signals) -> str:
    """Return a line for each actuator, and one for each ground's force."""
    lines = aligned([_HEADER, *(_row(signals, own) for own in signals.run.actuators)], 'lrrlrlrrr')
    for name, force in upward_forces(signals):
        lines.append(f'{name}: at most {digits(float(force.max()), 3)} N upwards, '
                     f't = {float(signals.time[int(force.argmax())]):.3f} s')
    lines.append('settled: within 2 % of the motion; pressure: gauge; oil: drawn from the supply')
    return '\n'.join(lines)


def _row(signals: Signals, own: ActuatorConfig) -> tuple[str, ...]:
    name = own.name
    t, x = signals.over_time(f'{name}.position')
    scale, unit = shown_position(own)
    force = np.abs(signals[f'{name}.force']).max()
    oil = signals[f'{name}.supply_volume'][-1] / LITRE
    settled = settling_time(t, x)
    return (
        name, f'{x.min() * scale:.1f}', f'{x.max() * scale:.1f}', unit, digits(float(force), 3),
        signals.unit(f'{name}.force'), pressure_range(signals, own),
        '-' if settled is None else f'{settled:.3f}', f'{oil:.3f}')
