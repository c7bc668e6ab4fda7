"""AL status codes (ETG.1000.6, ETG.1020) that a slave reports in 0x0134."""

NO_ERROR = 0x0000
INVALID_CHANGE = 0x0011     # a state was left out on the way up
UNKNOWN_STATE = 0x0012
NO_BOOTSTRAP = 0x0013       # there is none
INVALID_MAILBOX = 0x0016    # sync manager 0 or 1 is not as in the SII
WATCHDOG = 0x001B           # no process data for its time
INVALID_OUTPUTS = 0x001D    # sync manager 2 does not fit the PDOs assigned
INVALID_INPUTS = 0x001E     # sync manager 3 does not fit the PDOs assigned
INVALID_WATCHDOG = 0x001F   # its time is shorter than a tick
SYNC0_CYCLE_TIME = 0x0036   # not the tick of the simulation
