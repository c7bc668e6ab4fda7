"""
Quantities that values of a model are proportional to, as in ``scales_with: stall_out``.

Such a value holds for the model's own cylinder and valve. For others it is multiplied by the
ratio of the quantity, so that a larger bore has larger ratings, too. Quantities are SI; a constant
factor of a quantity cancels. They are those of rated data: neither the run's supply nor its oil,
sensors or rates change them (`isa_ros.config.models.scaling`).
"""

from collections.abc import Callable, Mapping
import math

from isa_ros.actuator.sheet import ActuatorSheet, output_per_spool, valve_stop
from isa_ros.core.units import MILLI, MPA
from isa_ros.errors import ConfigError
from isa_ros.plant.chambers import chambers_record, volumes
from isa_ros.plant.coil import ClosedLoopCoil
from isa_ros.plant.drives import Cylinder
from isa_ros.plant.return_spring import CoilSpring, spring_forces, spring_of
from isa_ros.plant.servo_valve import flow_curve
from isa_ros.plant.spool import ClosedLoopSpool
from isa_ros.plant.valve_record import valve_record
from isa_ros.reu.schedule import POINTS
from isa_ros.reu.wiring import Off
import numpy as np


def _area(sheet: ActuatorSheet) -> float:
    return sheet.plant.drive.areas[0]


def _rated_pressure(sheet: ActuatorSheet) -> float:
    """Return P_S above return that the actuator is sized for, in Pa; a run may have another."""
    return sheet.plant.drive.rated_pressure_mpa * MPA


def _piston_area(sheet: ActuatorSheet) -> float:
    return _area(sheet)


def _stall_out(sheet: ActuatorSheet) -> float:
    """Return A_A P_S in N | Nm."""
    return _area(sheet) * _rated_pressure(sheet)


def _stall_in(sheet: ActuatorSheet) -> float:
    """Return A_B P_S in N | Nm, or the force of a spring at the extended end."""
    spring = spring_of(sheet.plant)
    if isinstance(spring, CoilSpring):
        return spring_forces(spring, _stroke(sheet))[1]
    return sheet.plant.drive.areas[1] * _rated_pressure(sheet)


def _stroke(sheet: ActuatorSheet) -> float:
    return sheet.plant.drive.stroke


def _swept_volume(sheet: ActuatorSheet) -> float:
    return _area(sheet) * sheet.plant.drive.stroke


def _bore_area(sheet: ActuatorSheet) -> float:
    """Return the area of the piston with that of its rods, m2 | m3/rad."""
    drive = sheet.plant.drive
    return drive.bore_area if isinstance(drive, Cylinder) else _area(sheet)


def _seal_length(sheet: ActuatorSheet) -> float:
    """Return the circumference of the piston in m."""
    return 2.0 * math.sqrt(math.pi * _bore_area(sheet))


def _cap_spear(sheet: ActuatorSheet) -> float:
    """Return a length that is as the mean of the diameters of bore and second rod, or none."""
    drive = sheet.plant.drive
    rod = drive.cap_rod_mm / drive.bore_mm if isinstance(drive, Cylinder) else 0.0
    return _seal_length(sheet) * 0.5 * (1.0 + rod)


def _piston_volume(sheet: ActuatorSheet) -> float:
    """Return the volume of a piston as long as its bore, on rods of twice the stroke, in m3."""
    whole, (area_a, area_b) = _bore_area(sheet), sheet.plant.drive.areas
    rods = (whole - area_a) + (whole - area_b)
    return whole * 2.0 * math.sqrt(whole / math.pi) + rods * 2.0 * sheet.plant.drive.stroke


def _stall_damping(sheet: ActuatorSheet) -> float:
    """Return sqrt(k m) of springs as the stall force and of the piston's mass."""
    return math.sqrt(_stall_out(sheet) * _piston_volume(sheet))


def _stall_stiffness(sheet: ActuatorSheet) -> float:
    """Return the stall force over the stroke in N/m | Nm/rad."""
    return _stall_out(sheet) / _stroke(sheet)


def _load_damping(sheet: ActuatorSheet) -> float:
    """Return sqrt(k m) of stall force over stroke and of a load as the stall force."""
    return math.sqrt(_stall_stiffness(sheet) * _stall_out(sheet))


def _valve(sheet: ActuatorSheet) -> np.record:
    area_a, area_b = sheet.plant.drive.areas
    return valve_record(sheet.plant.valve, area_a / area_b)


def _valve_current(sheet: ActuatorSheet) -> float:
    """Return the largest series current in A."""
    valve = sheet.plant.valve
    return valve.spool_stop_mm / valve.spool_gain_mm_per_ma * MILLI


def _per_valve_current(sheet: ActuatorSheet) -> float:
    """Return the ohms that have 1 V at full current."""
    return 1.0 / _valve_current(sheet)


def _spool_travel(sheet: ActuatorSheet) -> float:
    return sheet.plant.valve.spool_stop_mm * MILLI


def _spool_frequency(sheet: ActuatorSheet) -> float:
    """Return the speed of the spool in rad/s: K_loop of equation 8, or half w_n over zeta."""
    spool = sheet.plant.spool
    if isinstance(spool, ClosedLoopSpool):
        return spool.loop_gain_per_s
    return spool.natural_frequency_rad_per_s / (2.0 * spool.damping_ratio)


def _valve_stop(sheet: ActuatorSheet) -> float:
    return valve_stop(sheet)


def _valve_conductance(sheet: ActuatorSheet) -> float:
    """Return the full flow of a land over the square root of its drop, m3/s/sqrt(Pa)."""
    valve = _valve(sheet)
    return float(flow_curve(valve.x_max, valve) * valve.per_root_drop)


def _full_flow(sheet: ActuatorSheet) -> float:
    """Return the full flow with the rated pressure over one land, in m3/s."""
    return _valve_conductance(sheet) * math.sqrt(_rated_pressure(sheet))


def _bend(sheet: ActuatorSheet) -> tuple[float, float]:
    bend = sheet.plant.valve.bend
    if bend is None:
        raise ConfigError(
            'compensation.kind = dual_gain inverts a flow curve of two straight lines, which '
            'plant.valve does not have; set kind: linear, or knee and slope')
    return bend


def _flow_knee(sheet: ActuatorSheet) -> float:
    """Return the end of the flow curve's first line in the unit of the valve's command."""
    valve = sheet.plant.valve
    return _bend(sheet)[0] * valve.spool_gain_mm_per_ma * MILLI * output_per_spool(sheet)


def _flow_gain_ratio(sheet: ActuatorSheet) -> float:
    """Return the slope of the flow curve's first line over that of the second one."""
    return _bend(sheet)[1]


def _null_flow_gain(sheet: ActuatorSheet) -> float:
    """Return the flow of a land with half the rated pressure per output about null."""
    valve = _valve(sheet)
    return float(valve.k_low * valve.per_root_drop * math.sqrt(0.5 * _rated_pressure(sheet))
                 / output_per_spool(sheet))


def _output_per_speed(sheet: ActuatorSheet) -> float:
    """Return the valve's command for 1 m/s | rad/s, the mean of both directions and areas."""
    area_a, area_b = sheet.plant.drive.areas
    if isinstance(spring_of(sheet.plant), CoilSpring):
        area_b = area_a
    return 0.5 * (area_a + area_b) / _null_flow_gain(sheet)


def _valve_lag(sheet: ActuatorSheet) -> float:
    """Return the sum of the lags of spool, current and sampling, in s."""
    coil = sheet.plant.coil
    lag = 1.0 / sheet.reu.current.rate_hz + 1.0 / _spool_frequency(sheet)
    if isinstance(coil, ClosedLoopCoil):
        lag += 1.0 / coil.bandwidth_rad_per_s
    if not isinstance(sheet.reu.force, Off):
        lag += 1.0 / sheet.reu.force.rate_hz
    return lag


def _valve_speed(sheet: ActuatorSheet) -> float:
    """Return one over the valve's lag, in rad/s."""
    return 1.0 / _valve_lag(sheet)


def _flow_per_force_rate(sheet: ActuatorSheet) -> float:
    """
    Return the flow of a land for 1 N/s | 1 Nm/s of the blocked actuator  (R12).

    Gains that are scheduled with ``oil_stiffness`` are lower where the oil is stiffer; this is the
    least flow over the stroke after that.
    """
    oil = chambers_record(sheet.plant.drive, sheet.plant.oil)
    oil.holds_b = float(not isinstance(spring_of(sheet.plant), CoilSpring))
    valve, k_s = _valve(sheet), sheet.plant.mechanics.sensor_stiffness
    rates, in_loop = [], []
    for place in np.linspace(0.0, oil.stroke, POINTS):
        v_a, v_b = volumes(place, oil)
        per_a, per_b = oil.beta * oil.area_a / v_a, oil.beta * oil.area_b / v_b
        per_b *= oil.holds_b
        stiffness = per_a * oil.area_a + per_b * oil.area_b
        in_loop.append(stiffness / (1.0 + stiffness / k_s))
        rates.append((per_a * valve.f_pa + per_b * valve.f_bt) / stiffness)
    return float(1.0 / (min(in_loop) * max(rates)))


def _output_per_force_rate(sheet: ActuatorSheet) -> float:
    """Return the valve's command for 1 N/s | 1 Nm/s of the blocked actuator."""
    return _flow_per_force_rate(sheet) / _null_flow_gain(sheet)


def _force_gain(sheet: ActuatorSheet) -> float:
    """Return K_p of a force loop whose crossover is one over the valve's lag."""
    return _output_per_force_rate(sheet) / _valve_lag(sheet)


def _force_integral_gain(sheet: ActuatorSheet) -> float:
    """Return K_i of a force loop with a corner at one over the valve's lag."""
    return _force_gain(sheet) / _valve_lag(sheet)


def _position_gain(sheet: ActuatorSheet) -> float:
    """Return K_p of a position loop whose crossover is one over the valve's lag."""
    return _output_per_speed(sheet) / _valve_lag(sheet)


SCALES: Mapping[str, Callable[[ActuatorSheet], float]] = {
    'piston_area': _piston_area, 'stall_out': _stall_out, 'stall_in': _stall_in, 'stroke': _stroke,
    'swept_volume': _swept_volume, 'seal_length': _seal_length,
    'cap_spear': _cap_spear, 'piston_volume': _piston_volume,
    'stall_damping': _stall_damping,
    'stall_stiffness': _stall_stiffness, 'load_damping': _load_damping,
    'rated_pressure': _rated_pressure,
    'valve_current': _valve_current, 'per_valve_current': _per_valve_current,
    'valve_stop': _valve_stop, 'spool_travel': _spool_travel,
    'spool_frequency': _spool_frequency, 'valve_speed': _valve_speed,
    'valve_conductance': _valve_conductance, 'full_flow': _full_flow, 'valve_lag': _valve_lag,
    'flow_knee': _flow_knee, 'flow_gain_ratio': _flow_gain_ratio,
    'output_per_speed': _output_per_speed, 'position_gain': _position_gain,
    'flow_per_force_rate': _flow_per_force_rate, 'force_gain': _force_gain,
    'force_integral_gain': _force_integral_gain,
}
"""The quantities by name, of a sheet."""

_OF_DRIVE = ('piston_area', 'stall_out', 'stall_in', 'stroke', 'swept_volume', 'seal_length',
             'cap_spear', 'piston_volume', 'stall_damping', 'stall_stiffness', 'load_damping',
             'rated_pressure')
_OF_SPOOL = ('spool_frequency', 'valve_lag', 'valve_speed')
_OF_VALVE = ('valve_current', 'per_valve_current', 'valve_stop', 'spool_travel', 'full_flow',
             'valve_conductance', 'flow_knee', 'flow_gain_ratio')


def keys_of(scale: str) -> str:
    """Return the sections of a file that a quantity follows from, for messages."""
    for keys, scales in (('plant.drive', _OF_DRIVE), ('plant.spool', _OF_SPOOL),
                         ('plant.valve', _OF_VALVE)):
        if scale in scales:
            return keys
    return 'plant.valve and plant.drive'
