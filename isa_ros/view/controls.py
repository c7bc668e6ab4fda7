"""
What a page may change of a run: setpoints, gains, requests and faults, between two ticks.

Each takes the way of a topic, a parameter or a service of ROS: it is checked by the actuator's own
range, takes effect at the next tick, and is in the bag with it. A command of a scenario at the
same tick wins.
"""

from collections.abc import Iterator, Mapping
import math
from typing import Any, NamedTuple

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.ratings import ratings_of
from isa_ros.actuator.setpoint_range import Bounds, NUMBERS, reference_bounds
from isa_ros.actuator.tunable import GAINS, tunables
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.controller import Setpoint
from isa_ros.core.changeable import Changeable
from isa_ros.core.device import IMPEDANCE, MODES, REFERENCES
from isa_ros.core.signals import COMMAND
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MILLI, MPA
from isa_ros.errors import ConfigError, SetpointError
from isa_ros.plant.plant import plant_record
from isa_ros.requests import fill_command, refuse_without_effort
from isa_ros.surroundings.emergency_line import EMERGENCY_STOP
from isa_ros.surroundings.surroundings import Surroundings
from isa_ros.view.faults import FaultChoices
from isa_ros.view.orders import FAULT, Order, REQUEST, SETPOINT, TUNE
import numpy as np

_REQUESTS = {
    'enable': Setpoint(is_enabled=True), 'disable': Setpoint(is_enabled=False),
    'clear_fault': Setpoint(clear_fault=True), 'quick_stop': Setpoint(quick_stop=True)}
_SHOWN = {'m': ('mm', MILLI), 'rad': ('deg', float(np.radians(1.0))), 'A': ('mA', MILLI),
          'Pa': ('MPa', MPA)}
"""Unit of a slider, and what it is in SI, by unit of the setpoint."""
_GAIN_RANGE = 4.0
"""Largest value of a gain's slider over the value at the start."""
_MOTION = ('position', 'effort')
"""Fields of a setpoint that take effect together."""
_STEPS = 1000
"""Of a slider: so far its ends are within bounds that a value must not reach."""
_ENDLESS = math.tau     # rad, either way, of the slider of a motor


class Slider(NamedTuple):
    """A number that a page may move."""

    name: str
    """Field of a setpoint, or key of a parameter."""
    unit: str
    scale: float
    """What one of ``unit`` is in the value of an order."""
    low: float
    high: float
    value: float
    """At the start; these three in ``unit``."""


class Controls:
    """Setpoints, gains, requests and faults of the actuators of a run."""

    def __init__(
            self, run: RunConfig, group: ActuatorGroup, surroundings: Surroundings) -> None:
        self._actuators = {own.name: own for own in group.actuators}
        self._surroundings = surroundings
        self._faults = FaultChoices(run, self._actuators, surroundings)
        self._lines = [
            name for name in surroundings.changing if name.startswith(f'{EMERGENCY_STOP}.')]
        self._starts = dict(zip(self._actuators, surroundings.starts()['position'].tolist()))
        self._sliders = {name: (own.mode, [*self._setpoints(own)])
                         for name, own in self._actuators.items()}

    def tree(self) -> Mapping[str, Any]:
        """Return what a page may change, for JSON."""
        return {
            'actuators': [{
                'name': name, 'mode': MODES[own.mode],
                'setpoints': [slider._asdict() for slider in self._sliders[name][1]],
                'gains': [slider._asdict() for slider in _gains(own)],
                'faults': self._faults.tree(name)} for name, own in self._actuators.items()],
            'supplies': [{'name': own.name, 'faults': self._faults.tree(own.name)}
                         for own in self._surroundings.circuits],
            'requests': [*_REQUESTS], 'has_stop': bool(self._lines)}

    def state(self) -> Mapping[str, Any]:
        """Return what is on: faults, the emergency stop, and the setpoints of all sliders."""
        return {'faults': self._faults.on, 'is_stopped': any(
            self._surroundings.tuned_value(name) for name in self._lines),
            'setpoints': [self._in_force(own) for own in self._actuators.values()]}

    def restart(self) -> None:
        """Forget the faults: the run begins at t = 0. Tuned gains stay."""
        self._faults.restart()

    def carry_out(self, order: Order) -> str:
        """
        Let an order take effect at the next tick; return what was done.

        Raises
        ------
        ConfigError, SetpointError
            It names what the run does not have, or a value is refused.

        """
        if order.what == FAULT:
            return self._faults.switch(order.of, order.name, order.value)
        if order.of not in self._actuators:
            raise ConfigError(
                f'{order.of!r} is not an actuator; {alternatives(order.of, self._actuators)}')
        actuator = self._actuators[order.of]
        if order.what == SETPOINT:
            return self._set(actuator, order.name, order.value)
        if order.what == TUNE:
            actuator.tune({order.name: order.value})
            return f'{order.of}: {order.name} = {order.value:g}'
        assert order.what == REQUEST, 'the rest is of the run'
        return _request(actuator, order.name)

    def _setpoints(self, actuator: SmartActuator) -> Iterator[Slider]:
        """Yield the sliders of a setpoint in the mode at the start."""
        mode, own = actuator.mode, actuator.setpoint_range.bounds
        if mode not in NUMBERS:
            references = reference_bounds(actuator.sheet)
            if mode in references:
                yield _slider(MODES[mode], references[mode], 0.0)
            return
        fields = [name for name in NUMBERS[mode] if name != 'velocity']
        for field in (*fields, *(GAINS.values() if mode == IMPEDANCE else ())):
            bounds = own.get(field) or _rated(actuator)
            value = (self._starts[actuator.name] if field == 'position'
                     else getattr(actuator.setpoint, field))
            yield _slider(field, bounds, value, _GAIN_RANGE if field in GAINS.values() else None)

    def _set(self, actuator: SmartActuator, field: str, value: float) -> str:
        """
        Send a setpoint in which one number is new.

        Returns what was limited, or the number; and why the device does not follow it, if so.
        """
        if field in GAINS.values() or field in REFERENCES:
            setpoint = Setpoint(**{field: value})   # type: ignore[arg-type]
        elif field in _MOTION:
            setpoint = _with_others(actuator, field, value)
        else:
            known = [*_MOTION, *GAINS.values(), *REFERENCES]
            raise SetpointError(f'{actuator.name}: setpoint {field!r} is unknown; '
                                f'{alternatives(field, known)}')
        command = _command(actuator, setpoint)
        refuse_without_effort(actuator.name, setpoint, actuator.mode)
        told = actuator.admit(command) or f'{actuator.name}: {field} = {value:g}'
        why = '' if field in GAINS.values() else actuator.deafness     # which keep a gain
        return f'{told}, not followed: {why}' if why else told

    def _in_force(self, actuator: SmartActuator) -> list[float | None] | None:
        """Return the values of its setpoint's sliders; None in another mode than at the start."""
        mode, sliders = self._sliders[actuator.name]
        if actuator.mode != mode:
            return None
        values = actuator.setpoint._asdict()
        numbers = ((values.get(own.name, values['reference']), own.scale) for own in sliders)
        return [None if value is None else value / scale for value, scale in numbers]


def _with_others(actuator: SmartActuator, field: str, value: float) -> Setpoint:
    """
    Return a setpoint with one new number; the other that its mode uses stays in force.

    One that was taken over may be a little beyond its range, as a position at an end stop.
    """
    used, bounds = NUMBERS.get(actuator.mode, ()), actuator.setpoint_range.bounds
    own = actuator.setpoint._asdict()
    others = {name: own[name] if name not in bounds else
              min(max(own[name], bounds[name].low), bounds[name].high)
              for name in _MOTION if name in used}
    return Setpoint(**{**others, field: value})


def _rated(actuator: SmartActuator) -> Bounds:
    """Return the rated force either way, for loops without an impedance."""
    most = ratings_of(plant_record(actuator.sheet.plant)[0]).force_range
    return Bounds(-most, most, 'Nm' if actuator.is_rotary else 'N', 'the rated force')


def _slider(
        name: str, bounds: Bounds, value: float, gain_range: float | None = None) -> Slider:
    unit, scale = _SHOWN.get(bounds.unit, (bounds.unit, 1.0))
    low, high = bounds.low, bounds.high
    if gain_range is not None and value > 0.0:
        high = min(high, gain_range * value)
    if bounds.what.endswith(' turns'):
        low, high = value - _ENDLESS, value + _ENDLESS
    return Slider(name, unit, scale, float(low / scale), float(high / scale), value / scale)


def _gains(actuator: SmartActuator) -> Iterator[Slider]:
    """Yield the sliders of the gains and limits of the blocks that are on."""
    for name, found in tunables(actuator.sheet).items():
        if name not in GAINS:
            own = found.keyed
            low, high = _range(own)
            yield Slider(own.key, own.unit, 1.0, low, high, own.value)


def _range(own: Changeable) -> tuple[float, float]:
    """Return the range of a slider: from 0 to some times the value, within its bounds."""
    bounds = own.bounds
    low = bounds.get('ge', bounds.get('gt', 0.0))
    high = bounds.get('le', bounds.get('lt', 1.0))
    if own.value > 0.0:
        low, high = max(low, 0.0), min(high, _GAIN_RANGE * own.value)
    step = (high - low) / _STEPS
    is_low, is_high = low == bounds.get('gt'), high == bounds.get('lt')
    return low + is_low * step, high - is_high * step


def _command(actuator: SmartActuator, setpoint: Setpoint) -> np.void:
    """Return the `COMMAND` row of a setpoint."""
    command: np.void = np.zeros(1, COMMAND)[0]
    fill_command(actuator.name, setpoint, command)
    return command


def _request(actuator: SmartActuator, name: str) -> str:
    if name not in _REQUESTS:
        raise SetpointError(f'request {name!r} is unknown; {alternatives(name, _REQUESTS)}')
    is_done, answer = actuator.request(
        _command(actuator, _REQUESTS[name]), name.replace('_', ' '))
    if not is_done:
        raise SetpointError(f'{actuator.name}: {answer}')
    return f'{actuator.name}: {answer}'
