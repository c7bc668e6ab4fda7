"""Oil and energy of a run: read from the diagnostics of its bag."""

from collections.abc import Mapping
from typing import NamedTuple

from isa_ros.bag.reader import Bag
from isa_ros.core.accounts import Account
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import BagError
from isa_ros.run.diagnostics import ENERGY
from msg_adapters import diagnostics
from msg_adapters.cdr import CdrError


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
    for message in bag.messages():
        if message.topic == diagnostics.TOPIC[0]:
            last = message
    if last is None:
        return None
    try:
        found = diagnostics.values(last.data, ENERGY)
        return Accounts(last.t_ns / NS_PER_SECOND, {
            name: {key: float(value) for key, value in account.items()}
            for name, account in found.items()})
    except (CdrError, ValueError) as error:
        raise BagError(f'{bag.place_of(last)}: {error}') from error
