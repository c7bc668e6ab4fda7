"""Rows and codes of calls of a library, and the actuator of Python to compare with."""

import ctypes

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.config.assembly import timing_of
from isa_ros.core.signals import COMMAND, LOAD_PORT
import numpy as np

NO_INSTANCE, NOT_FINITE, BEYOND_RANGE, UNKNOWN_KIND, UNKNOWN_MODE, WRONG_MODE = range(-1, -7, -1)
PRESSURES, WRONG_SIZE, WRONG_STATE = -7, -8, -9


def port(**values):
    """Return a `LOAD_PORT` at mid stroke with a supply."""
    row = np.zeros((), LOAD_PORT)
    row['x0'], row['supply_pressure'] = 0.05, 20.7e6
    for name, value in values.items():
        row[name] = value
    return row


def command(kinds, **values):
    """Return a `COMMAND` that keeps its gains."""
    row = np.zeros((), COMMAND)
    row['kinds'], row['position'] = kinds, 0.05
    row['stiffness'] = row['damping'] = np.nan
    for name, value in values.items():
        row[name] = value
    return row


class Parameter(ctypes.Structure):
    """A parameter."""

    _fields_ = [('name', ctypes.c_char_p), ('value', ctypes.c_char_p),
                ('number', ctypes.c_double), ('unit', ctypes.c_char_p),
                ('range', ctypes.c_char_p), ('source', ctypes.c_char_p),
                ('meaning', ctypes.c_char_p)]


def parameter(address):
    """Return the parameter at an address."""
    return ctypes.cast(address, ctypes.POINTER(Parameter)).contents


def started(chosen, *start):
    """Return the actuator in Python, started."""
    actuator = SmartActuator(chosen.config, timing_of(chosen.run))
    actuator.start(*start)
    return actuator
