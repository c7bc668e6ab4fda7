"""
The plant linearised where it is fastest, and whether the plant's step follows it.

That is in its end stops, without friction's slip, with the valve closed and wide open; the
eigenvalues tell whether the step damps what the equations damp.
"""

from collections.abc import Iterator
import math
from types import SimpleNamespace

from isa_ros.core.frozen import frozen
from isa_ros.core.timebase import FASTEST_RATE, PLANT_STEP
from isa_ros.plant.coil import EXPLICIT
from isa_ros.plant.servo_valve import flow_curve
from isa_ros.plant.spool import DIRECT, PILOTED
import numpy as np
from numpy.typing import NDArray

_ROUNDED = 1e-9     # the growth of a state at rest, whose eigenvalue is 0, by rounding


@frozen
class LoadSide:
    """The load's side of the force sensor, linearised; units of the actuator."""

    inertia: float = math.inf   # kg | kg m2; inf: not known here
    stiffness: float = 0.0      # to ground, N/m | Nm/rad
    damping: float = 0.0        # to ground, Ns/m | Nms/rad
    names: tuple[str, str, str] = ('inertia', 'stiffness', 'damping')
    """Names of the three in the load's sheet."""


def fastest_rate(plant: np.record, load: LoadSide) -> float:
    """Return the largest magnitude of all eigenvalues, 1/s."""
    return max(float(np.abs(np.linalg.eigvals(matrix)).max())
               for matrix in matrices(plant, load))


def is_followed(plant: np.record, load: LoadSide) -> bool:
    """Return whether a step damps what the equations damp, in every linearised state."""
    return all(_damps(matrix) for matrix in matrices(plant, load))


def _damps(matrix: NDArray[np.float64]) -> bool:
    """Return whether RK4 damps all eigenvalues of the left half plane, |R(h lambda)| <= 1."""
    if not np.isfinite(matrix).all():
        return False
    z = PLANT_STEP * np.linalg.eigvals(matrix)
    growth = np.abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))))
    return bool(((growth <= 1.0 + _ROUNDED) | (z.real > _ROUNDED)).all())


class Parts(SimpleNamespace):
    """Sections of a `PLANT` record, read at once: a record takes half a us for each value."""

    def __init__(self, plant: np.record) -> None:
        super().__init__(**{name: _values(plant[name]) for name in (
            'coil', 'spool', 'chambers', 'mechanics', 'friction', 'spring', 'cushion_a',
            'cushion_b', 'hoses')})
        valve = plant['valve']
        self.shut, self.wide = _conductances(valve, 0.0), _conductances(
            valve, flow_curve(valve['x_max'], valve))


def _values(section: np.record) -> SimpleNamespace:
    """Return the values of a record that has no other ones in it."""
    return SimpleNamespace(**dict(zip(section.dtype.names or (), map(np.float64, section.item()))))


def matrices(plant: np.record, load: LoadSide) -> Iterator[NDArray[np.float64]]:
    """
    Yield those of the coil, the spool, and the actuator in each of its end stops.

    There the valve is shut, then wide open; where a cushion traps oil that has two more.
    """
    own = Parts(plant)
    yield _coil(own.coil)
    yield _spool(own.spool)
    for place in (0.0, own.chambers.stroke):
        for opening in (own.shut, own.wide):
            yield _actuator(own, load, place, opening)
        cushion = own.cushion_a if place == 0.0 else own.cushion_b
        if cushion.is_on:
            for is_open in (False, True):
                yield _trapped(own, load, place, is_open, cushion)


def _coil(coil: SimpleNamespace) -> NDArray[np.float64]:
    """Return d(i, m, m')/dt of V1 or V11."""
    if coil.kind != EXPLICIT:
        return np.array([[-coil.p_c]])
    w = coil.mode_w
    return np.array([
        [-coil.resistance / coil.inductance, 0.0, 0.0],
        [0.0, 0.0, 1.0], [w * w, -w * w, -2.0 * coil.mode_zeta * w]])


def _spool(spool: SimpleNamespace) -> NDArray[np.float64]:
    """Return d(x, x', x'')/dt of V3, V10 or V13."""
    w, zeta = spool.w_n, spool.zeta
    if spool.kind == DIRECT:
        return np.array([[0.0, 1.0], [-w * w, -2.0 * zeta * w]])
    k_loop = 0.0 if spool.kind == PILOTED else spool.k_loop
    return np.array([
        [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-w * w * k_loop, -w * w, -2.0 * zeta * w]])


def _actuator(
        plant: Parts, load: LoadSide, place: float,
        opening: tuple[float, float]) -> NDArray[np.float64]:
    """Return d(s, v, z, P_A, P_B, x, w)/dt in an end stop at ``place`` (M4, F3, C2)."""
    own, rubs, oil = plant.mechanics, plant.friction, plant.chambers
    m, per_load = own.inertia, 1.0 / load.inertia
    damping = rubs.sigma1 + rubs.sigma2 + own.d_s + own.d_stop
    per_a = oil.beta / (oil.dead_volume + oil.swept_a * place)
    per_b = oil.beta / (oil.dead_volume + oil.swept_b * (oil.stroke - place))
    open_a, open_b = opening
    open_a, open_b = min(open_a, FASTEST_RATE / per_a), min(open_b, FASTEST_RATE / per_b)
    if plant.hoses.is_on:   # through which a chamber decays at most at half of it  (C42)
        open_a, open_b = 0.5 * FASTEST_RATE / per_a, 0.5 * FASTEST_RATE / per_b
    spring, holds = plant.spring, oil.holds_b
    if holds == 0.0:
        open_b = FASTEST_RATE / per_b
    return np.array([
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [-(own.k_s + own.k_stop + spring.stiffness) / m, -damping / m, -rubs.sigma0 / m,
         oil.area_a / m, -oil.area_b / m, own.k_s / m, own.d_s / m],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, -per_a * oil.area_a, 0.0, -per_a * (oil.c_li + open_a), per_a * oil.c_li, 0.0, 0.0],
        [0.0, holds * per_b * oil.area_b, 0.0, holds * per_b * oil.c_li,
         -per_b * (oil.c_li + open_b), 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        [own.k_s * per_load, own.d_s * per_load, 0.0, 0.0, 0.0,
         -(own.k_s + load.stiffness) * per_load, -(own.d_s + load.damping) * per_load]])


def _trapped(
        plant: Parts, load: LoadSide, place: float, is_open: bool,
        cushion: SimpleNamespace) -> NDArray[np.float64]:
    """Return `_actuator` of shut lands with the pressure behind a spear as last state  (C30)."""
    oil, m = plant.chambers, plant.mechanics.inertia
    found = np.zeros((8, 8))
    found[:7, :7] = _actuator(plant, load, place, plant.shut)
    port, sign, area = (3, 1.0, oil.area_a) if place == 0.0 else (4, -1.0, oil.area_b)
    per, swept = oil.beta / cushion.dead, sign * cushion.area
    wide = oil.beta / (oil.dead_volume - cushion.dead)      # of the port's side
    found[port, :] *= wide * oil.dead_volume / oil.beta
    found[port, 1] = -wide * sign * (area - cushion.area)
    found[1, port] -= swept / m
    found[1, 7], found[7, 1] = swept / m, -per * swept
    link = FASTEST_RATE / (per + wide) if is_open else 0.0
    found[7, 7] = -per * link
    found[7, port] = per * link
    found[port, port] -= wide * link
    found[port, 7] = wide * link
    return found


def _conductances(valve: np.record, flow: float) -> tuple[float, float]:
    """Return at least dQ/dP of both chambers at no drop over their lands, m3/s/Pa  (V5, V7)."""
    per_flow = (2.0 * valve['q_0'] + flow) * valve['per_root_drop'] / math.sqrt(valve['delta'])
    return (max(valve['f_pa'], valve['f_at']) * per_flow,
            max(valve['f_pb'], valve['f_bt']) * per_flow)
