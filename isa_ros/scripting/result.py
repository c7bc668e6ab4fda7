"""Results of a run as columns over time: names, units, arrays; a bag on demand."""

from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, TYPE_CHECKING

from isa_ros.core.accounts import Account, accounts_of
from isa_ros.core.fields import units_of
from isa_ros.core.signals import SAMPLE_FIELDS
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import AnalysisError, BagError
from isa_ros.plant.cushion_sheets import is_cushioned
from isa_ros.scenario.scenario import Scenario
from isa_ros.scripting.log import Log, LogSink
from isa_ros.simulation import Simulation
from isa_ros.surroundings.supply_sample import SUPPLY_FIELDS
from isa_ros.text.progress import Progress
from isa_ros.tick.trips import Trip, trips_of
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from isa_ros.run.events import Event

LINK = 'link'


class Result(Mapping[str, NDArray[np.float64]]):
    """
    A run's signals over time: ``result['kfe.force']`` is an array, (n + 1,) for n ticks.

    Names are ACTUATOR.FIELD with the fields of `SAMPLE`, SUPPLY.FIELD of `SUPPLY_SAMPLE`, and
    BODY.FIELD by the name of a body, ``body`` for the only one; of an actuator with a link also
    ACTUATOR.link.FIELD, the sample that has arrived over it. A field of several numbers gives an
    array of as many columns. SI, pressures gauge. The arrays are read-only views of the log; copy
    them to change values.
    """

    def __init__(
            self, scenario: Scenario, log: Log,
            body_units: Mapping[str, Mapping[str, str]], bag: Path | None = None,
            problem: str = '', *,
            bodies: Mapping[str, str] = MappingProxyType({})) -> None:
        self.scenario = scenario
        """The simulated scenario."""
        self.bag = bag
        """The bag that it was read from; None: it was simulated."""
        self.problem = problem
        """The reason why configuration or scenario of a bag cannot be read here; or ''."""
        self.log = log
        """The rows that the columns are views of."""
        self._provenance = bodies
        run = scenario.run
        self.time: NDArray[np.float64] = (
            np.arange(len(log.samples)) * run.step_ns / NS_PER_SECOND)
        """Time of the samples, s, (n + 1,)."""
        self.units: Mapping[str, str] = {
            name: unit for name, unit in self._units(body_units) if name in self._columns}
        """Unit of every name."""

    def _units(
            self, body_units: Mapping[str, Mapping[str, str]]) -> Iterator[tuple[str, str]]:
        for actuator in self.scenario.run.actuators:
            for field, unit in units_of(SAMPLE_FIELDS, actuator.sheet.is_rotary).items():
                yield f'{actuator.name}.{field}', unit
                if actuator.name in self.scenario.run.linked:
                    yield f'{actuator.name}.{LINK}.{field}', unit
        for supply in self.scenario.run.sampled_supplies:
            for field, unit in units_of(SUPPLY_FIELDS).items():
                yield f'{supply.name}.{field}', unit
        for name, units in body_units.items():
            for field, unit in units.items():
                yield f'{name}.{field}', unit

    @cached_property
    def _columns(self) -> dict[str, NDArray[np.float64]]:
        run, log = self.scenario.run, self.log
        sources = [*((actuator.name, log.samples[:, k]) for k, actuator in
                     enumerate(run.actuators)),
                   *((supply.name, log.supplies[:, k])
                     for k, supply in enumerate(run.sampled_supplies))]
        if log.observed is not None:
            sources += [(f'{name}.{LINK}', log.observed[:, run.index(name)])
                        for name in run.linked]
        sources += log.bodies.items()
        columns = {}
        for source, rows in sources:
            for field in rows.dtype.names or ():
                columns[f'{source}.{field}'] = rows[field]
        if self.bag is not None:    # no message has what is nowhere a number
            columns = {name: column for name, column in columns.items()
                       if not np.isnan(column).all()}
        for column in columns.values():
            column.flags.writeable = False
        return columns

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name not in self._columns:
            raise KeyError(f'{name} is unknown; {alternatives(name, self._columns)}')
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        run = self.scenario.run
        return (f'<Result of {run.source}, {self.scenario.name}: {len(self)} signals, '
                f'{len(self.time)} samples to t = {self.time[-1]:g} s>')

    @property
    def accounts(self) -> dict[str, Account]:
        """Return oil and energy from t = 0 to the end by actuator and supply: key to number."""
        run, log = self.scenario.run, self.log
        return accounts_of(
            [actuator.name for actuator in run.actuators], log.samples[-1],
            [supply.name for supply in run.sampled_supplies], log.supplies[-1],
            (len(log.samples) - 1) * run.step_ns)

    @cached_property
    def trips(self) -> list[Trip]:
        """Return what tripped, in the order of time: actuator, condition, time, value, level."""
        return trips_of(self.log.samples[self._with_device], [
            (own.name, own.sheet.is_rotary) for own in self.scenario.run.actuators])

    @cached_property
    def _with_device(self) -> NDArray[np.intp]:
        """Return the samples that say what the devices do: all, of a bag those from a message."""
        return np.flatnonzero(~np.isnan(self.log.samples['device_state']).any(axis=1))

    @cached_property
    def events(self) -> 'list[Event]':
        """
        Return what happened, in the order of time: time, source, kind, what.

        Trips, warnings, states, refusals, cavities, and faults and other changes of parameters;
        those of the bag of the run are the same.
        """
        from isa_ros.run.events import Begin, events_in, History, Trapped  # import messages
        log, run = self.log, self.scenario.run
        cushions = {}
        for row, own in enumerate(run.actuators):
            if is_cushioned(own.sheet.plant):
                trapped = log.samples[:, row]['cushion_pressure']
                there = np.flatnonzero(~np.isnan(trapped))
                cushions[row] = Trapped(there.tolist(), trapped[there])
        return events_in(run, History(
            self._with_device.tolist(), log.samples[self._with_device], log.tuned,
            log.tuned_supplies, cushions, log.events,
            {place: Begin(*begin) for place, begin in log.begins.items()}))

    def _flat(self) -> Iterator[tuple[str, NDArray[np.float64]]]:
        """Yield every column of numbers; ``name[k]`` for those of an array."""
        for name, column in self.items():
            if column.ndim == 1:
                yield name, column
                continue
            for k in range(column.shape[1]):
                yield f'{name}[{k}]', column[:, k]

    def to_pandas(self) -> Any:
        """
        Return a `pandas.DataFrame` with the time in s as index, units in ``attrs['units']``.

        Raises
        ------
        AnalysisError
            pandas is not installed.

        """
        pandas = optional('pandas')
        frame = pandas.DataFrame(
            dict(self._flat()), index=pandas.Index(self.time, name='time'))
        frame.attrs['units'] = dict(self.units)
        return frame

    def to_xarray(self) -> Any:
        """
        Return an `xarray.Dataset` over the time in s; every variable has its unit.

        Raises
        ------
        AnalysisError
            xarray is not installed.

        """
        xarray = optional('xarray')
        return xarray.Dataset(
            {name: (('time',) if column.ndim == 1 else ('time', f'{name}_axis'), column,
                    {'units': self.units[name]}) for name, column in self.items()},
            coords={'time': ('time', self.time, {'units': 's'})})

    def save(self, directory: str | Path, *, overwrite: bool = False) -> Path:
        """
        Write a bag with the same bytes as `isa bringup` records; return its directory.

        Raises
        ------
        BagError
            The directory already exists and ``overwrite`` is not set, or it cannot be created; or
            the result was read from a bag.
        ConfigError
            `record` of the run leaves out a topic that does not exist, or that a replay needs.
        RunError
            The bag cannot be written.

        """
        if self.bag is not None:
            raise BagError(f'{directory}: not written, the result was read from {self.bag}, which '
                           'is its bag')
        from isa_ros.scripting.bag import save  # imports messages, which only bags need
        return save(self.scenario, self.log, self._provenance, Path(directory), overwrite)


def optional(package: str) -> Any:
    """Return an optional package; raise `AnalysisError` if it is not installed."""
    from importlib import import_module
    try:
        return import_module(package)
    except ImportError as error:
        raise AnalysisError(f'{package} is not installed: pip install {package}') from error


def simulated(
        simulation: Simulation, n_ticks: int, report: Progress | None = None) -> Result:
    """
    Return the result of the first ``n_ticks`` of a simulation at t = 0.

    Raises
    ------
    SimulationDiverged
        A state is no longer finite.

    """
    log = LogSink(simulation, n_ticks, report)
    simulation.loop.sinks = (log,)
    simulation.loop.run(n_ticks)
    return result_of(simulation, log)


def result_of(simulation: Simulation, log: LogSink) -> Result:
    """Return the result of what a simulation has logged."""
    surroundings = simulation.surroundings
    return Result(simulation.scenario, log.log, {
        name: body.units for name, body in surroundings.bodies.items()},
        bodies=surroundings.provenance)
