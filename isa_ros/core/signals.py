"""
Records exchanged between components: setpoints, samples, both directions of the load port.

Each signal is one numpy record type, SI units, little endian, so that the same bytes
serve as kernel argument, log row and wire format. Generalised coordinates: metres and
newtons for a linear actuator, radians and newton metres for a rotary one.
Force > 0 pushes out; pressures are gauge.
"""

from isa_ros.core.timebase import FORCE_WINDOWS
import numpy as np
from numpy.typing import NDArray

Records = NDArray[np.void]
"""Rows of one of the record types below, one per actuator."""

HAS_SETPOINT = 1
HAS_ENABLE = 2
HAS_GAINS = 4
HAS_MODE = 8
HAS_CLEAR_FAULT = 16
HAS_QUICK_STOP = 32
HAS_REFERENCE = 64
EVERY_KIND = 127
"""All bits of `COMMAND.kinds`."""

START = np.dtype([
    ('position', '<f8'),         # m | rad
    ('force', '<f8'),            # sensor force at rest, N | Nm
    ('supply_pressure', '<f8'),  # Pa gauge
    ('return_pressure', '<f8'),  # Pa gauge
])
"""State in which one actuator begins a run."""

COMMAND = np.dtype([
    ('kinds', '<u4'),          # bits of HAS_*; 0: nothing new this tick
    ('is_enabled', '<u4'),     # 0 or 1, with HAS_ENABLE
    ('position', '<f8'),       # m | rad
    ('velocity', '<f8'),       # m/s | rad/s
    ('effort', '<f8'),         # feed-forward, N | Nm
    ('stiffness', '<f8'),      # N/m | Nm/rad; NaN keeps the gain in force
    ('damping', '<f8'),        # Ns/m | Nms/rad; NaN keeps the gain in force
    ('mode', '<i8'),           # of `isa_ros.core.device`: the new one, or that of the reference
    ('reference', '<f8'),      # of that mode: amplifier A | m of spool | Pa of difference
    ('due_step', '<i8'),       # plant step from which it is in force; 0: start of its tick
])
"""Command to one actuator, in effect from a tick boundary or a `due_step` on."""

GAINS_OF_COMMAND = ('stiffness', 'damping')
"""Fields of a `COMMAND` that may be NaN: the gains of the impedance."""

SAMPLE = np.dtype([
    ('position', '<f8'),            # encoder, m | rad
    ('velocity', '<f8'),            # estimated by the REU, m/s | rad/s
    ('force', '<f8'),               # load cell or torque sensor, N | Nm
    ('pressure_a', '<f8'),          # Pa gauge
    ('pressure_b', '<f8'),          # Pa gauge
    ('spool', '<f8'),               # m
    ('spool_velocity', '<f8'),      # m/s
    ('current', '<f8'),             # amplifier (parallel) current, A
    ('position_reference', '<f8'),  # m | rad
    ('force_reference', '<f8'),     # N | Nm
    ('spool_reference', '<f8'),     # m
    ('current_reference', '<f8'),   # amplifier (parallel) current, A
    ('supply_volume', '<f8'),       # oil drawn from the supply since t = 0, m3
    ('supply_flow', '<f8'),         # its mean over the tick, m3/s
    ('power', '<f8'),               # of the oil: mean over the tick, W
    ('peak_power', '<f8'),          # greatest since t = 0, W
    ('hydraulic_energy', '<f8'),    # of the oil drawn less that of the oil returned, J
    ('leakage_energy', '<f8'),      # lost to the leakage of the valve, J
    ('throttling_energy', '<f8'),   # lost at the open lands of the valve, J
    ('cross_port_energy', '<f8'),   # lost past the piston or vane, and to the outside, J
    ('relief_energy', '<f8'),       # lost through relief and refill valves, J
    ('friction_energy', '<f8'),     # lost to the seals, J
    ('damping_energy', '<f8'),      # lost in the force sensor; taken up by the end stops, J
    ('work', '<f8'),                # done on the load, J
    ('stored_energy', '<f8'),       # in oil, moving part and force sensor, more than at t = 0, J
    ('temperature', '<f8'),         # of the oil in the actuator, as sensed, celsius
    ('warnings', '<f8'),            # bit set of conditions as a whole number (isa_ros.conditions)
    ('trips', '<f8'),               # likewise
    ('device_state', '<f8'),        # number of `isa_ros.core.device.STATES`
    ('device_mode', '<f8'),         # of `MODES`, in force or for the next enable
    ('device_event', '<f8'),        # of `EVENTS`: the last one that changed the state or mode
    ('state_since', '<f8'),         # time of the last change of these three or of the bits, s
    ('age', '<f8'),                 # since it was sampled, s; > 0 behind a link only
    ('supply_pressure', '<f8'),     # that the REU measures, Pa gauge
])
"""Values one actuator reports at the end of a tick."""

SAMPLE_UNITS = {
    'position': 'm | rad', 'velocity': 'm/s | rad/s', 'force': 'N | Nm',
    'pressure_a': 'Pa', 'pressure_b': 'Pa', 'spool': 'm', 'spool_velocity': 'm/s',
    'current': 'A', 'position_reference': 'm | rad', 'force_reference': 'N | Nm',
    'spool_reference': 'm', 'current_reference': 'A', 'supply_volume': 'm3',
    'supply_flow': 'm3/s', 'power': 'W', 'peak_power': 'W', 'hydraulic_energy': 'J',
    'leakage_energy': 'J', 'throttling_energy': 'J', 'cross_port_energy': 'J',
    'relief_energy': 'J', 'friction_energy': 'J', 'damping_energy': 'J', 'work': 'J',
    'stored_energy': 'J', 'temperature': 'celsius', 'warnings': 'bits', 'trips': 'bits',
    'device_state': '1', 'device_mode': '1', 'device_event': '1', 'state_since': 's',
    'age': 's', 'supply_pressure': 'Pa'}
"""Unit of each field of a `SAMPLE`: of a linear actuator | of a rotary one."""

LOAD_PORT = np.dtype([
    ('x0', '<f8'),               # load position at the tick, m | rad
    ('v0', '<f8'),               # load speed
    ('a0', '<f8'),               # load acceleration along the reference
    ('inverse_mass', '<f8'),     # 1/m_eff, 1/kg | 1/(kg m2)
    ('a_bias', '<f8'),           # load acceleration without this actuator's force
    ('jerk', '<f8'),             # slope of a_bias
    ('stiffness', '<f8'),        # k, 1/s2
    ('damping', '<f8'),          # d, 1/s
    ('supply_pressure', '<f8'),  # Pa gauge
    ('return_pressure', '<f8'),  # Pa gauge
])
"""Load port, load to actuator, one row per actuator and tick (equation L1)."""

LOAD_REPLY = np.dtype([
    ('mean_forces', '<f8', (FORCE_WINDOWS,)),  # mean sensor force of each fifth of the tick
    ('force', '<f8'),                          # sensor force at the end of the tick
    ('position', '<f8'),                       # piston or rotor position at the end
    ('velocity', '<f8'),                       # piston or rotor speed at the end
    ('supply_volume', '<f8'),                  # oil drawn from the supply in this tick, m3
    ('return_volume', '<f8'),                  # oil given to the return in this tick, m3
])
"""Load port, actuator to load, one row per actuator and tick."""
