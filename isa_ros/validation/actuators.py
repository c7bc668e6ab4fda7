"""
The actuators that the simulated checks run: as shipped, or with one parameter changed.

Every simulated check takes its benches and runs from `CheckedActuators`, its expected values from
the shipped sheets (`sheets`), so that a changed parameter moves ours and not the bar.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from isa_ros.analysis.response.rig import Choice, Rig, rig
from isa_ros.config.runs.changed_parameters import with_parameters
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.config.text.parameter_sets import kind_of
from isa_ros.core.frozen import frozen
from isa_ros.loads.sheets import LocalLoad
from isa_ros.scripting.run import load, Run
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.supply import SupplySheet

SUPPLY_PRESSURE = 'supply.pressure_mpa'
LOAD = 'load.'


@frozen
class Change:
    """Parameters multiplied by a factor, wherever a sheet, a load or the supply has them."""

    keys: tuple[str, ...]
    """Keys of `isa params` (``plant. ...``, ``reu. ...``), ``load. ...``, `SUPPLY_PRESSURE`."""
    factor: float

    def of(self, config: ActuatorConfig) -> dict[str, float]:
        """Return the changed values of an actuator and its own load, by key."""
        roots = {'plant': config.sheet.plant, 'reu': config.sheet.reu, 'load': config.load}
        found = {key: _number_at(roots, key.split('.')) for key in self.keys}
        return {key: self.factor * value for key, value in found.items() if value is not None}

    @property
    def is_of_supply(self) -> bool:
        """Return whether the pressure of the supply is changed."""
        return SUPPLY_PRESSURE in self.keys


def _number_at(roots: Mapping[str, Any], path: list[str]) -> float | None:
    """Return the number at a path of parameter sets; None if there is none."""
    below = roots.get(path[0])
    for name in path[1:]:
        below = getattr(below, name, None)
    return float(below) if isinstance(below, (int, float)) else None


@frozen
class CheckedActuators:
    """The shipped actuators with one change, or none."""

    change: Change | None = None

    def rig(self, choice: Choice) -> Rig:
        """Return a bench; as `isa_ros.analysis.response.rig.rig`."""
        found = rig(choice)
        if self.change is None:
            return found
        found = self.changed(found)
        if not self.change.is_of_supply:
            return found
        factor = self.change.factor

        def changed(sheet: SupplySheet) -> SupplySheet:
            assert not isinstance(sheet, CircuitSupply)     # no bench has one
            return replace(sheet, pressure_mpa=factor * sheet.pressure_mpa)
        supplies = tuple(replace(supply, sheet=changed(supply.sheet))
                         for supply in found.run.supplies)
        return replace(found, run=replace(found.run, supplies=supplies))

    def changed(self, bench: Rig) -> Rig:
        """Return a bench with the change in its actuator and load."""
        if self.change is None:
            return bench
        return bench.with_config(with_parameters(
            bench.config, self.change.of(bench.config), bench.run.source))

    def run(self, config: str, scenario: str, changes: Mapping[str, Any] | None = None) -> Run:
        """Return a shipped run with its scenario, and ``changes`` of its files before ours."""
        found = load(config, scenario).replace(changes or {})
        if self.change is None:
            return found
        values: dict[str, Any] = {}
        for actuator in found.configuration.actuators:
            for key, value in self.change.of(actuator).items():
                if key.startswith(LOAD):    # a scenario's load replaces that of the run file
                    assert actuator.load is not None
                    load_key = f'scenario.loads.{actuator.name}'
                    values[f'{load_key}.kind'] = kind_of(actuator.load, LocalLoad)
                    values[f'{load_key}.{key.removeprefix(LOAD)}'] = value
                else:
                    values[f'actuators.{actuator.name}.parameters.{key}'] = value
        if self.change.is_of_supply:
            supply, = found.configuration.supplies
            values[SUPPLY_PRESSURE] = self.change.factor * supply.sheet.pressure_mpa
        return found.replace(values)


SHIPPED = CheckedActuators()
