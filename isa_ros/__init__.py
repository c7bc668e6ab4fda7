"""
Hydraulic integrated smart actuators as ROS 2 nodes stepped in lockstep, and as Python objects.

    import isa_ros
    run = isa_ros.load('leg', scenario='drop')
    result = run.simulate()
    print(result['kfe.force'].max(), result.units['kfe.force'])

The names below are loaded when they are first used: importing the package takes neither numba
nor ROS.
"""

from importlib import import_module
from typing import Any, TYPE_CHECKING

from isa_ros.core.version import VERSION

if TYPE_CHECKING:
    from isa_ros.actuator.group import ActuatorGroup as ActuatorGroup
    from isa_ros.analysis.signals.recorded_result import read as read
    from isa_ros.controller import Controller as Controller
    from isa_ros.controller import Setpoint as Setpoint
    from isa_ros.controller import Setpoints as Setpoints
    from isa_ros.controller import State as State
    from isa_ros.core.conditions import conditions as conditions
    from isa_ros.scripting.actuators import Actuators as Actuators
    from isa_ros.scripting.result import Result as Result
    from isa_ros.scripting.run import load as load
    from isa_ros.scripting.run import Run as Run
    from isa_ros.scripting.sweep import Sweep as Sweep
    from isa_ros.scripting.sweep import sweep as sweep
    from isa_ros.simulation import Simulation as Simulation
    from isa_ros.surroundings.body import Body as Body
    from isa_ros.surroundings.mechanism import Mechanism as Mechanism
    from isa_ros.surroundings.mechanism import Motion as Motion
    from isa_ros.surroundings.mechanism import Mounting as Mounting
    from isa_ros.surroundings.mechanism_body import MechanismBody as MechanismBody
    from isa_ros.tick.trips import TripWarning as TripWarning

__version__ = VERSION

_HOMES = {
    'ActuatorGroup': 'actuator.group', 'Actuators': 'scripting.actuators',
    'Body': 'surroundings.body', 'Controller': 'controller',
    'Mechanism': 'surroundings.mechanism', 'MechanismBody': 'surroundings.mechanism_body',
    'Motion': 'surroundings.mechanism', 'Mounting': 'surroundings.mechanism',
    'Result': 'scripting.result', 'Run': 'scripting.run', 'Setpoint': 'controller',
    'Setpoints': 'controller', 'Simulation': 'simulation', 'State': 'controller',
    'Sweep': 'scripting.sweep', 'TripWarning': 'tick.trips',
    'conditions': 'core.conditions', 'load': 'scripting.run',
    'read': 'analysis.signals.recorded_result', 'sweep': 'scripting.sweep'}

__all__ = [  # noqa: F822, the names are loaded by `__getattr__`
    'ActuatorGroup', 'Actuators', 'Body', 'Controller', 'Mechanism', 'MechanismBody', 'Motion',
    'Mounting', 'Result', 'Run', 'Setpoint', 'Setpoints', 'Simulation', 'State', 'Sweep',
    'TripWarning', 'conditions', 'load', 'read', 'sweep']


def __getattr__(name: str) -> Any:
    """Load a public name where it is used first."""
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(import_module(f'{__name__}.{_HOMES[name]}'), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
