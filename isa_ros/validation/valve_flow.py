"""
Flow gain of the valves: figure 5.

The flow of one land at 3.5 MPa against the current with both coils in series.
"""

import math

from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.paper.printed import cell, statement
from isa_ros.plant.servo_valve import flow_curve, port_flows
from isa_ros.validation.entry import around, as_printed, Drawing, Entry, Findings, INPUT
from isa_ros.validation.plots import stacked
from isa_ros.validation.sheets import plant_of
import numpy as np
from scipy.optimize import brentq

SUPPLY = statement('supply_pressure').number * MPA
LAND_DROP = 3.5 * MPA   # half of the 7 MPa of Table 1, erratum 2
FULL_CURRENT = 5.0      # mA, coils in series
ULLV = 'smart_manifold'  # equal slots: every land as printed
ISA_V5 = 'isa_v5'        # the same valve, slots matched to its piston
HRV = 'isa_v2'
VALVES = ((HRV, 'HRV', 'blue'), (ULLV, 'ULLV', 'black'))  # colours of the paper
LINE = '1 %, less than half of the last printed digit'
SLOPES = '0.4 l/min/mA to 1.2 mA, 2.5 l/min/mA beyond'   # of the ULLV, Fig 5 caption
CURRENT = 'current, coils in series, mA'
ROUNDED = 'half of the last printed digit'


def valve_flow() -> Findings:
    """Compare the flow curves with figure 5, and draw them."""
    return Findings(
        (*_flows(), *_slopes(), *_high_response(), _speed_ratio()), (_drawing(),))


def spool_at(current: float, valve: np.record) -> float:
    """Return the spool position in m at a current in mA, coils in series."""
    return float(np.clip(current * MILLI * valve.k_spool, -valve.x_max, valve.x_max))


def net_flow(current: float, model: str) -> float:
    """Return the flow of one land at `LAND_DROP` into chamber A, l/min; ``current`` in mA."""
    valve = plant_of(model).valve
    flows = port_flows(
        spool_at(current, valve), LAND_DROP, LAND_DROP, 2.0 * LAND_DROP, 0.0, valve)
    return float(flows[0] / LPM)


def _flows() -> list[Entry]:
    low, high = statement('ullv_low_gain').number, statement('ullv_high_gain').number
    bend = statement('ullv_gain_change').number
    full = low * bend + high * (FULL_CURRENT - bend)

    def point(name: str, current: float, flow: float) -> Entry:
        return Entry(
            name=name, source=INPUT, where='Fig 5 caption', paper=SLOPES,
            ours=net_flow(current, ULLV), unit='l/min', tolerance=around(flow, percent=1.0),
            tolerance_source=f'{flow:g} l/min by these slopes; {LINE}',
            reading='erratum 3: the two gains are slopes of one continuous curve')
    return [
        point('ullv_flow_1_ma', 1.0, low),
        point('ullv_flow_2_ma', 2.0, low * bend + high * (2.0 - bend)),
        Entry.given('ullv_rated_flow', cell('table_1', 'Rated flow at 7 MPa', 'Moog ISA v5 valve'),
                    net_flow(FULL_CURRENT, ULLV), around(full, percent=1.0),
                    f'{full:g} l/min at 5 mA by the slopes of Fig 5; {LINE}',
                    reading='erratum 5: by Fig 5 7.48 l/min pass at 4 mA already'),
        Entry(name='ullv_flow_is_odd', source=INPUT, where='Fig 5 caption',
              paper='+-2.5 l/min/mA: the same in both directions',
              ours=net_flow(-FULL_CURRENT, ULLV) / net_flow(FULL_CURRENT, ULLV), unit='1',
              tolerance=around(-1.0, by=0.01), tolerance_source=LINE)]


def _slopes() -> list[Entry]:
    valve = plant_of(ULLV).valve
    milliampere = MILLI * valve.k_spool  # m of spool
    below, above = valve.x_dg, math.nextafter(valve.x_dg, 1.0)
    jump = flow_curve(above, valve) - flow_curve(below, valve)
    # the slope over the gap of two neighbouring floats, and two roundings of the flow itself
    rounding = 2.0 * float(np.finfo(float).eps) * flow_curve(below, valve)
    gap = float(valve.k_high * (above - below) + rounding) / LPM
    slope = 'erratum 1: the slope of Fig 5 per mA'

    def per_ma(first: float) -> float:
        return float(flow_curve((first + 1.0) * milliampere, valve)
                     - flow_curve(first * milliampere, valve))
    return [
        Entry.given('ullv_k_v_low', statement('low_valve_gain'), per_ma(0.0),
                    as_printed(statement('low_valve_gain')), ROUNDED, reading=slope),
        Entry.given('ullv_k_v_high', statement('high_valve_gain'), per_ma(2.0),
                    as_printed(statement('high_valve_gain')), ROUNDED, reading=slope),
        Entry(name='ullv_jump_at_x_dg', source=INPUT, where='eq 19, Fig 5 caption',
              paper='gains inside and outside of +-1.2 mA',
              ours=float(jump) / LPM, unit='l/min', tolerance=(0.0, gap),
              tolerance_source='two neighbouring floating-point numbers',
              reading='erratum 3: eq 19 with eq 11 would jump from 0.48 to 3.00 l/min'),
        Entry.given('ullv_gain_change', statement('ullv_gain_change'), valve.x_dg / milliampere,
                    around(1.2, by=0.05), ROUNDED,
                    reading='erratum 4: x_dg / K_spool on the scale of coils in series'),
        Entry.given('ullv_high_gain_stroke', statement('high_gain_stroke'),
                    100.0 * valve.x_dg / valve.x_max, as_printed(statement('high_gain_stroke')),
                    'where the high gain begins; half of the last printed digit',
                    reason='the 1.2 of 5 mA of Fig 5, and x_dg over K_spool 5 mA, are 24 %'),
        Entry.given('amplifier_current', statement('current_range'),
                    valve.x_max / milliampere * plant_of(ULLV).coil.parallel,
                    around(10.0, by=0.5), ROUNDED,
                    reading='erratum 4: the amplifier drives the coils in parallel'),
    ]


def _high_response() -> list[Entry]:
    gain, end = statement('hrv_flow_gain'), statement('hrv_gain_end')
    per_ma = gain.number
    steps = np.linspace(0.1, FULL_CURRENT, 491)
    gains = np.gradient([net_flow(float(i), HRV) for i in steps], steps)
    falls = float(steps[np.argmax(gains < 0.95 * per_ma)])
    return [
        Entry.given('hrv_flow_gain', gain, net_flow(1.5, HRV) - net_flow(0.5, HRV),
                    around(per_ma, percent=1.0), LINE),
        Entry(name='hrv_flow_2_ma', source=INPUT, where=gain.where,
              paper='2.3 l/min/mA until near 2 mA', ours=net_flow(2.0, HRV), unit='l/min',
              tolerance=around(2.0 * per_ma, percent=1.0),
              tolerance_source=f'{2.0 * per_ma:g} l/min by this slope; {LINE}'),
        Entry.given('hrv_gain_falls', end, falls, around(end.number, by=0.25),
                    'near, one printed digit: a gain lower by 5 % within a quarter of a mA'),
        Entry(name='hrv_gain_at_5_ma', source=INPUT, where=gain.where,
              paper='starts decreasing',
              ours=float(gains[-1]), unit='l/min/mA', tolerance=(0.0, 0.9 * per_ma),
              tolerance_source='less than near null: by a tenth or more'),
    ]


def no_load_speed(current: float, model: str) -> float:
    """Return the steady speed without load or friction, m/s or rad/s; ``current`` in mA."""
    plant = plant_of(model)
    spool, oil = spool_at(current, plant.valve), plant.chambers

    def imbalance(p_a: float) -> float:
        q_a, q_b, _, _ = port_flows(
            spool, p_a, p_a * oil.area_a / oil.area_b, SUPPLY, 0.0, plant.valve)
        return float(q_a / oil.area_a + q_b / oil.area_b)
    p_a = brentq(imbalance, 0.0, SUPPLY * oil.area_b / oil.area_a)
    flows = port_flows(spool, p_a, p_a * oil.area_a / oil.area_b, SUPPLY, 0.0, plant.valve)
    return float(flows[0] / oil.area_a)


def _speed_ratio() -> Entry:
    ratio = -no_load_speed(FULL_CURRENT, ISA_V5) / no_load_speed(-FULL_CURRENT, ISA_V5)
    return Entry.given(
        'isa_v5_speed_ratio', statement('speed_ratio'), ratio, around(1.0, by=0.005),
        '1, to 0.25 % smoothing of the orifices at 1 MPa and 0.2 % leakage', unit='1',
        reading='erratum 18: slots matched to the area ratio alone would give 0.830')


def _drawing() -> Drawing:
    figure, (ax,) = stacked(CURRENT, 'flow of one land at 3.5 MPa, l/min')
    currents = np.linspace(-FULL_CURRENT, FULL_CURRENT, 401)
    for model, label, color in VALVES:
        ax.plot(currents, [net_flow(float(i), model) for i in currents], color, label=label)
    ax.legend(loc='upper left')
    return Drawing(
        'fig_5', 'Flow gain of the valves over the current with the coils in series, as Fig 5.',
        figure)
