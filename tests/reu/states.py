"""States of an REU, for tests of its blocks and of its device."""

from isa_ros.core.device import ENABLED, MODES
from isa_ros.core.record import rows_of
from isa_ros.core.signals import HAS_ENABLE
from isa_ros.reu.cascade import REU_STATE
import numpy as np


def enabled_state(reu: np.record, mode: int | None = None) -> np.record:
    """Return an enabled `REU_STATE`, all zero, by default in the outermost mode of the wiring."""
    state = rows_of(1, REU_STATE)[0]
    own = state.status
    own.state, own.is_on, own.auto_enable = ENABLED, 1, 1
    own.mode = max(k for k in range(len(MODES)) if reu.rules.modes >> k & 1)
    own.mode = own.acting = own.requested_mode = own.mode if mode is None else mode
    return state


def disable(state: np.record) -> None:
    """Request that the device be disabled at its next step."""
    state.status.requests, state.status.requested_enable = HAS_ENABLE, 0
