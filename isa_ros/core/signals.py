"""
Records exchanged between components: setpoints, samples, both directions of the load port.

Each signal is one numpy record type, SI units, little endian, so that the same bytes
serve as kernel argument, log row and wire format. Generalised coordinates: metres and
newtons for a linear actuator, radians and newton metres for a rotary one.
Force > 0 pushes out; pressures are gauge.
"""

from isa_ros.core.fields import Field, record_type
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
WAS_REFUSED = 128
"""Of an applied `COMMAND` only: the device refused to enable or disable, ``is_enabled`` is what
stayed, and the request was the opposite."""

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

MEASURED = np.dtype([
    ('position', 'f8'),          # encoder, m | rad
    ('force', 'f8'),             # load cell or torque sensor, N | Nm
    ('pressure_a', 'f8'),        # Pa gauge
    ('pressure_b', 'f8'),        # Pa gauge
    ('spool', 'f8'),             # m
    ('current', 'f8'),           # of the amplifier, A
])
"""The last readings of the channels of one actuator's sensors."""
CHANNELS = tuple(MEASURED.names or ())
SUPPLY_CHANNEL = 'supply'
"""In the order of all arrays of channels, and of their noise."""

SAMPLE_FIELDS = (
    Field('position', 'm | rad', 'read by the encoder'),
    Field('velocity', 'm/s | rad/s', 'estimated by the REU'),
    Field('force', 'N | Nm', 'read by the load cell or torque sensor'),
    Field('pressure_a', 'Pa', 'of chamber A, as sensed, gauge: never below 0'),
    Field('pressure_b', 'Pa', 'of chamber B, as sensed, gauge: never below 0'),
    Field('spool', 'm', 'of its position sensor'),
    Field('spool_velocity', 'm/s', 'exact, without a sensor'),
    Field('current', 'A', 'of the amplifier, as sensed'),
    Field('position_reference', 'm | rad', 'in force in the position block'),
    Field('force_reference', 'N | Nm', 'of the force block'),
    Field('spool_reference', 'm', 'of the spool block'),
    Field('current_reference', 'A', 'of the amplifier'),
    Field('supply_volume', 'm3', 'oil drawn from the supply since t = 0'),
    Field('return_volume', 'm3', 'oil given to the return since t = 0'),
    Field('supply_flow', 'm3/s', 'oil drawn, mean over the tick'),
    Field('power', 'W', 'of the oil, mean over the tick'),
    Field('peak_power', 'W', 'greatest power since t = 0'),
    Field('hydraulic_energy', 'J', 'of the oil drawn less that of the oil returned'),
    Field('leakage_energy', 'J', 'lost to the leakage of the valve'),
    Field('throttling_energy', 'J', 'lost at the open lands of the valve'),
    Field('cross_port_energy', 'J', 'lost past the piston or vane, and to the outside'),
    Field('relief_energy', 'J', 'lost through relief and refill valves'),
    Field('friction_energy', 'J', 'lost to the seals'),
    Field('damping_energy', 'J', 'lost in the force sensor; taken up by the end stops'),
    Field('work', 'J', 'done on the load'),
    Field('stored_energy', 'J', 'in oil, moving part and force sensor, more than at t = 0'),
    Field('temperature', 'celsius', 'of the oil in the actuator, as sensed'),
    Field('warnings', 'bits', 'set of conditions as a whole number (isa_ros.conditions)'),
    Field('trips', 'bits', 'likewise'),
    Field('device_state', '1', 'number of `isa_ros.core.device.STATES`'),
    Field('device_mode', '1', 'number of `MODES`, in force or for the next enable'),
    Field('device_event', '1', 'number of `EVENTS`: the last that changed the state or mode'),
    Field('state_since', 's', 'time of the last change of these three or of the bits'),
    Field('age', 's', 'since it was sampled; > 0 behind a link, or of a frozen REU'),
    Field('supply_pressure', 'Pa', 'measured by the REU, gauge'),
    Field('chamber_pressure_a', 'Pa', 'in chamber A, exact, gauge: down to the vapour pressure'),
    Field('chamber_pressure_b', 'Pa', 'in chamber B, likewise'),
    Field('cavity_a', 'm3', 'of vapour in chamber A, exact'),
    Field('cavity_b', 'm3', 'in chamber B, likewise'),
    Field('largest_cavity', 'm3', 'in a chamber at the end of any tick since t = 0'),
    Field('first_trip', 'bits', 'of the trips that are there, the first: the cause'),
    Field('last_trip', 'bits', 'the condition that tripped last, also when it has ended'),
    Field('trip_time', 's', 'when it tripped'),
    Field('trip_value', '1', 'its quantity then, SI, in the unit of its condition'),
    Field('trip_level', '1', 'the level that it was beyond, likewise'),
    Field('warning_time', 's', 'when the last warning began'),
    Field('unused_setpoints', '1', 'that came while the device did not follow them, since t = 0'),
    Field('refused_requests', '1', 'to enable, clear or stop, without effect, since t = 0'),
    Field('is_stale', '1', '1: older than the watchdog of the link or ten cycles; REU frozen'),
    Field('frames_lost_down', '1', 'of the link, to the REU, since t = 0'),
    Field('frames_lost_up', '1', 'likewise, from it'),
    Field('commands_dropped', '1', 'that waited for a frame for the time of the watchdog'),
    Field('cushion_pressure', 'Pa', 'behind a spear, exact, gauge; 0: none is in'),
)
"""The values one actuator reports at the end of a tick."""
SAMPLE = record_type(SAMPLE_FIELDS)

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

SUPPLY_PORT = np.dtype([
    ('elastance', '<f8'),        # 1/C of the supply, Pa/m3; 0: its pressure is held over the tick
    ('inflow', '<f8'),           # of all else less what all actuators drew last, m3/s
    ('trend', '<f8'),            # its slope over time, m3/s2
    ('slope', '<f8'),            # by how much it falls with the pressure, m3/s/Pa
    ('share', '<f8'),            # N: dq/dP of all actuators over that of this one
    ('flow', '<f8'),             # what this one drew last, m3/s
    ('is_warm', '<f8'),          # 1: the supply's oil has the temperature of a tank
    ('celsius', '<f8'),          # that temperature
])
"""Supply's port, supply to actuator, one row per actuator and tick (equations C15, T10)."""

SUPPLY_REPLY = np.dtype([
    ('flow', '<f8'),             # drawn at the end of the tick, m3/s
    ('conductance', '<f8'),      # dq/dP of its valve there, m3/s/Pa
    ('paid', '<f8'),             # energy of the oil drawn in the tick, J
    ('heat', '<f8'),             # that its oil took along to the supply in the tick, J
])
"""Supply's port, actuator to supply, one row per actuator and tick; zeros without a port."""
