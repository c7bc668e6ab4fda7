"""The simulated machine, given the commands that a measured one received."""

from collections.abc import Mapping
import math
from typing import Any
import warnings

from isa_ros.analysis.measured.mapping import PLACE, SLOPE, VELOCITY
from isa_ros.analysis.measured.measurement import Measurement
from isa_ros.analysis.measured.quantities import QUANTITIES
from isa_ros.analysis.signals.signals import Signal
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.reu.block import Pid
from isa_ros.reu.impedance import Impedance
from isa_ros.scripting.run import Run
from isa_ros.text.table import digits
import numpy as np

_MOTION = frozenset((PLACE, VELOCITY, 'force_command'))
"""Commands of an impedance, or of a position loop, in whichever mode the actuator is."""

_ROUNDING = 1e-6    # s: times of a file have been rounded
LONGEST_S = 600.0
"""Of a measurement that is simulated: minutes of computing."""


class Playback(Controller):
    """Commands an actuator as a measurement was; each command holds until the next one."""

    def __init__(self, name: str, commands: Mapping[str, Signal], step_ns: int) -> None:
        self._name, self._commands, self._step_ns = name, commands, step_ns

    def step(self, state: State) -> dict[str, Setpoint]:
        """Return the setpoint of the next tick, in which it takes effect."""
        t = (state.t_ns + self._step_ns) / NS_PER_SECOND + _ROUNDING
        values: dict[str, Any] = {}
        for name, (times, numbers) in self._commands.items():
            k = int(np.searchsorted(times, t, side='right')) - 1
            values[QUANTITIES[name].setpoint] = float(numbers[max(k, 0)])
        return {self._name: Setpoint(**values)}


def prepared(run: Run, name: str, measurement: Measurement) -> Run:
    """
    Return a run that begins as a measurement did, in the mode that its command belongs to.

    Raises
    ------
    ConfigError
        There is no command, or commands of two modes; or the first position is out of the stroke.

    """
    commands = sorted(measurement.commands)
    own = run.configuration.actuator(name)
    is_motion = PLACE in commands and _MOTION.issuperset(commands)
    if not commands:
        raise ConfigError(
            f'{measurement.name}: has no command, so there is nothing to simulate; map one of '
            f'{", ".join(key for key in QUANTITIES if QUANTITIES[key].mode)}')
    if not is_motion and (len(commands) > 1 or commands == [VELOCITY]):
        raise ConfigError(
            f'{measurement.name}: has {" and ".join(commands)}, must have one command, or '
            'velocity_command and force_command beside position_command')
    changes: dict[str, Any] = {f'actuators.{name}.beyond_range': 'limit'}
    mode = QUANTITIES[commands[0]].mode
    if not is_motion:
        changes[f'actuators.{name}.mode'] = mode
    if 'position' in measurement.outputs and own.load is not None:
        unit, scale = ('deg', math.radians(1.0)) if own.sheet.is_rotary else ('mm', MILLI)
        changes[f'actuators.{name}.initial_position_{unit}'] = float(
            measurement.outputs['position'].values[0]) / scale
    return run.replace(changes)


def remark(run: Run, name: str, measurement: Measurement) -> str:
    """Return why the simulation will be late although its mapping can mend that; else ''."""
    commands, own = measurement.commands, run.configuration.actuator(name).sheet.reu.position
    if PLACE not in commands or VELOCITY in commands:
        return ''
    if isinstance(own, Impedance) and own.damping > 0.0 and own.stiffness > 0.0:
        late = digits(own.damping / own.stiffness / MILLI, 3)
        cause = (f'the damping of the impedance works against a command at rest, and the '
                 f'simulation is late by damping over stiffness, {late} ms')
    elif isinstance(own, Pid) and own.kv != 0.0:
        cause = 'the feed-forward kv of the position loop has nothing to feed'
    else:
        return ''
    return f'{name}: without {VELOCITY} {cause}; map it, or add to signals: {VELOCITY}: {SLOPE}'


def played(run: Run, name: str, measurement: Measurement, duration: float) -> dict[str, Signal]:
    """
    Return the simulated signals by quantity, at every tick for a duration in s.

    Raises
    ------
    ParameterError
        A value of the run is refused.
    SimulationDiverged
        A state is no longer finite.

    """
    configuration = run.configuration
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')     # limited commands: the measured machine had them too
        result = run.simulate(duration, [Playback(
            name, measurement.commands, configuration.step_ns)])
    supply = next(own for own in configuration.supplies if name in own.feeds)
    names = {quantity: f'{name}.{QUANTITIES[quantity].field}' for quantity in measurement.outputs
             if QUANTITIES[quantity].field}
    if 'supply_pressure' in measurement.outputs:
        names['supply_pressure'] = f'{supply.sampled_at(name)}.pressure'
    return {quantity: Signal(result.time, np.array(result[key]))
            for quantity, key in names.items()}
