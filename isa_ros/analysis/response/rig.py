"""One actuator on a bench, as a command names it: which, with which gains, load, place."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.sheet import ActuatorSheet, refuse_wiring
from isa_ros.analysis.response.actuator_trace import RATE_HZ, setpoints, TIMING, Trace, traced
from isa_ros.analysis.response.loops import Loop, loop_of, Unit, units_of
from isa_ros.config.catalogue import actuator_model, model_names
from isa_ros.config.default_actuator import default_load, DEFAULT_TIMING
from isa_ros.config.own_load import own_load
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.run_config import ActuatorConfig, RunConfig
from isa_ros.config.run_file import load_run
from isa_ros.config.sections import build, kind_of, Place
from isa_ros.config.supplies import SUPPLY, SupplyConfig
from isa_ros.core.signals import LOAD_PORT, Records, START
from isa_ros.core.units import MPA
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import LocalLoad, static_force
from isa_ros.surroundings.supply import ConstantSupply
import numpy as np

REST_S = 0.3            # before anything is excited: several times the slowest loop's settling
BLOCKED = 'blocked'
PAPER = ConstantSupply(pressure_mpa=PAPER_SUPPLY / MPA, return_pressure_mpa=0.0)
TICK_TIMEOUT_S = 5.0    # of a model's run, as in the shipped run files


@dataclass(frozen=True, kw_only=True)
class Choice:
    """What a user names; None takes the default."""

    name: str
    """A packaged model, or a run file."""
    loop: str
    actuator: str | None = None
    preset: str | None = None
    variants: Sequence[str] = ()
    load: str | None = None
    position: float | None = None
    """mm or deg."""


@dataclass(frozen=True)
class Rig:
    """An actuator with one of its loops outermost, on a load of its own."""

    run: RunConfig
    """Of this actuator alone, as nodes would run it."""
    loop: Loop
    load: str

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
        return (f'{config.name} ({model}preset {config.preset}), {self.load} at '
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
    loop on the load the actuator has, unless another kind is named.

    Raises
    ------
    ConfigError
        Something of the choice does not exist or does not fit.

    """
    run = _of_model(choice) if choice.name in model_names() else _of_run(choice)
    config = run.actuators[0]
    units = units_of(config.sheet)
    config = replace(config, initial_position=_place(choice.position, config, units['position']))
    loop = loop_of(config.sheet, choice.loop)
    kind = choice.load or (None if choice.loop == 'position' else BLOCKED)
    model = actuator_model(config.model, 'model')
    if kind is None and config.load is not None:
        kind = kind_of(config.load, LocalLoad)
    else:
        kind = kind or model.default_load
        load = own_load({'kind': kind}, Place('--load'), model, config.sheet,
                        run.span_of(config.name))
        config = replace(config, load=load)
    return Rig(run.alone(replace(config, sheet=loop.sheet)), loop, kind)


def _of_model(choice: Choice) -> RunConfig:
    if choice.actuator is not None:
        raise ConfigError(
            f'--actuator {choice.actuator} is not used: {choice.name} is a model, not a run file')
    model = actuator_model(choice.name, 'model')
    preset = choice.preset or 'default'
    section = model.with_variants(
        model.with_preset(preset, '--preset'), choice.variants, '--variant')
    sheet = build(ActuatorSheet, section, model.place)
    refuse_wiring(sheet)
    config = ActuatorConfig(
        choice.name, model.name, ' + '.join([preset, *choice.variants]), sheet,
        default_load(model, sheet), 0.5 * sheet.plant.drive.stroke)
    return RunConfig(
        choice.name, DEFAULT_TIMING.step_ns, DEFAULT_TIMING.controller_offset_ns,
        TICK_TIMEOUT_S,
        (SupplyConfig(SUPPLY, PAPER, (config.name,)),), (config,), source=choice.name)


def _of_run(choice: Choice) -> RunConfig:
    """Return the run of a file, with the chosen actuator alone."""
    for option, value in (('--preset', choice.preset), ('--variant', choice.variants)):
        if value:
            raise ConfigError(
                f'{option} is not used: {choice.name} is no model, a run file says it itself; '
                f'models: {", ".join(model_names())}')
    try:
        run = load_run(find(choice.name, CONFIG))
    except ConfigError as error:
        if choice.name.endswith('.yaml'):
            raise
        raise ConfigError(f'{error}; models: {", ".join(model_names())}') from error
    if choice.actuator is None and len(run.actuators) > 1:
        names = ', '.join(actuator.name for actuator in run.actuators)
        raise ConfigError(f'{run.source} has several actuators, --actuator must name one: {names}')
    config = run.actuators[0] if choice.actuator is None else run.actuator(choice.actuator)
    return run.alone(config)


def _place(given: float | None, config: ActuatorConfig, unit: Unit) -> float:
    if given is None:
        return config.initial_position
    stroke = config.sheet.plant.drive.stroke
    if not (math.isfinite(given) and 0.0 <= given * unit.scale <= stroke):
        raise ConfigError(
            f'--position = {given:g} {unit.symbol}, must be 0 to {stroke / unit.scale:.4g} '
            f'{unit.symbol}, the stroke of {config.name}')
    return given * unit.scale
