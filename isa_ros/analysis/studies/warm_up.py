"""
How warm the oil of the quadruped's power unit gets in hours of trot, by the size of its cooler.

The heat is the mean of the trot: what the pump gives ends in the oil, for on level ground the
actuators do no work over a stride; its friction and leakage come in addition (T8). The
temperature after a time is one exact step of T7.
"""

from collections.abc import Sequence

from isa_ros.core.oil_properties import MineralOil
from isa_ros.core.record import rows_of
from isa_ros.core.units import LPM, MPA
from isa_ros.scripting.result import Result
from isa_ros.surroundings.circuits.heat import (
    CoolerPart, heat_capacity, MixedHeat, OIL_STATE, warm_oil, ways_of)
from isa_ros.surroundings.circuits.pump import PumpPart
from isa_ros.surroundings.circuits.sheet import CircuitSupply
import numpy as np

EFFICIENCY = 0.9        # hydro-mechanical, of an assumed pump
AIR = 25.0              # celsius
TANK = MixedHeat(
    oil_volume_l=6.0, metal_heat_capacity=3000.0, start_celsius=AIR, sheet_celsius=40.0,
    air_celsius=AIR, walls_w_per_k=4.0, actuators_percent=100.0, oil=MineralOil(
        density=860.0, specific_heat=1970.0, viscosity_at_40_cst=32.0, viscosity_at_100_cst=5.4,
        compressibility_per_k=4.5e-3))
COOLERS = (0.0, 50.0, 100.0, 150.0, 250.0)      # W/K
MOMENTS = (60.0, 300.0, 1200.0, 3600.0, 4 * 3600.0)    # s
HOTTEST = 100.0         # celsius, beyond which a number says nothing of an oil
WARMEST = 60.0          # celsius, that seals and oil bear for long


def heat_of(result: Result, unit: str, power: float, since: float) -> float:
    """
    Return the mean heat of the oil of a circuit from a time on, W, whose pump gave ``power``.

    ``unit`` is its name; the pump draws from a tank at no pressure.
    """
    sheet = next(own.sheet for own in result.scenario.run.supplies if own.name == unit)
    assert isinstance(sheet, CircuitSupply)
    pump = next(part for part in sheet.by_name.values() if isinstance(part, PumpPart))
    pressure = result[f'{unit}/{pump.outlet}.pressure'][result.time > since]
    leaked = pump.leakage_lpm_per_mpa * LPM / MPA * float(np.mean(np.square(pressure)))
    return (power + leaked) / EFFICIENCY


def after(seconds: float, heat: float, cooler: float) -> float:
    """Return the temperature of the oil after a time with a cooler of ``cooler`` W/K, celsius."""
    oil: np.record = rows_of(1, OIL_STATE)[0]
    oil.celsius = TANK.start_celsius
    ways = ways_of(TANK, [CoolerPart(w_per_k=cooler, coolant_celsius=AIR)])
    warm_oil(seconds, heat * seconds, heat_capacity(TANK), ways, oil, np.zeros(len(ways)))
    return float(oil.celsius)


def cooler_for(heat: float) -> float:
    """Return the cooler that keeps the oil at `WARMEST`, W/K."""
    return heat / (WARMEST - AIR) - TANK.walls_w_per_k


def table(heat: float) -> list[tuple[str, ...]]:
    """Return the rows of the temperatures, the header first."""
    return [('cooler, W/K', *(f'after {seconds / 60.0:g} min' for seconds in MOMENTS)),
            *((f'{cooler:g}', *(_cell(after(seconds, heat, cooler)) for seconds in MOMENTS))
              for cooler in COOLERS)]


def _cell(celsius: float) -> str:
    return f'{celsius:.0f}' if celsius < HOTTEST else f'> {HOTTEST:g}'


def seen(heat: float) -> Sequence[str]:
    """Return what the table has, and what follows from it."""
    return (
        f'The trot heats the oil with {1e-3 * heat:.1f} kW, a pump of {100.0 * EFFICIENCY:g} % '
        f'hydro-mechanical efficiency with its leakage among it. Here are {TANK.oil_volume_l:g} l '
        f'of oil with {1e-3 * TANK.metal_heat_capacity:g} kJ/K of metal in air of {AIR:g} '
        f'celsius, and walls that give it {TANK.walls_w_per_k:g} W/K; celsius:',
        '**Without a cooler it has minutes**: so little oil warms by '
        f'{60.0 * heat / heat_capacity(TANK):.0f} K in the first one. To stay below {WARMEST:g} '
        f'celsius it needs {cooler_for(heat):.0f} W/K. More oil puts that off, and does not '
        'change where it ends.')
