"""Panels of one actuator: references against measurements, chambers, valve, oil."""

from isa_ros.analysis.report.key_figures import error_of, tracking_error
from isa_ros.analysis.report.panels import Curve, drawn, extent, Group, Panel
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.plant.hose_sheets import LumpedHoses
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.wiring import active
from isa_ros.text.table import digits
import numpy as np

_DEGREE = float(np.radians(1.0))
_NO_ERROR = 'The REU has no such loop here, so there is no reference to follow.'


def actuator_group(actuator: ActuatorConfig, signals: Signals) -> Group:
    """Return the panels of an actuator; what was not recorded is left out."""
    scale, unit = (_DEGREE, 'deg') if actuator.sheet.is_rotary else (MILLI, 'mm')
    load, newton = ('torque', 'Nm') if actuator.sheet.is_rotary else ('force', 'N')
    return Group(
        actuator.name, f'{actuator.name} ({actuator.model}, preset {actuator.preset})', drawn([
            _followed(actuator, signals, 'position', 'position', unit, scale),
            Panel('velocity', f'{unit}/s', scale, [
                Curve('estimated', signals.drawn(f'{actuator.name}.velocity'))],
                'Estimated by the REU from the encoder.'),
            _followed(actuator, signals, 'force', load, newton, 1.0),
            _pressures(actuator, signals),
            _followed(actuator, signals, 'spool', 'spool', 'mm', MILLI),
            _followed(actuator, signals, 'current', 'current', 'mA', MILLI),
            Panel('oil drawn', 'l/min', LPM, [
                Curve('from the supply', signals.drawn(f'{actuator.name}.supply_flow'))],
                'Mean over a tick; at rest what remains is leakage.')]), (actuator.name,))


def _followed(actuator: ActuatorConfig, signals: Signals, field: str, title: str, unit: str,
              scale: float) -> Panel:
    """Return the panel of a measurement and its reference, where a loop has one."""
    name = f'{actuator.name}.{field}'
    measured = Curve('measured', signals.drawn(name))
    reference = Curve('reference', signals.drawn(f'{name}_reference'), is_reference=True)
    if not _is_followed(actuator, field):
        return Panel(title, unit, scale, [measured], _NO_ERROR)
    error = error_of(signals, actuator.name, field)
    found = None if error is None else tracking_error(error)
    return Panel(title, unit, scale, [measured, reference], '' if found is None else (
        f'{_aim(actuator, field)}: it is off by '
        f'{digits(found.rms / scale, 3)} {unit} rms, at most {digits(found.most / scale, 3)} '
        f'{unit}, at t = {found.t_s:.3f} s.'))


def _aim(actuator: ActuatorConfig, field: str) -> str:
    """Return what a loop does with the measurement."""
    if field == 'position' and isinstance(actuator.sheet.reu.position, Impedance):
        return 'An impedance pulls the measurement to the reference as a spring does'
    return 'The measurement is to follow the reference'


def _is_followed(actuator: ActuatorConfig, field: str) -> bool:
    """Return whether a loop of the REU follows the reference; that of the amplifier always is."""
    return field == 'current' or field in active(actuator.sheet.reu)


def _pressures(actuator: ActuatorConfig, signals: Signals) -> Panel:
    """Return the panel of the chambers, their supply, and a cushion while its spear is in."""
    name = actuator.name
    # the sensors are in the valve block, at the ends of the hoses
    at = 'hose ' if isinstance(actuator.sheet.plant.hoses, LumpedHoses) else ''
    curves = [Curve(f'{at}A', signals.drawn(f'{name}.pressure_a')),
              Curve(f'{at}B', signals.drawn(f'{name}.pressure_b')),
              Curve('supply', signals.drawn(signals.supply_of(name)))]
    cushion = signals.drawn(f'{name}.cushion_pressure')
    if cushion.values.any():
        is_in = np.where(cushion.values == 0.0, np.nan, cushion.values)
        curves.append(Curve('cushion', Signal(cushion.t, is_in)))
    low, high = extent(np.concatenate([own.signal.values for own in curves[:2]]))
    return Panel('pressure', 'MPa gauge', MPA, curves, (
        f'A is the cap side, B the rod side: {low / MPA:.2f} to {high / MPA:.2f} MPa. A chamber '
        'near 0 is about to cavitate, one at the supply has no force left.'))
