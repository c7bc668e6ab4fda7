"""
The data of the actuators: tables 2, 3 and 5, as results of the plant's equations.

Pressures, volumes and forces are computed by the kernels, which reveals wrong conversions.
"""

import math

from isa_ros.core.units import LPM, MILLI, MILLILITRE, MPA
from isa_ros.paper.printed import cell, statement
from isa_ros.plant.chambers import hydraulic_force, pressure_rates, volumes
from isa_ros.plant.friction import stribeck
from isa_ros.plant.relief import relief_flow
from isa_ros.plant.sensors import convert, encode
from isa_ros.plant.thermal import LumpedThermal
from isa_ros.validation.entry import around, as_printed, Entry, Findings, INPUT
from isa_ros.validation.sheets import model_sheet, plant_of
import numpy as np
from scipy.optimize import brentq

SUPPLY = statement('supply_pressure').number * MPA
ROTARY = 'smart_manifold'
LEAK_TEST = 20.0 * MPA  # Table 5: 200 bar
ROUNDED = 'half of the last printed digit'
AREAS = '0.5 %: the dimensions are printed to 0.5 mm or three digits'
HEAT_CAPACITY = 600.0   # J/(kg K), assumed for the bodies (variant `thermal`)
CAPACITY_DIGIT = 5.0    # J/K, half of the last digit of the least one
RATING = 'erratum 15: the paper prints a rating; P_S over the piston gives more'


def actuator_data() -> Findings:
    """Compare dimensions, stall, oil, friction, relief, sensors and weights."""
    return Findings((
        *_rotary(), *_linear('isa_v2', 'ISA v2'), *_linear('isa_v5', 'ISA v5'), *_oil(),
        *_friction(), *_reliefs(), *_sensors(), *_weights()))


def stall(model: str, direction: float) -> float:
    """Return the hydraulic force or torque with the supply on one side only, N or Nm."""
    p_a, p_b = (SUPPLY, 0.0) if direction > 0.0 else (0.0, SUPPLY)
    return float(hydraulic_force(p_a, p_b, plant_of(model).chambers))


def _rotary() -> list[Entry]:
    oil = plant_of(ROTARY).chambers
    displacement, angle = cell('table_5', 'D_m', 'Value'), cell('table_5', 'L_m', 'Value')
    swept = volumes(oil.stroke, oil)[0] - volumes(0.0, oil)[0]
    torque = displacement.number * SUPPLY
    table_2 = cell('table_2', 'Vol. displacement', 'Smart manifold')
    return [
        Entry.given('manifold_displacement', displacement, swept / oil.stroke,
                    as_printed(displacement), ROUNDED),
        Entry.given('manifold_displacement_per_deg', table_2,
                    math.radians(swept / oil.stroke) / MILLILITRE,
                    as_printed(table_2), ROUNDED),
        Entry.given('manifold_range', angle, oil.stroke, as_printed(angle), ROUNDED),
        Entry.given('manifold_range_deg', cell('table_2', 'Total stroke', 'Smart manifold'),
                    math.degrees(oil.stroke), around(100.0, by=0.5), ROUNDED),
        Entry.given('manifold_stall', cell('table_2', 'Stall load', 'Smart manifold'),
                    stall(ROTARY, 1.0), around(torque, percent=0.5), AREAS, reading=RATING),
        Entry(name='manifold_total_volume', source=INPUT, where='eqs 3, 4, 22, 23',
              paper='2 V_p + D_m L_m', ours=sum(volumes(0.3 * oil.stroke, oil)) / MILLILITRE,
              unit='ml', tolerance=around(
                  2.0 * cell('table_5', 'V_p', 'Value').number
                  + torque / SUPPLY * angle.number / MILLILITRE, percent=0.1),
              tolerance_source='D_m and L_m are printed to three and four digits',
              reading='erratum 16: the swept volume counts once'),
    ]


def _linear(model: str, column: str) -> list[Entry]:
    rating = cell('table_2', 'Stall load', column)
    bore = cell('table_2', 'Cylinder bore diameter', column).number * MILLI
    rod = cell('table_2', 'Rod diameter', column).number * MILLI
    out = math.pi / 4.0 * bore * bore * SUPPLY
    back = math.pi / 4.0 * (bore * bore - rod * rod) * SUPPLY
    oil = plant_of(model).chambers
    stroke = cell('table_2', 'Total stroke', column)
    return [
        Entry.given(f'{model}_stroke', stroke, oil.stroke / MILLI,
                    as_printed(stroke), ROUNDED),
        Entry.given(f'{model}_stall_out', rating, stall(model, 1.0), around(out, percent=0.5),
                    AREAS, reading=RATING),
        Entry(name=f'{model}_stall_back', source=INPUT, where=f'{rating.where}, eq 5',
              paper='one value for both directions', ours=-stall(model, -1.0), unit='N',
              tolerance=around(back, percent=0.5), tolerance_source=AREAS,
              reading='erratum 15: the rod takes its share when retracting'),
    ]


def _oil() -> list[Entry]:
    oil = plant_of(ROTARY).chambers
    leak, dead = cell('table_5', 'C_li', 'Value'), cell('table_5', 'V_p', 'Value')
    modulus = cell('table_5', 'beta_eff', 'Value')
    v_a = volumes(0.5 * oil.stroke, oil)[0]

    def rate(flow: float, p_a: float) -> float:
        return float(pressure_rates(flow, 0.0, p_a, 0.0, 0.5 * oil.stroke, 0.0, oil)[0])
    beta = rate(LPM, 0.0) * v_a / LPM
    return [
        Entry.given('manifold_bulk_modulus', modulus, beta,
                    around(modulus.number, percent=7.0), 'half of its one printed digit'),
        Entry.given('manifold_dead_volume', dead, volumes(0.0, oil)[0] / MILLILITRE,
                    as_printed(dead), ROUNDED),
        Entry.given('manifold_cross_port_leakage', leak,
                    -rate(0.0, LEAK_TEST) * v_a / beta / LPM, as_printed(leak), ROUNDED,
                    reading='erratum 21: C_li = 1.833e-13 m3/s/Pa'),
    ]


def _friction() -> list[Entry]:
    friction = plant_of(ROTARY).friction
    fast = 10.0 * friction.v_s
    return [
        Entry.given('manifold_stiction', statement('stiction'), float(stribeck(0.0, friction)),
                    around(2.0, by=0.05),
                    'half of the digits the Coulomb level is printed with'),
        Entry.given('manifold_coulomb', statement('coulomb_friction'),
                    float(stribeck(fast, friction)), around(1.9, by=0.05), ROUNDED),
    ]


def _reliefs() -> list[Entry]:
    limit = statement('relief_pressure')
    entries = []
    for model in (ROTARY, 'isa_v2', 'isa_v5'):
        relief = plant_of(model).relief
        trickle = 1e-3 * LPM
        opens = brentq(lambda p: relief_flow(p, 0.0, relief) - trickle, 1.0 * MPA, 40.0 * MPA)
        entries.append(Entry.given(
            f'{model}_relief_opens', limit, opens / MPA, around(limit.number, by=0.5), ROUNDED))
    return entries


def _sensors() -> list[Entry]:
    entries = []
    for model, column in (('isa_v5', 'ISA'), (ROTARY, 'Smart manifold')):
        own = plant_of(model).sensors
        bits = cell('table_3', 'ADC resolution', column)
        encoder = cell('table_3', 'Encoder resolution', column)
        to_printed = math.degrees(1.0) if model == ROTARY else 1e6
        forces = np.linspace(-2.0 * own.force_range, 2.0 * own.force_range, 100_001)
        codes = len({convert(f, -own.force_range, own.force_range, own.force_step)
                     for f in forces})
        entries += [
            Entry.given(f'{model}_adc', bits, math.log2(codes), around(bits.number), 'exact'),
            Entry.given(f'{model}_encoder', encoder, _least_step(own.encoder) * to_printed,
                        around(encoder.number, by=0.05 * encoder.number),
                        '5 %: half of its last printed digit or less'),
        ]
    rate = cell('table_3', 'Sensor sampling frequency', 'ISA')
    return [*entries, Entry.given(
        'isa_v5_sampling', rate, model_sheet('isa_v5').reu.current.rate_hz * 1e-3,
        around(rate.number, by=0.5), ROUNDED)]


def _weights() -> list[Entry]:
    """Read the weights back from the heat capacities of the bodies, where alone they act."""
    entries = []
    for model, column in (('isa_v2', 'ISA v2'), ('isa_v5', 'ISA v5'), (ROTARY, 'Smart manifold')):
        weight, heated = cell('table_2', 'Dry weight', column), model_sheet(model, 'thermal')
        assert isinstance(heated.plant.thermal, LumpedThermal)
        entries.append(Entry.given(
            f'{model}_dry_weight', weight,
            heated.plant.thermal.body_heat_capacity / HEAT_CAPACITY / MILLI,
            around(weight.number, by=CAPACITY_DIGIT / HEAT_CAPACITY / MILLI),
            f'half of the last digit of 550 J/K, at {HEAT_CAPACITY:g} J/(kg K)'))
    return entries


def _least_step(resolution: float) -> float:
    """Return the smallest change of the encoder's reading over a hundred counts."""
    places = np.linspace(0.0, 100.0 * resolution, 10_001)
    values = np.array([encode(place, resolution) for place in places])
    steps = np.diff(values)
    return float(steps[steps > 0.0].min())
