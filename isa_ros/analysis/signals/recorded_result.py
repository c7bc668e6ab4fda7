"""A bag as the result of its run: the same names, units and arrays as after `Run.simulate`."""

from collections.abc import Iterator
from pathlib import Path

from isa_ros.analysis.signals.signals import read_signals, Signals
from isa_ros.bag.provenance import SCENARIO
from isa_ros.bag.reader import Bag
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.accounts import entries_of
from isa_ros.core.device import FIELDS
from isa_ros.core.fields import record_type, units_of
from isa_ros.core.signals import Records, SAMPLE
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import BagError, ConfigError, SetpointError
from isa_ros.run.diagnostics import ENERGY
from isa_ros.run.recorded import history_of
from isa_ros.scenario.scenario import idle, Scenario, scenario_of
from isa_ros.scripting.log import Log
from isa_ros.scripting.result import Result
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from msg_adapters import diagnostics
from msg_adapters.actuator_messages import APPLIED_SETPOINT
from msg_adapters.cdr import CdrError
from msg_adapters.setpoint import applied_to_command
import numpy as np

_BY_DEVICE = (*FIELDS, 'largest_cavity')
"""Fields that keep the value of their last message."""


def read(bag: str | Path) -> Result:
    """
    Return the result of the run of a bag: columns, units, accounts, events, configuration.

    It has the columns that messages have, as sensors and listeners had them: NaN at ticks without
    one, accounts at those of `/diagnostics`. ``scenario`` has the configuration and the commands.
    Of a bag whose configuration another version wrote, `Result.problem` says so, and
    ``scenario.run`` has names, kinds and units only. So it does if the scenario cannot be read,
    which then has no commands.

    Raises
    ------
    BagError
        It is no bag of this package, is damaged, or has no samples.
    ConfigError
        Its configuration does not even name its actuators.

    """
    path, opened = Path(bag), Bag(Path(bag))
    signals = read_signals(opened, needs_values=False)
    run = signals.run
    ticks = np.rint(signals.time * (NS_PER_SECOND / run.step_ns)).astype(np.int64)
    log = _empty(run, int(ticks[-1]) + 1)
    _fill(log, signals)
    history = history_of(opened, run)
    for field in _BY_DEVICE:
        log.samples[field] = _held(np.array(history.ticks), history.samples[field], log.samples)
    applied: dict[int, Records] = {}
    for tick, row, command in _messages(opened, run, log):
        applied.setdefault(tick, np.zeros(len(run.actuators), command.dtype))[row] = command
    log = log._replace(
        applied=applied, tuned=history.tuned, tuned_supplies=history.tuned_supplies,
        events=history.events, begins=history.begins,
        observed=log.samples if run.linked else None)
    scenario, problem = _scenario(opened, signals)
    return Result(
        scenario, log, {body.name: units_of(body.fields) for body in run.bodies}, path,
        signals.problem or problem)


def _scenario(bag: Bag, signals: Signals) -> tuple[Scenario, str]:
    """Return the scenario of a bag; the idle one, and the reason, if it cannot be read."""
    n_ticks = round(float(signals.time[-1]) * NS_PER_SECOND) / NS_PER_SECOND
    try:
        return scenario_of(
            bag.provenance.scenario, signals.run, f'{bag.path}: {SCENARIO}'), ''
    except ConfigError as error:
        return idle(signals.run, n_ticks or None), str(error)


def _empty(run: RunConfig, n: int) -> Log:
    """Return a log of NaN for ``n`` samples."""
    def of(dtype: 'np.dtype[np.void]', *shape: int) -> Records:
        rows: Records = np.zeros((n, *shape), dtype)
        rows.view(np.float64)[:] = np.nan
        return rows
    return Log(
        of(SAMPLE, len(run.actuators)), of(SUPPLY_SAMPLE, len(run.sampled_supplies)),
        {body.name: of(record_type(body.fields)) for body in run.bodies}, {})


def _fill(log: Log, signals: Signals) -> None:
    """Write the signals of a bag into its log, at the ticks that they were recorded at."""
    run = signals.run
    rows = {own.name: log.samples[:, k] for k, own in enumerate(run.actuators)}
    rows |= {own.name: log.supplies[:, k] for k, own in enumerate(run.sampled_supplies)}
    rows |= log.bodies
    for name in signals:
        source, _, field = name.partition('.')
        t, values = signals.over_time(name)
        rows[source][field][np.rint(t * (NS_PER_SECOND / run.step_ns)).astype(np.int64)] = values


def _held(ticks: np.ndarray, values: np.ndarray, samples: Records) -> np.ndarray:
    """Return values (m, k) of some ticks (m,) at every one, (n, k): each until the next."""
    if not len(ticks):
        return np.full(samples.shape, np.nan)
    before = np.searchsorted(ticks, np.arange(len(samples)), side='right') - 1
    held: np.ndarray = np.where(before[:, None] < 0, np.nan, values[np.maximum(before, 0)])
    return held


def _messages(bag: Bag, run: RunConfig, log: Log) -> Iterator[tuple[int, int, np.void]]:
    """Yield sample, row and `COMMAND` of applied setpoints; write accounts into the log."""
    topics = {f'/{own.name}/{APPLIED_SETPOINT[0]}': k for k, own in enumerate(run.actuators)}
    names = [own.name for own in run.actuators]
    supplies = [own.name for own in run.sampled_supplies]
    for message in bag.messages({*topics, diagnostics.TOPIC[0]}):
        tick, topic = message.sequence, message.topic
        try:
            if topic in topics:
                row = topics[topic]
                yield tick, row, applied_to_command(message.data, names[row])
            elif topic == diagnostics.TOPIC[0]:
                for name, values in diagnostics.values(message.data, ENERGY).items():
                    is_supply = name in supplies
                    sample = (log.supplies[tick, supplies.index(name)] if is_supply
                              else log.samples[tick, names.index(name)])
                    for entry in entries_of(is_supply):
                        if entry.key in values and np.isnan(sample[entry.field]):
                            sample[entry.field] = float(values[entry.key]) * entry.scale
        except (CdrError, SetpointError, ValueError) as error:
            raise BagError(f'{bag.place_of(message)}: {error}') from error
