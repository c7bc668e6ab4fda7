"""
Faults that a page switches on and off: those of the catalogue that a run can have.

A fault lies over the values of its parameters; when it is switched off, what lies beneath is back.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.tunable import changed_together, changing, named
from isa_ros.config.models.fault_catalogue import (
    ACTUATOR, fault_catalogue, NamedFault, SUPPLY)
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.core.changeable import changeables, with_changes
from isa_ros.core.changing_values import OFF, OVER
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.scenario.part_faults import parts_with, values_of_part
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.supply import SupplySheet
from isa_ros.surroundings.surroundings import Surroundings

Values = Mapping[str, float]


class Switch(NamedTuple):
    """A fault that a page switches."""

    meaning: str
    values: Values
    """As messages have them, of a supply by SUPPLY.KEY."""


class FaultChoices:
    """The faults of the actuators and supplies of a run; ``actuators`` are by name."""

    def __init__(self, run: RunConfig, actuators: Mapping[str, SmartActuator],
                 surroundings: Surroundings) -> None:
        self._tune: dict[str, Callable[[Values], object]] = {
            name: own.tune for name, own in actuators.items()}
        self._known = {own.name: dict(_of_actuator(own)) for own in run.actuators}
        for supply in run.supplies:
            self._tune[supply.name] = surroundings.tune
            self._known[supply.name] = dict(_of_supply(supply.name, supply.sheet))
        self.on: list[tuple[str, str]] = []
        """What is on: actuator or supply, and fault, the latest last."""

    def tree(self, of: str) -> list[Mapping[str, str]]:
        """Return the faults of an actuator or a supply, for JSON."""
        return [{'name': name, 'meaning': own.meaning} for name, own in self._known[of].items()]

    def restart(self) -> None:
        """Forget what is on: at t = 0 nothing lies over a value."""
        self.on.clear()

    def switch(self, of: str, name: str, is_on: bool) -> str:
        """
        Switch a fault on or off, from the next tick on; return what was done.

        Raises
        ------
        ConfigError
            There is no such fault, or its value is refused now.

        """
        if of not in self._known:
            raise ConfigError(f'{of!r} is not an actuator or a supply; '
                              f'{alternatives(of, self._known)}')
        if name not in self._known[of]:
            raise ConfigError(f'{of}: fault {name!r} is unknown; '
                              f'{alternatives(name, self._known[of])}')
        values, tune = self._known[of][name].values, self._tune[of]
        if is_on:
            tune({f'{OVER}{key}': value for key, value in values.items()})
        elif (of, name) in self.on:
            tune({f'{OFF}{key}': 0.0 for key in values} | {
                f'{OVER}{key}': value for key, value in self._beneath(of, name).items()})
        self.on = [own for own in self.on if own != (of, name)] + ([(of, name)] if is_on else [])
        return f'{of}: {name} {"on" if is_on else "off"}'

    def _beneath(self, of: str, name: str) -> Values:
        """Return the values of a fault's parameters that others, still on, lay over them."""
        own = self._known[of][name].values
        return {key: value for other, fault in self.on if (other, fault) != (of, name)
                if other == of for key, value in self._known[of][fault].values.items()
                if key in own}


def _of_actuator(actuator: ActuatorConfig) -> Iterable[tuple[str, Switch]]:
    """Yield the faults that an actuator can have, their values as messages have them."""
    known = changing(actuator.sheet, actuator.load)
    keys = {own.key for own in known.values()}
    for name, fault in fault_catalogue().items():
        if fault.of != ACTUATOR or (fault.rig and not fault.values.keys() <= keys):
            continue    # it lacks the part, such as a cushion
        try:
            values = named(known, fault.values)
            changed_together(actuator.sheet, actuator.load, values, known)
        except ConfigError:
            continue    # it lacks the part, such as a link
        yield name, Switch(fault.meaning, values)


def _of_supply(name: str, sheet: SupplySheet) -> Iterable[tuple[str, Switch]]:
    """Yield the faults that a supply can have, of a circuit those of each part."""
    known = changeables(sheet)
    for fault in fault_catalogue().values():
        if fault.of != SUPPLY:
            continue
        for part, values in _values_in(sheet, fault):
            try:
                with_changes(sheet, known, values)
            except ConfigError:
                continue    # it lacks the part, or has another range
            yield (f'{part}: {fault.name}' if part else fault.name), Switch(
                fault.meaning, {f'{name}.{key}': value for key, value in values.items()})


def _values_in(sheet: SupplySheet, fault: NamedFault) -> Iterable[tuple[str, Values]]:
    """Yield the values of a fault with the part of a circuit that has it, '' otherwise."""
    if isinstance(sheet, CircuitSupply) and fault.part:
        for part in parts_with(fault, sheet):
            yield part, values_of_part(fault, part)
    elif fault.values:
        yield '', fault.values
