"""AL status codes (ETG.1000.6, ETG.1020) that a slave reports in 0x0134, as data."""

from collections.abc import Mapping

NO_ERROR = 0x0000
INVALID_CHANGE = 0x0011
UNKNOWN_STATE = 0x0012
NO_BOOTSTRAP = 0x0013
INVALID_MAILBOX = 0x0016
WATCHDOG = 0x001B
INVALID_OUTPUTS = 0x001D
INVALID_INPUTS = 0x001E
INVALID_WATCHDOG = 0x001F
SYNC0_CYCLE_TIME = 0x0036

AL_CODES: Mapping[int, str] = {
    NO_ERROR: 'no error',
    INVALID_CHANGE: 'invalid requested state change: a state was left out on the way up',
    UNKNOWN_STATE: 'unknown requested state',
    NO_BOOTSTRAP: 'bootstrap not supported',
    INVALID_MAILBOX: 'invalid mailbox configuration: sync manager 0 or 1 is not as in the SII',
    WATCHDOG: 'sync manager watchdog: no process data for its time',
    INVALID_OUTPUTS: 'invalid output configuration: sync manager 2 does not fit the PDOs assigned',
    INVALID_INPUTS: 'invalid input configuration: sync manager 3 does not fit the PDOs assigned',
    INVALID_WATCHDOG: 'invalid watchdog configuration: its time is shorter than a tick',
    SYNC0_CYCLE_TIME: 'SYNC0 cycle time is not the tick of the simulation',
}
"""Meaning of each code."""
