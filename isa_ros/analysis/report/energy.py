"""Oil and energy of a run, from the diagnostics of its bag, as a table: actuators, supplies."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from isa_ros.bag.provenance import CONFIGURATION
from isa_ros.bag.reader import Bag
from isa_ros.config.recorded_run import recorded_run
from isa_ros.core.accounts import (
    Account, CROSS_PORT, DAMPING, ENERGY, FRICTION, HELD, LEAKAGE, MEAN, OIL, PEAK, PUMP, RELIEF,
    RETURN, RETURNED, STORED, SUPPLY_ENERGY, SUPPLY_RELIEF, THROTTLING, WORK)
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import BagError
from isa_ros.run import diagnostics as run_diagnostics
from isa_ros.text.table import aligned, digits
from msg_adapters import diagnostics
from msg_adapters.cdr import CdrError

PARTS_HEADER = ('part of a circuit', 'oil in, l', 'out, l', 'given, J', 'lost, J', 'stored, J',
                'return, J', 'held, J', 'actuators, J')
PARTS_LEGEND = (
    'given: by pumps; lost: below 0 heat that gas has taken up; stored: more than at t = 0;\n'
    'return: lost on the way to the tank; held: paid at pressures held over a tick')
HEADER = ('', 'oil, l', 'mean, W', 'peak, W', 'energy, J', 'valve leakage', 'throttling',
          'friction', 'work', 'rest')
_COLUMNS = (LEAKAGE,), (THROTTLING,), (FRICTION,), (WORK,), (CROSS_PORT, RELIEF, DAMPING, STORED)


class Accounts(NamedTuple):
    """The accounts of a run from t = 0 to ``t``."""

    t: float
    """s; of a bag that was cut short, or of a long run, its last diagnostics."""
    by_name: Mapping[str, Account]
    """Actuators, then supplies."""


def recorded_accounts(bag: Bag) -> Accounts | None:
    """
    Return the last accounts of a bag, or None: it has no diagnostics.

    Raises
    ------
    BagError
        A message is not one of these diagnostics.

    """
    last = None
    for message in bag.messages(diagnostics.TOPIC[:1]):
        last = message
    if last is None:
        return None
    try:
        found = diagnostics.values(last.data, run_diagnostics.ENERGY)
        start_ns = recorded_run(
            bag.provenance.configuration, f'{bag.path}: {CONFIGURATION}').run.start_ns
        return Accounts((last.t_ns - start_ns) / NS_PER_SECOND, {
            name: {key: float(value) for key, value in account.items()}
            for name, account in found.items()})
    except (CdrError, ValueError) as error:
        raise BagError(f'{bag.place_of(last)}: {error}') from error


def text_of(accounts: Accounts | None) -> str:
    """Return the table of the accounts of a bag as text; '' for a bag without diagnostics."""
    if accounts is None:
        return ''
    parts = parts_table(accounts)
    return '\n'.join([*aligned(energy_table(accounts), 'lr'), energy_legend(accounts),
                      *(['', *aligned(parts, 'lr'), PARTS_LEGEND] if parts else [])])


def energy_table(accounts: Accounts) -> list[tuple[str, ...]]:
    """Return the rows of the table, the header first; a supply has no shares, a part no row."""
    return [HEADER, *((name, *_cells(account)) for name, account in accounts.by_name.items()
                      if not _is_part(name, accounts))]


def parts_table(accounts: Accounts) -> list[tuple[str, ...]]:
    """
    Return the rows of circuits and their parts, the header first; empty without circuits.

    Of each, given and held are lost, stored, returned and given to actuators  (E12).
    """
    circuits = {name.rpartition('/')[0] for name in accounts.by_name if _is_part(name, accounts)}
    rows = []
    for name, account in accounts.by_name.items():
        if name in circuits or _is_part(name, accounts):
            oil = ('' if name in circuits else digits(account[entry.key], 3)
                   for entry in (OIL, RETURNED))
            rows.append((name, *oil, *(digits(account[entry.key], 3) for entry in (
                PUMP, SUPPLY_RELIEF, STORED, RETURN, HELD, SUPPLY_ENERGY))))
    return [PARTS_HEADER, *rows] if rows else []


def _is_part(name: str, accounts: Accounts) -> bool:
    """Return whether an account is that of a part of a circuit."""
    circuit = accounts.by_name.get(name.rpartition('/')[0])
    return circuit is not None and LEAKAGE.key not in circuit


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
