"""
Supplies that are set below what an actuator's REU takes for sufficient: reported before a run.

Of a circuit that is what its pumps hold, or a relief or unloading valve less of it.

The condition `supply_low` compares the pressure at the actuator with its relief valves, since the
REU does not know how its supply is set.
"""

from collections.abc import Iterator

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.conditions import BITS
from isa_ros.core.suggest import listed
from isa_ros.core.units import MPA
from isa_ros.surroundings.circuits.sheet import CircuitSupply

_NAME = 'supply_low'


def low_supplies(run: RunConfig) -> Iterator[str]:
    """Yield a line for each supply at which actuators warn, or trip, from the first tick on."""
    for supply in run.supplies:
        if isinstance(supply.sheet, CircuitSupply):
            pressure, key = supply.sheet.rest_pressure / MPA, f'{supply.name} holds'
        else:
            pressure, key = supply.sheet.pressure_mpa, f'{supply.name}.pressure_mpa ='
        for which, verb in (('trip', 'will trip'), ('warning', 'will warn')):
            levels = {name: level for name in supply.feeds
                      if (level := _level_mpa(run.actuator(name).sheet, which)) > pressure}
            if levels:
                yield (
                    f'{key} {pressure:g} MPa < '
                    f'{max(levels.values()):.4g} MPa: {listed(list(levels))} {verb} {_NAME} from '
                    f'the start (reu.protection.{_NAME}.{which}, a part of the opening pressure '
                    'of the relief valves; 0: off)')
                break


def _level_mpa(sheet: ActuatorSheet, which: str) -> float:
    """Return the supply pressure below which a device warns or trips, MPa; 0: it does not."""
    protection = sheet.reu.protection
    own = getattr(protection, _NAME)
    is_watched = (protection.switch == 'on' and own.reaction != 'none'
                  and not int(protection.mask) >> BITS[_NAME] & 1)
    level: float = getattr(own, which) * sheet.plant.relief.opening_pressure_mpa
    return level if is_watched else 0.0
