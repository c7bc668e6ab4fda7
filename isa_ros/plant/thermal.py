"""
Temperature of one actuator: two heat capacities, its oil and its body, heated by the losses.

The oil that flows in has the supply's temperature, the oil that flows out that of the actuator.
Valve, leakage and relief heat the oil; seals, stops and coils heat the body, which gives heat to
the air. The temperatures are constant during a tick, so that the equations of heat are linear
and solved exactly (T6). Neglected: heat of compression, and the oil of both chambers being more
or less than at mid stroke.
"""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.oil_properties import (
    MineralOil, PROPERTIES, properties_record, softness, thickness)
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.phi import phi_1, phi_2
from isa_ros.core.record import record
from isa_ros.plant.hose import warm_hoses
import numpy as np


@frozen(kw_only=True)
class NoneThermal(Parameters):
    """Oil at plant.oil.temperature_celsius, whatever the losses."""


@frozen(kw_only=True)
class LumpedThermal(Parameters):
    """Oil and body as two heat capacities; viscosity and compressibility follow the oil's."""

    start_celsius: float = parameter('of oil and body at t = 0', 'celsius', ge=-30.0, le=80.0)
    supply_celsius: float = parameter('of the oil that flows in', 'celsius', ge=-30.0, le=80.0)
    ambient_celsius: float = parameter('of the air', 'celsius', ge=-30.0, le=80.0)
    body_heat_capacity: float = parameter('C_b, of the body', 'J/K', ge=1.0, le=1e6)
    oil_to_body: float = parameter('G_ob, heat transfer', 'W/K', ge=1e-3, le=1e5)
    body_to_air: float = parameter('G_ba, heat transfer', 'W/K', ge=0.0, le=1e5)
    laminar_share: float = parameter(
        'of the leakage of the lands, at plant.oil.temperature_celsius', '1', ge=0.0, le=1.0)
    oil: MineralOil


THERMAL = np.dtype([
    ('is_on', 'f8'),
    ('oil_capacity', 'f8'), ('body_capacity', 'f8'),            # J/K
    ('oil_to_body', 'f8'), ('body_to_air', 'f8'),               # W/K
    ('per_volume', 'f8'),                                       # rho c, J/(m3 K)
    ('start', 'f8'), ('supply', 'f8'), ('ambient', 'f8'),       # celsius
    ('laminar_share', 'f8'),
    ('bias_per_k', 'f8'),                                       # A/K, b_theta of V12
    ('oil', PROPERTIES),
    # The values of the sheet:
    ('c_li', 'f8'), ('q_0', 'f8'), ('beta', 'f8'), ('sigma2', 'f8'), ('bias', 'f8'),
])
THERMAL_STATE = np.dtype([
    ('oil', 'f8'), ('body', 'f8'),      # celsius
    ('heat', 'f8'),         # of the losses, J
    ('to_oil', 'f8'),       # carried away by the oil that flowed through, J
    ('to_air', 'f8'),       # given to the air, J
    ('coil', 'f8'),         # heat of the coils since the begin of the tick, J
    ('sensed', 'f8'),       # last reading of the oil's temperature, celsius
])
"""Temperatures, and the heat since t = 0 but for that of the coils."""


def thermal_record(
        sheet: NoneThermal | LumpedThermal, celsius: float, bias_per_k: float,
        chambers: np.record, valve: np.record, friction: np.record,
        spool: np.record) -> np.record:
    """
    Return the `THERMAL` record of a plant whose sheet holds at a temperature of the oil.

    The records are those of the plant, ``bias_per_k`` (A/K) is the shift of its null; an actuator
    of constant temperature has zeros, and the temperature.
    """
    at_sheet = {'c_li': chambers.c_li, 'q_0': valve.q_0, 'beta': chambers.beta,
                'sigma2': friction.sigma2, 'bias': spool.bias, 'bias_per_k': bias_per_k}
    if isinstance(sheet, NoneThermal):
        return record(
            THERMAL, is_on=0.0, oil_capacity=0.0, body_capacity=0.0, oil_to_body=0.0,
            body_to_air=0.0, per_volume=0.0, start=celsius, supply=celsius, ambient=celsius,
            laminar_share=0.0, oil=record(
                PROPERTIES, a=0.0, b=0.0, celsius=celsius, viscosity=1.0, per_k=0.0), **at_sheet)
    per_volume = sheet.oil.density * sheet.oil.specific_heat
    volume = (2.0 * chambers.dead_volume
              + 0.5 * (chambers.area_a + chambers.area_b) * chambers.stroke)
    return record(
        THERMAL, is_on=1.0, oil_capacity=per_volume * volume,
        body_capacity=sheet.body_heat_capacity, oil_to_body=sheet.oil_to_body,
        body_to_air=sheet.body_to_air, per_volume=per_volume, start=sheet.start_celsius,
        supply=sheet.supply_celsius, ambient=sheet.ambient_celsius,
        laminar_share=sheet.laminar_share, oil=properties_record(sheet.oil, celsius), **at_sheet)


def coldest(thermal: np.record) -> float:
    """Return the least temperature (celsius) of a `THERMAL` record: losses only add to it."""
    return float(min(thermal.start, thermal.supply, thermal.ambient))


@kernel
def warm(celsius, plant):
    """
    Let oil of a temperature act on a `PLANT`: leakage, friction, bulk modulus, null  (T3).

    C_li nu_0/nu, l (1 + c (nu_0/nu - 1)) with the laminar share c, sigma_2 nu/nu_0, beta over
    `softness`, and the null bias of V12. At the sheet's temperature all are those of the sheet.
    """
    own = plant.thermal
    thicker = thickness(celsius, own.oil)
    plant.chambers.c_li = own.c_li / thicker
    plant.valve.leak_factor = 1.0 + own.laminar_share * (1.0 / thicker - 1.0)
    plant.valve.q_0 = own.q_0 * plant.valve.leak_factor
    plant.friction.sigma2 = own.sigma2 * thicker
    plant.chambers.beta = own.beta / softness(celsius, own.oil)
    if plant.hoses.is_on > 0.0:
        warm_hoses(thicker, plant.chambers.beta, plant.hoses)
    plant.spool.bias = own.bias + own.bias_per_k * (celsius - own.oil.celsius)


@kernel
def heat(h, oil_heat, body_heat, inflow, supply, thermal, state):
    """
    Advance the temperatures by ``h`` s: losses in J, oil that flows in in m3  (T4, T5, T6).

    ``supply`` is the temperature of the oil that flows in, celsius. Return the heat that the oil
    which flowed through took along, J.
    The change is h phi_1(h A) f and the integral of the temperatures h x + h^2 phi_2(h A) f, f the
    rates at the start and A their matrix; both eigenvalues of A are real and not positive, and
    they differ because ``oil_to_body`` is positive.
    """
    through = thermal.per_volume * inflow / h
    inner, outer = thermal.oil_to_body, thermal.body_to_air
    c_oil, c_body = thermal.oil_capacity, thermal.body_capacity
    oil, body = state.oil, state.body
    f_oil = (oil_heat / h + through * (supply - oil) + inner * (body - oil)) / c_oil
    f_body = (body_heat / h + inner * (oil - body) + outer * (thermal.ambient - body)) / c_body

    a, d = (through + inner) / c_oil, (inner + outer) / c_body
    half = 0.5 * (a - d)
    spread = math.sqrt(half * half + inner * inner / (c_oil * c_body))
    fast = -0.5 * (a + d) - spread
    slow = (through * inner + through * outer + inner * outer) / (c_oil * c_body) / fast

    af_oil = inner / c_oil * f_body - a * f_oil
    af_body = inner / c_body * f_oil - d * f_body
    gap = slow - fast
    s_oil, s_body = (af_oil - fast * f_oil) / gap, (af_body - fast * f_body) / gap
    q_oil, q_body = f_oil - s_oil, f_body - s_body      # parts of f along slow and fast
    state.oil = oil + h * (phi_1(h * slow) * s_oil + phi_1(h * fast) * q_oil)
    state.body = body + h * (phi_1(h * slow) * s_body + phi_1(h * fast) * q_body)
    mean_oil = oil + h * (phi_2(h * slow) * s_oil + phi_2(h * fast) * q_oil)
    mean_body = body + h * (phi_2(h * slow) * s_body + phi_2(h * fast) * q_body)
    state.heat += oil_heat + body_heat
    carried = h * through * (mean_oil - supply)
    state.to_oil += carried
    state.to_air += h * outer * (mean_body - thermal.ambient)
    return carried
