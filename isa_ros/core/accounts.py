"""
Oil and energy of actuators and supplies since t = 0, as one account each.

That of a supply closes too: pump and pressures held over a tick against its `SUPPLY_SHARES`.

An account maps keys, name and unit as shown, to numbers. `/diagnostics` and the tables show them.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from isa_ros.core.signals import Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import LITRE, MILLILITRE, MPA

Account = Mapping[str, float]


class AccountEntry(NamedTuple):
    """One entry of an account: a field of a record, its name, and its unit in SI."""

    field: str
    name: str
    unit: str
    scale: float = 1.0

    @property
    def key(self) -> str:
        """Return the key of the entry: name and unit."""
        return f'{self.name} ({self.unit})'


MEAN = AccountEntry('', 'mean power', 'W')
"""The energy over the time; no field."""
PEAK = AccountEntry('peak_power', 'peak power', 'W')
OIL = AccountEntry('supply_volume', 'oil drawn', 'l', LITRE)
RETURNED = AccountEntry('return_volume', 'oil returned', 'l', LITRE)
ENERGY = AccountEntry('hydraulic_energy', 'hydraulic energy', 'J')
LEAKAGE = AccountEntry('leakage_energy', 'valve leakage', 'J')
THROTTLING = AccountEntry('throttling_energy', 'throttling', 'J')
FRICTION = AccountEntry('friction_energy', 'friction', 'J')
WORK = AccountEntry('work', 'work', 'J')
CROSS_PORT = AccountEntry('cross_port_energy', 'cross-port leakage', 'J')
RELIEF = AccountEntry('relief_energy', 'relief', 'J')
DAMPING = AccountEntry('damping_energy', 'damping', 'J')
STORED = AccountEntry('stored_energy', 'stored', 'J')
SHARES = (LEAKAGE, THROTTLING, FRICTION, WORK, CROSS_PORT, RELIEF, DAMPING, STORED)
"""Where the energy of an actuator went; their sum is `ENERGY`."""
CHAMBERS = (
    AccountEntry('chamber_pressure_a', 'pressure A', 'MPa', MPA),
    AccountEntry('chamber_pressure_b', 'pressure B', 'MPa', MPA),
    AccountEntry('cavity_a', 'cavity A', 'ml', MILLILITRE),
    AccountEntry('cavity_b', 'cavity B', 'ml', MILLILITRE),
    AccountEntry('largest_cavity', 'largest cavity', 'ml', MILLILITRE))
"""What the chambers hold, exact: pressures and cavities of now."""

SUPPLY_OIL = OIL._replace(field='drawn')
SUPPLY_RETURNED = RETURNED._replace(field='returned')
SUPPLY_ENERGY = ENERGY._replace(field='energy')
PUMP = AccountEntry('pump_energy', 'pump', 'J')
HELD = AccountEntry('held_energy', 'pressures held over a tick', 'J')
SUPPLY_RELIEF = AccountEntry('relief_energy', 'relief', 'J')
RETURN = AccountEntry('return_energy', 'return', 'J')
SUPPLY_SHARES = (SUPPLY_ENERGY, SUPPLY_RELIEF, RETURN, STORED)
"""Where the energy of a supply went; their sum is that of `PUMP` and `HELD`."""

_OF_ACTUATOR = (OIL, RETURNED, PEAK, ENERGY, *SHARES, *CHAMBERS)
FIELDS = tuple(entry.field for entry in _OF_ACTUATOR)
"""The fields of a `SAMPLE` in an account."""
_OF_SUPPLY = (SUPPLY_OIL, SUPPLY_RETURNED, PEAK, SUPPLY_ENERGY, PUMP, HELD, SUPPLY_RELIEF,
              RETURN, STORED)


def entries_of(is_supply: bool) -> tuple[AccountEntry, ...]:
    """Return the entries of the account of an actuator or a supply that are fields of a sample."""
    return _OF_SUPPLY if is_supply else _OF_ACTUATOR


def accounts_of(
        actuators: Sequence[str], samples: Records, supplies: Sequence[str],
        supply_samples: Records, t_ns: int) -> dict[str, Account]:
    """
    Return the accounts by name of the actuator or supply, actuators first.

    ``samples`` are `SAMPLE` rows, (n,), and ``supply_samples`` `SUPPLY_SAMPLE` rows, (m,), of
    ``t_ns``.
    """
    found = {name: _account(row, _OF_ACTUATOR, ENERGY, t_ns)
             for name, row in zip(actuators, samples)}
    return found | {name: _account(row, _OF_SUPPLY, SUPPLY_ENERGY, t_ns)
                    for name, row in zip(supplies, supply_samples)}


def _account(row: Mapping[str, float], entries: Sequence[AccountEntry], energy: AccountEntry,
             t_ns: int) -> Account:
    account = {entry.key: float(row[entry.field]) / entry.scale for entry in entries}
    seconds = t_ns / NS_PER_SECOND
    return {MEAN.key: account[energy.key] / seconds if t_ns else 0.0} | account
