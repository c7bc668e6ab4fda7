"""What the data sheet of a servo valve states over its current: flow, leakage, shift of null."""

from collections.abc import Callable, Sequence

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import numbers, parameter, Parameters
from isa_ros.core.piecewise import POINTS
from isa_ros.errors import ParameterError
import numpy as np


@frozen(kw_only=True)
class StraightFlow(Parameters):
    """Flow proportional to the current, up to the rated one."""

    rated_current_ma: float = parameter('series current of the rated flow', 'mA', gt=0.0, le=1e3)
    rated_flow_lpm: float = parameter(
        'flow at that current and the rated drop', 'l/min', gt=0.0, le=1e3)

    @property
    def currents_ma(self) -> tuple[float, ...]:
        """Return the currents of the curve's points."""
        return 0.0, self.rated_current_ma

    @property
    def flows_lpm(self) -> tuple[float, ...]:
        """Return the flows of the curve's points."""
        return 0.0, self.rated_flow_lpm


@frozen(kw_only=True)
class PointsFlow(Parameters):
    """Flow over current as points, with straight lines between them."""

    current_ma: tuple[float, ...] = numbers(
        'series current of each point, from 0', 'mA', least=2, most=POINTS, ge=0.0, le=1e3)
    flow_lpm: tuple[float, ...] = numbers(
        'flow of each point at the rated drop, from 0', 'l/min', least=2, most=POINTS, ge=0.0,
        le=1e3)

    def __post_init__(self) -> None:
        """Refuse points that do not rise from the origin."""
        super().__post_init__()
        _refuse_falling('current_ma', self.current_ma, 'mA')
        _refuse_falling('flow_lpm', self.flow_lpm, 'l/min')
        _refuse_unpaired(self.current_ma, 'flow_lpm', self.flow_lpm)

    @property
    def currents_ma(self) -> tuple[float, ...]:
        """Return the currents of the curve's points."""
        return self.current_ma

    @property
    def flows_lpm(self) -> tuple[float, ...]:
        """Return the flows of the curve's points."""
        return self.flow_lpm


@frozen(kw_only=True)
class SidesFlow(Parameters):
    """Flow over current as points, extending and retracting; straight lines between them."""

    current_ma: tuple[float, ...] = numbers(
        'magnitude of the series current of each point, from 0', 'mA', least=2, most=POINTS,
        ge=0.0, le=1e3)
    extending_lpm: tuple[float, ...] = numbers(
        'flow of each point at the rated drop, from 0: P to A and B to T', 'l/min', least=2,
        most=POINTS, ge=0.0, le=1e3)
    retracting_lpm: tuple[float, ...] = numbers(
        'likewise with a negative current: P to B and A to T', 'l/min', least=2, most=POINTS,
        ge=0.0, le=1e3)

    def __post_init__(self) -> None:
        """Refuse points that do not rise from the origin."""
        super().__post_init__()
        _refuse_falling('current_ma', self.current_ma, 'mA')
        for name in ('extending_lpm', 'retracting_lpm'):
            _refuse_falling(name, getattr(self, name), 'l/min')
            _refuse_unpaired(self.current_ma, name, getattr(self, name))

    @property
    def currents_ma(self) -> tuple[float, ...]:
        """Return the currents of the curve's points."""
        return self.current_ma

    @property
    def flows_lpm(self) -> tuple[float, ...]:
        """Return the flows of the points, extending."""
        return self.extending_lpm


@frozen(kw_only=True)
class NullShift(Parameters):
    """Shift of the null as data sheets state it, beside that of the spool's null_bias."""

    supply_percent_per_mpa: float = parameter(
        'with supply pressure, of the current at the stop', '%/MPa', absent=0.0,
        source='assumed, none', ge=-10.0, le=10.0)
    temperature_percent_per_k: float = parameter(
        'with oil temperature', '%/K', absent=0.0, source='assumed, none', ge=-1.0, le=1.0)


@frozen(kw_only=True)
class StatedLeakage(Parameters):
    """Leakage from supply to return over current as points, with both ports shut."""

    pressure_mpa: float = parameter(
        'supply above return pressure of the leakage', 'MPa', gt=0.0, le=70.0)
    current_ma: tuple[float, ...] = numbers(
        'series current of each point, from 0', 'mA', least=1, most=POINTS, ge=0.0, le=1e3)
    total_lpm: tuple[float, ...] = numbers(
        'leakage of each point, pilot stage included', 'l/min', least=1, most=POINTS, ge=0.0,
        le=100.0)
    tare_lpm: float = parameter('of it, that of the pilot stage', 'l/min', ge=0.0, le=100.0)

    def __post_init__(self) -> None:
        """Refuse currents that do not rise from 0, totals that rise or are below the pilot's."""
        super().__post_init__()
        _refuse_falling('current_ma', self.current_ma, 'mA')
        _refuse_unpaired(self.current_ma, 'total_lpm', self.total_lpm)
        for k, total in enumerate(self.total_lpm):
            if total < self.tare_lpm:
                raise ParameterError(
                    f'total_lpm[{k}] = {total:g} l/min, must be >= tare_lpm = '
                    f'{self.tare_lpm:g} l/min')
            if k > 0 and total > self.total_lpm[k - 1]:
                raise ParameterError(
                    f'total_lpm[{k}] = {total:g} l/min, must be <= total_lpm[{k - 1}] = '
                    f'{self.total_lpm[k - 1]:g} l/min: lands leak most at null')


def interpolated(x: Sequence[float], y: Sequence[float]) -> Callable[[float], float]:
    """Return the curve of straight lines between points, constant beyond them."""
    return lambda at: float(np.interp(at, x, y))


def _refuse_falling(name: str, values: Sequence[float], unit: str) -> None:
    if values[0] != 0.0:
        raise ParameterError(f'{name}[0] = {values[0]:g} {unit}, must be 0 {unit}')
    for k in range(1, len(values)):
        if not values[k] > values[k - 1]:
            raise ParameterError(
                f'{name}[{k}] = {values[k]:g} {unit}, must be > {name}[{k - 1}] = '
                f'{values[k - 1]:g} {unit}')


def _refuse_unpaired(currents: Sequence[float], name: str, values: Sequence[float]) -> None:
    if len(currents) != len(values):
        raise ParameterError(
            f'{name} has {len(values)} points, must have {len(currents)} as current_ma')
