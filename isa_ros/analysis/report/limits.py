"""Limits that the actuators of a run have reached: of loops, stroke, relief valves."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

from isa_ros.actuator.tunable import tunables
from isa_ros.analysis.signals.signals import Signals
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.plant.plant import plant_record
from isa_ros.reu.wiring import active
from isa_ros.text.table import digits
import numpy as np
from numpy.typing import NDArray

Condition = Callable[[NDArray[np.float64]], NDArray[np.bool_]]

_AT_LIMIT = 1.0 - 1e-9      # of a limit: rounding of a product


class ReachedLimit(NamedTuple):
    """A limit that was reached."""

    actuator: str
    what: str
    t_s: float
    """First."""
    share: float
    """Of the samples."""

    def __str__(self) -> str:
        return (f'{self.actuator}: {self.what}, first at t = {self.t_s:.3f} s, '
                f'{digits(100.0 * self.share, 2)} % of the time')


def reached_limits(signals: Signals) -> list[ReachedLimit]:
    """Return the limits that were reached, by actuator; values of the configuration are needed."""
    return [found for own in signals.run.actuators
            for found in (*_of_loops(signals, own), *_of_plant(signals, own))]


def _of_loops(signals: Signals, own: ActuatorConfig) -> Iterator[ReachedLimit]:
    """Yield the loops whose output, the reference of the next one, was at its limit."""
    on, known = [*active(own.sheet.reu)], tunables(own.sheet)
    for outer, inner in zip(on, on[1:]):
        limit = known.get(f'{outer}.limit')
        if limit is not None:
            most = _AT_LIMIT * limit.value
            yield from _where(
                signals, own.name, f'{inner}_reference',
                f'output of the {outer} loop at its limit', lambda values: np.abs(values) >= most)


def _of_plant(signals: Signals, own: ActuatorConfig) -> Iterator[ReachedLimit]:
    """Yield end stops and opened relief valves."""
    plant, stroke = plant_record(own.sheet.plant)[0], own.sheet.plant.drive.stroke
    least = float(plant.sensors.encoder)
    yield from _where(signals, own.name, 'position', 'at the end stop where it is retracted',
                      lambda values: values <= least)
    yield from _where(signals, own.name, 'position', 'at the end stop where it is extended',
                      lambda values: values >= stroke - least)
    opened = float(plant.relief.p_open)
    for side in 'ab':
        yield from _where(
            signals, own.name, f'pressure_{side}', f'relief valve of chamber {side.upper()} open',
            lambda values: values > opened)


def _where(signals: Signals, actuator: str, field: str, what: str,
           is_there: Condition) -> Iterator[ReachedLimit]:
    """Yield a limit if a signal was recorded and reached it."""
    signal = signals.drawn(f'{actuator}.{field}')
    holds = is_there(signal.values)
    if holds.any():
        yield ReachedLimit(actuator, what, float(signal.t[int(np.argmax(holds))]),
                           float(np.mean(holds)))
