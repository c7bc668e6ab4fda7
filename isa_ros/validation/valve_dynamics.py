"""
Frequency response of the valves: figure 4.

From the plant's own rates, linearised about null, for small signals; from a stepped sine
through control blocks and plant, with every limit, for the 25 % of Table 1 and for the spool
loop of the electric-feedback valve, which only exists sampled.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
import math

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.analysis.response.actuator_trace import PERIOD_NS, RATE_HZ, setpoints
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_PORT
from isa_ros.core.units import MPA
from isa_ros.paper.printed import cell, statement
from isa_ros.plant.energy import no_powers
from isa_ros.plant.plant import PLANT_STATE
from isa_ros.plant.rates import plant_rates
from isa_ros.validation.entry import (
    around, as_printed, at_least, Drawing, Entry, Findings, INPUT, OWN)
from isa_ros.validation.plots import stacked
from isa_ros.validation.sheets import model_sheet, plant_of
import numpy as np
from scipy.optimize import brentq

SUPPLY = statement('supply_pressure').number * MPA
ULLV = 'smart_manifold'
ISA_V5 = 'isa_v5'
HRV = 'isa_v2'
MINUS_3_DB = math.sqrt(0.5)
SMALL = 1e-6      # A, m, ...: far inside every limit
SMALL_SPOOL = 5e-6    # m, 40 steps of the spool sensor, far inside every limit
FULL_CURRENT = 5e-3   # A, coils in series
SETTLE = 0.05     # s, ten time constants of the spool loop and more
PERIODS = 4       # of the sine, that are evaluated
STATES = ('current', 'spool', 'velocity', 'acceleration')
Response = Callable[[float], complex]


def valve_dynamics() -> Findings:
    """Compare the frequency response with figure 4 and Table 1, and draw it."""
    alone, behind = spool_over_current(ULLV), spool_over_reference(ULLV)
    fast = spool_over_current(HRV)
    input_25 = cell('table_1', '-3 dB bandwidth at 25% input', 'Moog ISA v5 valve')
    return Findings((
        Entry.given('ullv_eq_8_alone', statement('ullv_bandwidth'), bandwidth(alone),
                    around(114.1, by=1.0), 'eq 8 with the printed values gives 114.1 Hz',
                    reading='erratum 20: eq 8 does not give the 120 Hz it is fitted to'),
        Entry.given('ullv_eq_8_after_eq_10', statement('ullv_bandwidth'), bandwidth(behind),
                    around(104.0, by=0.5), 'eqs 8 and 10 with the printed values give 104.0 Hz',
                    reading='erratum 20: 104.0 Hz with the pole of the current loop'),
        Entry.of('ullv_at_25_percent', input_25, bandwidth(stepped_sine(
                     model_sheet(ULLV, 'valve_amplifier'), 0.25 * FULL_CURRENT)),
                 at_least(100.0), 'the printed bound',
                 reading='erratum 25: 25 % of +-10 mA at the amplifier'),
        Entry(name='ullv_sampled_spool_loop', source=OWN, where='section 2.2',
              paper='greater than 100 Hz', unit='Hz',
              ours=bandwidth(stepped_sine(sampled_spool_loop(), SMALL_SPOOL)),
              tolerance=(140.0, 165.0),
              tolerance_source='K_p K_pilot = 540 /s around the pole of eq 10, by another model',
              reading='erratum 10: eq 8 without its loop, and that loop in the REU'),
        Entry(name='ullv_static_gain', source=INPUT, where='eq 9', paper='K_spool',
              ours=abs(behind(0.0)), unit='1', tolerance=around(1.0, by=1e-6),
              tolerance_source='the difference quotient of a linear equation'),
        Entry.given('hrv_bandwidth', statement('hrv_bandwidth'), bandwidth(fast),
                    around(320.0, by=5.0), 'around: half of its last significant digit',
                    reading='erratum 19: against the actual current'),
        *_parameters(),
    ), (_drawing((
        (fast, 'HRV, actual current', 'b-'), (alone, 'ULLV, actual current', 'k-'),
        (behind, 'ULLV, current reference', 'k--'))),))


def _parameters() -> tuple[Entry, ...]:
    """Return the parameters of eqs 8 and 10, from the plant's rates about null."""
    entries = []
    for model in (ULLV, ISA_V5):
        matrix, _ = linearised(model)
        frequency = math.sqrt(-matrix[3, 2])
        for statement_name, ours in (
                ('current_pole', -matrix[0, 0]), ('loop_gain', matrix[3, 1] / matrix[3, 2]),
                ('spool_frequency', frequency),
                ('spool_damping', -0.5 * matrix[3, 3] / frequency)):
            printed = statement(statement_name)
            entries.append(Entry.given(
                f'{model}_{statement_name}', printed, float(ours), as_printed(printed),
                'half of the last printed digit'))
    return tuple(entries)


def linearised(model: str) -> tuple[np.ndarray, np.ndarray]:
    """
    Return A (4, 4) and b (4,) of the `STATES` about null under the amplifier's drive.

    Currents are the amplifier's, A; the spool in m.
    """
    plant = plant_of(model)
    rows = rows_of(2, PLANT_STATE)
    y, rates = rows[0], rows[1]

    def rate(state: np.ndarray, drive: float) -> np.ndarray:
        y.coil.current, y.spool.position, y.spool.velocity, y.spool.acceleration = state
        plant_rates(
            y, 0.0, 0.0, drive, SUPPLY, 0.0, plant, False, rates, False, no_powers())
        return np.array([rates.coil.current, rates.spool.position, rates.spool.velocity,
                         rates.spool.acceleration])
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


def stepped_sine(sheet: ActuatorSheet, amplitude: float) -> Response:
    """
    Return the spool's response to its reference, measured with a sine.

    The outer blocks of ``sheet`` are off; ``amplitude`` has the unit of its effort: m of
    spool, or series-scale A.
    """
    def response(hz: float) -> complex:
        n_period = round(RATE_HZ / hz)
        n = (math.ceil(SETTLE * RATE_HZ / n_period) + PERIODS) * n_period
        phase = 2.0 * math.pi * np.arange(n) / n_period
        trace = driven(sheet, amplitude * np.sin(phase))[-PERIODS * n_period:]
        spin = np.exp(-1j * phase[:PERIODS * n_period])  # the fundamental over whole periods
        return complex(np.mean(trace['spool'] * spin) / np.mean(trace['spool_reference'] * spin))
    return response


def driven(sheet: ActuatorSheet, efforts: np.ndarray) -> np.ndarray:
    """Return the `STATES` of an actuator at mid stroke before each effort, one every 100 us."""
    base = default_actuator(ULLV if sheet.is_rotary else ISA_V5, 'driven')
    config = replace(base, sheet=sheet, initial_position=0.5 * sheet.plant.drive.stroke)
    group = ActuatorGroup([config], replace(DEFAULT_TIMING, step_ns=PERIOD_NS))
    ports = np.zeros(1, LOAD_PORT)
    ports['supply_pressure'] = PAPER_SUPPLY
    log = group.advance_many(ports, setpoints(group, 'effort', efforts), with_samples=False)
    return log.states[:-1, 0]


def sampled_spool_loop() -> ActuatorSheet:
    """Return the ISA v5 with its spool loop in the REU, around the pole of the current loop."""
    sheet, closed = model_sheet(ISA_V5, 'valve_amplifier', 'explicit'), model_sheet(ISA_V5)
    return replace(sheet, plant=replace(sheet.plant, coil=closed.plant.coil),
                   reu=replace(sheet.reu, current=closed.reu.current))


def bandwidth(response: Response) -> float:
    """Return the frequency (Hz) between 1 and 1000 Hz at which the gain is -3 dB."""
    return float(brentq(lambda hz: abs(response(hz)) - MINUS_3_DB, 1.0, 1000.0, xtol=0.05))


def _drawing(curves: Sequence[tuple[Response, str, str]]) -> Drawing:
    figure, (gain, phase) = stacked('frequency, Hz', 'spool over current, dB', 'phase, deg')
    hz = np.geomspace(1.0, 1000.0, 200)
    for response, label, style in curves:
        values = np.array([response(float(f)) for f in hz])
        gain.semilogx(hz, 20.0 * np.log10(np.abs(values)), style, label=label)
        phase.semilogx(hz, np.degrees(np.unwrap(np.angle(values))), style)
    gain.axhline(-3.0, color='gray', linewidth=0.8, linestyle=':')
    gain.set_ylim(-30.0, 3.0)
    gain.legend(loc='lower left')
    return Drawing(
        'fig_4', 'Frequency response of the valves for small signals, as Fig 4.', figure)
