"""Statuses of a run for `/diagnostics`: oil and energy."""

from collections.abc import Mapping

from isa_ros.core.accounts import Account, MEAN, OIL, PEAK
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.text.table import digits
from msg_adapters.diagnostics import Status

PERIOD_NS = NS_PER_SECOND
"""Of the diagnostics, simulated time."""
ENERGY = 'oil and energy'
"""Task of a status with an `Account`."""


def energy_statuses(accounts: Mapping[str, Account]) -> list[Status]:
    """Return a status for each account of oil and energy, by its name."""
    return [Status(name, ENERGY, _summary(account), account)
            for name, account in accounts.items()]


def _summary(account: Account) -> str:
    return (f'{digits(account[OIL.key], 3)} l drawn, mean {digits(account[MEAN.key], 3)} W, '
            f'peak {digits(account[PEAK.key], 3)} W')
