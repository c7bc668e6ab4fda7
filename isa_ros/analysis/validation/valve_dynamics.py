"""
Frequency response of the valves: figure 4.

From the plant's own rates: their linearisation about null for small signals, and the stepped
sine through the compiled plant, with the amplifier's voltage limit, at the 25 % of Table 1.
"""

from collections.abc import Callable
import math

from isa_ros.actuator_kernel import body_step, flat, scratch
from isa_ros.actuator_sheet import actuator_record
from isa_ros.analysis.validation.entry import around, at_least, Drawing, Entry, Findings
from isa_ros.analysis.validation.plots import stacked
from isa_ros.analysis.validation.sheets import model_sheet, plant_of
from isa_ros.paper.printed import cell, statement
from isa_ros.plant.plant import plant_rates, PLANT_STATE
from isa_ros.plant.units import MPA
from isa_ros.signals import LOAD_PORT
from isa_ros.timebase import PLANT_STEP
import numpy as np
from scipy.optimize import brentq

SUPPLY = statement('supply_pressure').number * MPA
ULLV = 'smart_manifold'
MINUS_3_DB = math.sqrt(0.5)
SMALL = 1e-6      # A, m, ...: far inside every limit
SETTLE = 0.05     # s, ten time constants of the spool loop and more
PERIODS = 4       # of the sine, that are looked at
STATES = ('current', 'spool', 'velocity', 'acceleration')
Response = Callable[[float], complex]


def valve_dynamics() -> Findings:
    """Compare the frequency response with figure 4 and Table 1, and draw it."""
    alone, behind = spool_over_current(ULLV), spool_over_reference(ULLV)
    input_25 = cell('table_1', '-3 dB bandwidth at 25% input', 'Moog ISA v5 valve')
    return Findings((
        Entry.of('ullv_eq_8_alone', statement('ullv_bandwidth'), bandwidth(alone),
                 around(114.1, by=1.0), 'eq 8 with the printed values gives 114.1 Hz',
                 reading='erratum 20: eq 8 does not give the 120 Hz it is fitted to'),
        Entry.of('ullv_eq_8_after_eq_10', statement('ullv_bandwidth'), bandwidth(behind),
                 (100.0, 120.0), 'greater than 100 Hz, around 120 Hz',
                 reading='erratum 20: 104.0 Hz with the pole of the current loop'),
        Entry.of('ullv_at_25_percent', input_25, bandwidth(stepped_sine(ULLV, 0.25)),
                 at_least(100.0), 'the printed bound',
                 reading='erratum 25: 25 % of +-10 mA at the amplifier'),
        Entry(name='ullv_static_gain', source='eq 9', paper='K_spool', ours=abs(behind(0.0)),
              unit='1', tolerance=around(1.0, by=1e-6),
              tolerance_source='the difference quotient of a linear equation'),
    ), (_drawing(alone, behind),))


def linearised(model: str) -> tuple[np.ndarray, np.ndarray]:
    """
    Return A (4, 4) and b (4,) of the `STATES` about null under the amplifier's drive.

    Currents are the amplifier's, A; the spool in m.
    """
    plant = plant_of(model)
    rows = np.zeros(2, PLANT_STATE).view(np.recarray)
    y, rates = rows[0], rows[1]

    def rate(state: np.ndarray, drive: float) -> np.ndarray:
        y.coil.current, y.valve.spool, y.valve.velocity, y.valve.acceleration = state
        plant_rates(y, 0.0, 0.0, drive, SUPPLY, 0.0, plant, rates)
        return np.array([rates.coil.current, rates.valve.spool, rates.valve.velocity,
                         rates.valve.acceleration])
    matrix = np.array([rate(SMALL * unit, 0.0) for unit in np.eye(4)]).T / SMALL
    return matrix, rate(np.zeros(4), SMALL) / SMALL


def spool_over_current(model: str) -> Response:
    """Return the response of the spool to the actual current, 1 at rest."""
    matrix, _ = linearised(model)
    return _response(model, matrix[1:, 1:], matrix[1:, 0])


def spool_over_reference(model: str) -> Response:
    """Return the response of the spool to the amplifier's current reference, 1 at rest."""
    return _response(model, *linearised(model))


def _response(model: str, matrix: np.ndarray, column: np.ndarray) -> Response:
    plant = plant_of(model)
    spool = len(column) - 3
    scale = plant.coil.parallel / plant.valve.k_spool  # A at the amplifier per m

    def response(hz: float) -> complex:
        s = 2j * math.pi * hz * np.eye(len(column))
        # least squares: a state that a valve does not use leaves an empty row at rest
        solution = np.linalg.lstsq(s - matrix, column.astype(complex), rcond=None)[0]
        return complex(scale * solution[spool])
    return response


def stepped_sine(model: str, share: float) -> Response:
    """Return the spool's response to a sine of ``share`` of the full current, 1 at rest."""
    plant = plant_of(model)
    scale = plant.coil.parallel / plant.valve.k_spool
    amplitude = share * plant.valve.x_max * scale

    def response(hz: float) -> complex:
        n_period = round(1.0 / (hz * PLANT_STEP))
        settle = math.ceil(SETTLE / (n_period * PLANT_STEP)) * n_period
        n = settle + PERIODS * n_period
        phase = 2.0 * math.pi * np.arange(n) / n_period
        spool = driven(model, amplitude * np.sin(phase))[settle:]
        # the fundamental over whole periods
        return complex(2.0j * np.mean(spool * np.exp(-1j * phase[settle:])) * scale / amplitude)
    return response


def driven(model: str, drive: np.ndarray) -> np.ndarray:
    """Return the spool (m) after each plant step under the amplifier's reference (A), (n,)."""
    constants = actuator_record(model_sheet(model), 0)
    port = np.zeros(1, LOAD_PORT)
    port['supply_pressure'] = SUPPLY
    bodies, rates = scratch()
    bodies['plant']['chambers']['p_a'] = bodies['plant']['chambers']['p_b'] = 0.5 * SUPPLY
    arguments = port[0], constants[0], bodies, rates, flat(bodies), flat(rates)
    spool = np.empty(len(drive))
    for k, current in enumerate(drive):
        body_step(PLANT_STEP, 0.0, current, *arguments)
        spool[k] = bodies['plant']['valve']['spool'][0]
    return spool


def bandwidth(response: Response) -> float:
    """Return the frequency (Hz) between 1 and 1000 Hz at which the gain is -3 dB."""
    return float(brentq(lambda hz: abs(response(hz)) - MINUS_3_DB, 1.0, 1000.0, xtol=0.05))


def _drawing(alone: Response, behind: Response) -> Drawing:
    figure, (gain, phase) = stacked('frequency, Hz', 'spool over current, dB', 'phase, deg')
    hz = np.geomspace(1.0, 1000.0, 200)
    for response, label, style in (
            (alone, 'ULLV, actual current', '-'), (behind, 'ULLV, current reference', '--')):
        values = np.array([response(float(f)) for f in hz])
        gain.semilogx(hz, 20.0 * np.log10(np.abs(values)), 'k', linestyle=style, label=label)
        phase.semilogx(hz, np.degrees(np.unwrap(np.angle(values))), 'k', linestyle=style)
    gain.axhline(-3.0, color='gray', linewidth=0.8, linestyle=':')
    gain.set_ylim(-30.0, 3.0)
    gain.legend(loc='lower left')
    return Drawing(
        'fig_4', 'Frequency response of the valves for small signals, as Fig 4.', figure)
