"""Oil and energy of a run as a table: a line for each actuator and each supply."""

from collections.abc import Sequence
from pathlib import Path

from isa_ros.analysis.signals.accounts import Accounts, recorded_accounts
from isa_ros.bag.reader import Bag
from isa_ros.core.accounts import (
    Account, CROSS_PORT, DAMPING, ENERGY, FRICTION, LEAKAGE, MEAN, OIL, PEAK, RELIEF, STORED,
    THROTTLING, WORK)
from isa_ros.text.table import aligned, digits

HEADER = ('', 'oil, l', 'mean, W', 'peak, W', 'energy, J', 'valve leakage', 'throttling',
          'friction', 'work', 'rest')
_COLUMNS = (LEAKAGE,), (THROTTLING,), (FRICTION,), (WORK,), (CROSS_PORT, RELIEF, DAMPING, STORED)


def energy_text(bag: Path) -> str:
    """
    Return the table of a bag as text; empty for a bag without diagnostics.

    Raises
    ------
    BagError
        The bag cannot be read.

    """
    accounts = recorded_accounts(Bag(bag))
    if accounts is None:
        return ''
    return '\n'.join([*aligned(energy_table(accounts), 'lr'), energy_legend(accounts)])


def energy_table(accounts: Accounts) -> list[tuple[str, ...]]:
    """Return the rows of the table, the header first; a supply has no shares."""
    return [HEADER, *((name, *_cells(account)) for name, account in accounts.by_name.items())]


def energy_legend(accounts: Accounts) -> str:
    """Return what the table shows."""
    return (f'up to t = {accounts.t:.3f} s; energy: of the oil drawn less that of the oil '
            'returned, and its shares;\nrest: relief valves, oil past the piston, damping of the '
            'sensor, stored energy')


def _cells(account: Account) -> Sequence[str]:
    energy = account[ENERGY.key]
    figures = [digits(account[entry.key], 3) for entry in (OIL, MEAN, PEAK, ENERGY)]
    if LEAKAGE.key not in account:
        return *figures, *('' for _ in _COLUMNS)
    shares = []
    for entries in _COLUMNS:
        total = 0.0
        for entry in entries:
            total += account[entry.key]
        # Adding 0.0 turns -0.0 into 0.0.
        shares.append(f'{round(100.0 * total / energy, 1) + 0.0:.1f} %' if energy else '-')
    return *figures, *shares
