"""The simulated machine, given the commands that a measured one received."""

from collections.abc import Mapping
from dataclasses import field
import math
from typing import Any
import warnings

from isa_ros.actuator.requests import start_mode
from isa_ros.actuator.setpoint_range import complete, LIMIT, positions, SetpointRange
from isa_ros.analysis.measured.mapping import PLACE, SLOPE, VELOCITY
from isa_ros.analysis.measured.measurement import Measurement
from isa_ros.analysis.measured.quantities import QUANTITIES
from isa_ros.analysis.signals.signals import Signal
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.controller import Setpoint
from isa_ros.core.device import IMPEDANCE, MODES, POSITION, REFERENCES
from isa_ros.core.frozen import frozen
from isa_ros.core.signals import COMMAND, Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.requests import fill_command
from isa_ros.reu.block import Pid
from isa_ros.reu.impedance import Impedance
from isa_ros.scenario.scenario import Scenario
from isa_ros.scripting.run import Run
from isa_ros.text.table import digits
import numpy as np

_MOTION = frozenset((PLACE, VELOCITY, 'force_command'))
"""Commands of an impedance, or of a position loop, in whichever mode the actuator is."""

_ROUNDING = 1e-6    # s: times of a file have been rounded
LONGEST_S = 600.0
"""Of a measurement that is simulated: minutes of computing."""


@frozen
class Playback(Scenario):
    """A scenario that commands one actuator as a machine was, from the first tick after t = 0."""

    row: int = 0
    """Of the actuator."""
    received: Records = field(default_factory=lambda: np.zeros(1, COMMAND), compare=False)
    """Its `COMMAND` by tick, (n_ticks + 1,)."""

    def next_command(self, tick: int) -> float:
        """Return the first tick from ``tick`` on with a command."""
        return max(tick, 1)

    def commands(self, tick: int, out: Records) -> None:
        """Write this tick's command into ``out``, `COMMAND` rows of shape (n_actuators,)."""
        if 0 < tick < len(self.received):
            out[self.row] = self.received[tick]


def playback(
        run: RunConfig, name: str, commands: Mapping[str, Signal], n_ticks: int) -> Playback:
    """
    Return the scenario of what an actuator was commanded: each command holds until the next one.

    Before its first one that one counts. What is beyond the actuator's range is limited to it.
    """
    t = np.arange(n_ticks + 1) * run.step_ns / NS_PER_SECOND + _ROUNDING
    values = {QUANTITIES[quantity].setpoint: own.values[
        np.maximum(np.searchsorted(own.t, t, side='right') - 1, 0)]
        for quantity, own in commands.items()}
    first = np.zeros(1, COMMAND)
    setpoint: dict[str, Any] = {key: float(own[0]) for key, own in values.items()}
    fill_command(name, Setpoint(**setpoint), first[0])
    actuator = run.actuator(name)
    complete(first[0], actuator.initial_position)
    received = np.repeat(first, len(t))
    for key, own in values.items():
        received['reference' if key in REFERENCES else key] = own
    SetpointRange(name, actuator.sheet, LIMIT).limit(received)
    return Playback(f'playback_{name}', run, n_ticks, (), row=run.index(name), received=received)


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
    elif 'force_command' not in commands:
        _refuse_mode(measurement.name, own)
    if 'position' in measurement.outputs and own.load is not None:
        _refuse_start(measurement, own)
        unit, scale = ('deg', math.radians(1.0)) if own.sheet.is_rotary else ('mm', MILLI)
        changes[f'actuators.{name}.initial_position_{unit}'] = float(
            measurement.outputs['position'].values[0]) / scale
    return run.replace(changes)


def _refuse_start(measurement: Measurement, own: ActuatorConfig) -> None:
    """Refuse a measurement whose first position is one that the actuator cannot have."""
    first, within = float(measurement.outputs['position'].values[0]), positions(own.sheet)
    if not within.low <= first <= within.high:
        raise ConfigError(
            f'{measurement.name}: position begins at {first:g} {within.unit}, must be within '
            f'{within.low:g} to {within.high:g} {within.unit}, {within.what} of {own.name}: are '
            'its unit, sign and offset in the mapping right?')


def _refuse_mode(measured: str, own: ActuatorConfig) -> None:
    """Refuse an actuator that begins in a mode that does not use a position."""
    mode = start_mode(own.name, own.mode, own.sheet.reu)
    if mode not in (POSITION, IMPEDANCE):
        raise ConfigError(
            f'{measured}: has {PLACE}, which {own.name} does not use in mode {MODES[mode]}; set '
            f'actuators.{own.name}.mode to position or impedance, or map force_command too')


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
    n_ticks = round(duration * NS_PER_SECOND / configuration.step_ns)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')     # trips: the measured machine may have had them too
        result = run.following(
            playback(configuration, name, measurement.commands, n_ticks)).simulate()
    supply = next(own for own in configuration.supplies if name in own.feeds)
    names = {quantity: f'{name}.{QUANTITIES[quantity].field}' for quantity in measurement.outputs
             if QUANTITIES[quantity].field}
    if 'supply_pressure' in measurement.outputs:
        names['supply_pressure'] = f'{supply.sampled_at(name)}.pressure'
    return {quantity: Signal(result.time, np.array(result[key]))
            for quantity, key in names.items()}
