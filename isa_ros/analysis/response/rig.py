"""One actuator on a bench, as a command names it: which, with which gains, load, place."""

from collections.abc import Mapping
from dataclasses import field, replace
import math
from typing import Any

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.analysis.response.actuator_trace import RATE_HZ, setpoints, TIMING, Trace, traced
from isa_ros.analysis.response.body_load import body_load
from isa_ros.analysis.response.choice import Choice, chosen, ChosenRun
from isa_ros.analysis.response.loops import (
    Loop, loop_name, loop_of, units_of, UserUnit)
from isa_ros.config.models.catalogue import actuator_model
from isa_ros.config.models.own_load import own_load
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.config.text.changes import changed
from isa_ros.config.text.parameter_sets import kind_of
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.signals import LOAD_PORT, Records, START
from isa_ros.core.units import MPA
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad, static_force
import numpy as np

__all__ = ['BLOCKED', 'Choice', 'REST_S', 'Rig', 'rig', 'rig_of']

REST_S = 0.3            # before anything is excited: several times the slowest loop's settling
BLOCKED, MASS = 'blocked', 'mass'


@frozen
class Rig:
    """An actuator with one of its loops outermost, on a load of its own."""

    run: RunConfig
    """Of this actuator alone, as nodes would run it."""
    loop: Loop
    load: str
    """Its kind."""
    values: Mapping[str, Any] = field(default_factory=dict)
    """Values chosen by key; they are in ``run``, and named in its title."""
    load_source: str = ''
    """Of an actuator that a body loads: where its load comes from."""

    @property
    def inertia(self) -> float | None:
        """Return the inertia of the load, kg | kg m2; None: recorded on a body."""
        load = self.config.load
        return None if load is None else float(load.inertia)

    @property
    def load_in_words(self) -> str:
        """Return the kind of the load; of one that moves in a position loop with its inertia."""
        if self.inertia is None or self.load == BLOCKED or self.loop.name != 'position':
            return self.load
        unit = 'kg m2' if self.config.sheet.is_rotary else 'kg'
        source = f', {self.load_source},' if self.load_source else ''
        return f'{self.load} of {self.inertia:.4g} {unit}{source}'

    @property
    def config(self) -> ActuatorConfig:
        """Return the actuator."""
        return self.run.actuators[0]

    def with_config(self, config: ActuatorConfig) -> 'Rig':
        """Return the rig with another actuator on it."""
        return replace(self, run=replace(self.run, actuators=(config,)))

    @property
    def title(self) -> str:
        """Return what stands on the bench, and where."""
        place = units_of(self.config.sheet)['position']
        config = self.config
        model = '' if config.name == config.model else f'{config.model}, '
        values = ''.join(f', {key} = {value}' for key, value in self.values.items())
        return (f'{config.name} ({model}preset {config.preset}{values}), {self.load_in_words} at '
                f'{config.initial_position / place.scale:.4g} {place.symbol}')

    @property
    def offset(self) -> float:
        """Return where the loop's reference rests: the start, or 0."""
        return self.config.initial_position if self.loop.name == 'position' else 0.0

    @property
    def ports(self) -> Records:
        """Return the `LOAD_PORT` row of every tick: the pressures of the supply, (1,)."""
        return self._with_pressures(LOAD_PORT)

    def _with_pressures(self, record: np.dtype[np.void]) -> Records:
        row = np.zeros(1, record)
        supply = self.run.supply_of(self.config.name)
        row['supply_pressure'] = supply.pressure_mpa * MPA
        row['return_pressure'] = supply.return_pressure_mpa * MPA
        return row

    def begin(self, force: float) -> ActuatorGroup:
        """Return the actuator alone at t = 0, where it is placed, holding ``force`` (N | Nm)."""
        group, start = ActuatorGroup([self.config], TIMING), self._with_pressures(START)
        start['position'], start['force'] = self.config.initial_position, force
        group.start(start)
        return group

    def start(self) -> ActuatorGroup:
        """Return the actuator at rest: `REST_S` with its reference standing still."""
        actuator = self.begin(static_force(self.config.load))
        self.excite(actuator, np.zeros(round(REST_S * RATE_HZ)))
        return actuator

    def excite(
            self, actuator: ActuatorGroup, values: np.ndarray,
            rates: np.ndarray | None = None) -> Trace:
        """
        Excite the loop by ``values`` around its offset, SI; return the trace.

        ``rates`` are theirs: a position moves its velocity along, as a scenario's does.
        """
        given = self.loop.per_reference * (self.offset + values)
        return traced(
            actuator, self.ports, setpoints(actuator, self.loop.quantity, given, rates))

    def amplitude(self, given: float | None) -> float:
        """
        Return an amplitude given in the loop's unit in SI, or the loop's own.

        Raises
        ------
        ConfigError
            It is beyond what the loop can do.

        """
        if given is None:
            return self.loop.amplitude
        unit, largest = self.loop.unit, self.loop.largest
        if given * unit.scale > largest:
            raise ConfigError(
                f'--amplitude = {given:g} {unit.symbol}, must be <= '
                f'{largest / unit.scale:.4g} {unit.symbol}, the range of the '
                f'{self.loop.name} loop')
        return given * unit.scale


def rig(choice: Choice) -> Rig:
    """
    Return the rig a user names.

    A force, pressure, spool or current loop is measured against a blocked output, a position
    loop on the load the actuator has, unless another kind is named. Of an actuator that moves a
    body that is its effective mass at the start pose, under the force that is held there.

    Raises
    ------
    ConfigError
        Something of the choice does not exist or does not fit.

    """
    return rig_of(chosen(choice), choice)


def rig_of(named: ChosenRun, choice: Choice) -> Rig:
    """Return the rig of a run with the chosen values; as `rig`."""
    config = named.run.actuator(named.actuator)
    units = units_of(config.sheet)
    config = replace(config, initial_position=_place(choice.position, config, units['position']))
    loop = loop_of(config.sheet, loop_name(config, choice.loop))
    model, source = actuator_model(config.model, 'model'), ''
    if choice.keeps_load and config.load is not None:
        kind = kind_of(config.load, LocalLoad)
    else:
        kind = choice.load or (model.default_load if choice.loop == 'position' else BLOCKED)
        place = Place('--load')
        tree: Tree = {'kind': kind}
        if choice.keeps_load:
            tree, source = _of_body(named, tree)
        tree = changed(tree, named.load_values, place.file)
        config = replace(config, load=own_load(tree, place, model, config.sheet))
        kind = str(tree['kind'])
    return Rig(
        named.run.alone(replace(config, sheet=loop.sheet)), loop, kind, choice.values, source)


def _of_body(named: ChosenRun, default: Tree) -> tuple[Tree, str]:
    """Return the load of an actuator that moves a body, and where it comes from."""
    body = named.run.body_of(named.actuator)
    where = 'its body' if body is None else body.name
    if 'inertia' in named.load_values:
        return default, f'given, not that of {where}'
    found = body_load(named.run, named.actuator)
    if found is None or MASS not in actuator_model(
            named.run.actuator(named.actuator).model, 'model').loads:
        return default, f"the model's default, not that of {where} (--set load.inertia=)"
    return ({'kind': MASS, 'inertia': found.inertia, 'force': found.force},
            f'the effective mass of {found.body} at its start pose')


def _place(given: float | None, config: ActuatorConfig, unit: UserUnit) -> float:
    if given is None:
        return config.initial_position
    stroke = config.sheet.plant.drive.stroke
    if not (math.isfinite(given) and 0.0 <= given * unit.scale <= stroke):
        raise ConfigError(
            f'--position = {given:g} {unit.symbol}, must be 0 to {stroke / unit.scale:.4g} '
            f'{unit.symbol}, the stroke of {config.name}')
    return given * unit.scale
