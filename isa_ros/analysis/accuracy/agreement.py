"""
The plant against another solver: the error of the fixed step in solving the equations.

`scipy`'s adaptive DOP853 integrates the same `write_rates` with a tolerance of 1e-12. It starts
anew wherever the current reference jumps, and shrinks its steps to pass the kinks: null and the
dual-gain point, reversals, the amplifier's voltage limit, relief and refill. It integrates the
volumes that the oil lacks (C11), whose rates do not jump where oil begins to boil. With a
tolerance of 1e-13 its solution differs by at most 4e-10 of each state's largest value.
"""

from collections.abc import Iterator
import math
from typing import NamedTuple

from isa_ros.actuator import integration as kernels
from isa_ros.actuator.sheet import actuator_record
from isa_ros.config.models.catalogue import actuator_model
from isa_ros.config.models.own_load import own_load
from isa_ros.config.runs.default_actuator import default_actuator
from isa_ros.config.text.sections import Place
from isa_ros.core.bound import Bound
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.record import row_record
from isa_ros.core.signals import SUPPLY_PORT
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.loads.sheets import local_port, own_record
from isa_ros.plant.chambers import begin_volumes, elastances, end_volumes, volumes
from isa_ros.plant.mechanics import sensor_force
from isa_ros.plant.rest_oil import rest_pressures
import numpy as np
from scipy.integrate import solve_ivp

SUPPLY = 20.7e6        # Pa
TOLERANCE = 1e-12      # of a step, of each state's largest value
ROW = 1e-3             # s between the instants that are compared
LOADS = ('wheel', 'blocked')


@frozen
class Piece:
    """
    Amplifier currents, each held for a millisecond; A.

    The first ``skipped`` milliseconds bring the actuator into motion and are not compared.
    """

    name: str
    currents: tuple[float, ...]
    skipped: int = 0


PIECES = (
    Piece('smooth', (2.0e-4,) * 10 + (2.8e-4,) * 10 + (2.0e-4,) * 10, skipped=10),
    Piece('sine of 4 mA, 10 Hz',
          tuple(4e-3 * math.sin(2.0 * math.pi * 10.0 * k * ROW) for k in range(100))),
    Piece('steps of 5 mA', (5e-3,) * 12 + (-5e-3,) * 12 + (0.0,) * 6),
)
"""Opening one way; through null and the dual-gain point; through every limit of the plant."""


@frozen
class Difference:
    """The largest departure of one state in one piece, relative to its largest value."""

    piece: str
    load: str
    state: str
    relative: float

    @property
    def name(self) -> str:
        """Return piece, load and state in one line."""
        return f'{self.piece}, {self.load}: {self.state}'


class Instant(NamedTuple):
    """Memory of `write_slopes`: the rows of one actuator."""

    given: np.ndarray
    """Time since the step's start, s, and current, A, (2,)."""
    ports: np.ndarray
    feeds: np.ndarray
    actuators: np.ndarray
    bodies: np.ndarray
    rates: np.ndarray


@kernel
def write_slopes(own):
    """Write the derivative of the body into the rates; return 0."""
    kernels.write_rates(own.given[0], own.bodies[0], own.given[1], own.ports[0], own.feeds[0],
                        own.actuators[0], True, own.rates[0], True)
    return 0


class OpenLoopRig:
    """One actuator of a model at rest at mid stroke on one of its own loads, without REU."""

    def __init__(self, model: str, load: str) -> None:
        found = actuator_model(model, 'model')
        place = Place(found.name) / 'load'
        sheet = default_actuator(model, model).sheet
        fixture = own_load({'kind': load}, place, found, sheet)
        middle = 0.5 * sheet.plant.drive.stroke
        self._constants = actuator_record(sheet, 0)
        self._constants['load'] = own_record(fixture)
        self._port = local_port(fixture, middle)
        self._port['supply_pressure'], self._feed = SUPPLY, np.zeros(1, SUPPLY_PORT)
        self._plant = row_record(self._constants).plant
        self._own = kernels.integrated(self._port[0], self._feed[0], self._constants[0])
        _, _, _, self._bodies, rates, self._y, self._k = self._own
        self._given = np.zeros(2)
        self._write_slopes = Bound(write_slopes, Instant(
            self._given, self._port, self._feed, self._constants, self._bodies, rates)).run
        body = row_record(self._bodies)
        body.supply.pressure = SUPPLY
        body.plant.mechanics.position = body.load.position = middle
        body.plant.chambers.p_a, body.plant.chambers.p_b = rest_pressures(
            self._plant, SUPPLY, 0.0, 0.0)
        self._start = self._y[0].copy()

    def fixed(self, piece: Piece, h: float) -> np.ndarray:
        """Return the states after each millisecond in steps of ``h`` s, shape (n, states)."""
        self._y[0] = self._start
        rows = []
        for current in piece.currents:
            kernels.rk4_steps(round(ROW / h), h, current, self._own)
            rows.append(self._y[0].copy())
        return np.array(rows)

    def adaptive(self, piece: Piece, scale: np.ndarray, tolerance: float) -> np.ndarray:
        """Return the same states by scipy; ``scale`` is the largest value of each state."""
        own, oil = row_record(self._bodies).plant, self._plant.chambers
        self._y[0] = scale
        own.chambers.cavity_a, own.chambers.cavity_b = np.array(
            (own.chambers.p_a, own.chambers.p_b)) / elastances(0.5 * oil.stroke, oil)
        absolute, rows = tolerance * self._y[0], []
        self._y[0] = self._start
        for current in piece.currents:
            begin_volumes(own.chambers, *volumes(own.mechanics.position, oil), oil)
            solved = solve_ivp(
                self._slopes, (0.0, ROW), self._y[0].copy(), method='DOP853', args=(current,),
                rtol=tolerance, atol=absolute)
            self._y[0] = solved.y[:, -1]
            end_volumes(own.chambers, *volumes(own.mechanics.position, oil), oil)
            rows.append(self._y[0].copy())
        return np.array(rows)

    def _slopes(self, tau: float, state: np.ndarray, current: float) -> np.ndarray:
        self._y[0], self._given[:] = state, (tau, current)
        self._write_slopes()
        rates: np.ndarray = self._k[0].copy()
        return rates

    def with_force(self, rows: np.ndarray) -> np.ndarray:
        """Return the states with the sensor force as one more column."""
        bodies = np.ascontiguousarray(rows).view(kernels.CONTINUOUS)[:, 0]
        moving, load = bodies['plant']['mechanics'], bodies['load']
        force = [sensor_force(s, v, x, x_rate, self._plant.mechanics) for s, v, x, x_rate in zip(
            moving['position'], moving['velocity'], load['position'], load['velocity'])]
        return np.column_stack((rows, force))


def compare(
        model: str, load: str, piece: Piece, h: float = PLANT_STEP,
        tolerance: float = TOLERANCE) -> Iterator[Difference]:
    """Yield the `Difference` of each state and of the sensor force over one piece."""
    bench = OpenLoopRig(model, load)
    ours = bench.fixed(piece, h)
    size = np.abs(ours).max(axis=0)
    exact = bench.adaptive(piece, np.where(size > 0.0, size, 1.0), tolerance)
    ours, exact = bench.with_force(ours), bench.with_force(exact)
    apart = np.abs(ours - exact)[piece.skipped:].max(axis=0)
    size = np.abs(exact)[piece.skipped:].max(axis=0)
    names = [kernels.state_name(j) for j in range(kernels.STATE_SIZE)] + ['sensor force']
    for name, difference, largest in zip(names, apart, size, strict=True):
        relative = difference / largest if largest > 0.0 else difference
        yield Difference(piece.name, load, name, float(relative))


def agreement(model: str) -> list[Difference]:
    """
    Return the differences between a packaged model's plant at 20 us and scipy's solution.

    Raises
    ------
    ConfigError
        The model does not exist, or it lacks one of the `LOADS`.

    """
    return [found for piece in PIECES for load in LOADS for found in compare(model, load, piece)]
