"""
Registers of an EtherCAT slave controller, as data: address, size, access and value at power-on.

The memory of a slave is one address space: registers below `MEMORY`, above them the buffers of
the sync managers. Numbers are little endian. Source: ETG.1000.4 and the register description of
the ET1100. An address without a register reads as 0 and is not written.
"""

from collections.abc import Iterator
from typing import NamedTuple

MEMORY = 0x1000
"""First address of the process memory."""
END = 0x3000
"""End of the process memory, 8 KiB as in the ET1100."""

READ, WRITE, CLEAR = 'r', 'rw', 'clear'
"""Access of a master: read; read and write; read, and a write of any value clears or triggers."""


class Register(NamedTuple):
    """A register, or the first of ``copies`` equal ones that are ``stride`` bytes apart."""

    address: int
    size: int
    access: str
    name: str
    meaning: str
    reset: int = 0
    copies: int = 1
    stride: int = 0

    @property
    def end(self) -> int:
        """Return the address behind the register, of the last one if there are several."""
        return self.address + (self.copies - 1) * self.stride + self.size

    @property
    def starts(self) -> range:
        """Return the addresses of all of them."""
        return range(self.address, self.address + self.copies * (self.stride or 1),
                     self.stride or 1)

    def value(self, memory: bytearray) -> int:
        """Return the number in the register."""
        return int.from_bytes(memory[self.address:self.address + self.size], 'little')

    def put(self, memory: bytearray, value: int) -> None:
        """Write a number into the register."""
        memory[self.address:self.address + self.size] = (
            value & (1 << 8 * self.size) - 1).to_bytes(self.size, 'little')


N_FMMUS, N_SYNC_MANAGERS = 8, 8
FMMU_SIZE, SYNC_MANAGER_SIZE = 16, 8
FMMU, SYNC_MANAGER = 0x0600, 0x0800

TYPE = Register(0x0000, 1, READ, 'type', 'kind of controller: 0x11, as an ET1100', 0x11)
REVISION = Register(0x0001, 1, READ, 'revision', 'revision of the controller')
BUILD = Register(0x0002, 2, READ, 'build', 'build of the controller')
FMMUS = Register(0x0004, 1, READ, 'FMMUs', 'how many there are', N_FMMUS)
SYNC_MANAGERS = Register(0x0005, 1, READ, 'sync managers', 'how many there are', N_SYNC_MANAGERS)
RAM_SIZE = Register(0x0006, 1, READ, 'RAM size', 'process memory in KiB', (END - MEMORY) >> 10)
PORTS = Register(0x0007, 1, READ, 'ports', 'two bits a port: ports 0 and 1 are MII', 0x0F)
FEATURES = Register(
    0x0008, 2, READ, 'features', 'FMMUs map bits; distributed clocks of 64 bit', 0x000C)
STATION_ADDRESS = Register(
    0x0010, 2, WRITE, 'station address', 'address of FPRD, FPWR, FPRW, FRMW')
STATION_ALIAS = Register(
    0x0012, 2, READ, 'station alias', 'from the SII; a second address if DL control allows it')
DL_CONTROL = Register(
    0x0100, 4, WRITE, 'DL control', 'bits 8 to 15: loops of the ports; bit 24: use the alias',
    0x0000_0001)
DL_STATUS = Register(
    0x0110, 2, READ, 'DL status', 'links, loops and communication of the ports')
AL_CONTROL = Register(
    0x0120, 2, WRITE, 'AL control', 'state asked for; bit 4: acknowledge the error', 1)
AL_STATUS = Register(0x0130, 2, READ, 'AL status', 'state; bit 4: error; bit 5: identification', 1)
AL_STATUS_CODE = Register(
    0x0134, 2, READ, 'AL status code', 'reason of the error, or the identification asked for')
PDI_CONTROL = Register(0x0140, 1, READ, 'PDI control', '0x80: the application is on chip', 0x80)
EVENT_MASK = Register(
    0x0200, 2, WRITE, 'event mask', 'events of 0x0210 that each datagram returns as its IRQ field')
EVENTS = Register(
    0x0210, 2, READ, 'events', 'bit 2: DL status has changed; 3: AL status has changed unasked')
RX_ERRORS = Register(
    0x0300, 8, CLEAR, 'receive errors', 'by port: invalid frames, receive errors')
FORWARDED_ERRORS = Register(0x0308, 4, CLEAR, 'forwarded errors', 'by port')
UNIT_ERRORS = Register(
    0x030C, 1, CLEAR, 'processing unit errors', 'frames that end before their datagrams do')
PDI_ERRORS = Register(0x030D, 1, CLEAR, 'PDI errors', 'always 0')
LOST_LINKS = Register(0x0310, 4, CLEAR, 'lost links', 'by port: how often its link was lost')
WATCHDOG_DIVIDER = Register(
    0x0400, 2, WRITE, 'watchdog divider', 'step of the watchdogs: (value + 2) * 40 ns', 0x09C2)
PDI_WATCHDOG = Register(
    0x0410, 2, WRITE, 'PDI watchdog', 'in steps of 0x0400; without effect', 0x03E8)
WATCHDOG_TIME = Register(
    0x0420, 2, WRITE, 'process data watchdog', 'in steps of 0x0400; 0: off', 0x03E8)
WATCHDOG_STATUS = Register(
    0x0440, 2, READ, 'watchdog status', 'bit 0: process data watchdog has not expired', 1)
WATCHDOG_COUNTER = Register(
    0x0442, 1, CLEAR, 'watchdog counter', 'how often the process data watchdog has expired')
PDI_WATCHDOG_COUNTER = Register(0x0443, 1, CLEAR, 'PDI watchdog counter', 'always 0')
EEPROM_CONFIGURATION = Register(
    0x0500, 1, WRITE, 'SII configuration', 'bit 0: the application has the SII, not the master')
EEPROM_ACCESS = Register(0x0501, 1, READ, 'SII access', 'bit 0: the application is using the SII')
EEPROM_CONTROL = Register(
    0x0502, 2, WRITE, 'SII control', 'bit 0: writes allowed; 8 to 10: read, write or reload; '
    '11: checksum wrong; 13: command refused; 14: write not allowed', 0x0040)
EEPROM_ADDRESS = Register(0x0504, 4, WRITE, 'SII address', 'in words of 16 bit')
EEPROM_WORDS = Register(0x0508, 8, WRITE, 'SII words', 'four words read, or one to write')
FMMU_ENTRY = Register(
    FMMU, FMMU_SIZE, WRITE, 'FMMU', 'logical address (4), length (2), first and last bit (1, 1), '
    'address (2), bit (1), 1 read or 2 write (1), active (1)', 0, N_FMMUS, FMMU_SIZE)
SYNC_MANAGER_SETUP = Register(
    SYNC_MANAGER, 5, WRITE, 'sync manager', 'address (2), length (2), control (1): mode, '
    'direction, watchdog; only while it is not active', 0, N_SYNC_MANAGERS, SYNC_MANAGER_SIZE)
SYNC_MANAGER_STATUS = Register(
    SYNC_MANAGER + 5, 1, READ, 'sync manager status', 'bits 0, 1: written, read; 3: mailbox full; '
    '4, 5: 3 while no buffer was written', 0, N_SYNC_MANAGERS, SYNC_MANAGER_SIZE)
SYNC_MANAGER_ACTIVATE = Register(
    SYNC_MANAGER + 6, 1, WRITE, 'sync manager activation',
    'bit 0: active; 1: repeat the last mail, on each change', 0,
    N_SYNC_MANAGERS, SYNC_MANAGER_SIZE)
SYNC_MANAGER_PDI = Register(
    SYNC_MANAGER + 7, 1, READ, 'sync manager application control',
    'bit 0: locked by the application; 1: repeat request acknowledged', 0,
    N_SYNC_MANAGERS, SYNC_MANAGER_SIZE)
RECEIVE_TIMES = Register(
    0x0900, 16, CLEAR, 'receive times', 'local time of a frame at each port (4 by 4); '
    'a write latches them')
SYSTEM_TIME = Register(
    0x0910, 8, WRITE, 'system time', 'local time and offset; a write is compared with it')
UNIT_RECEIVE_TIME = Register(
    0x0918, 8, READ, 'receive time', 'local time of the latched frame at the processing unit')
TIME_OFFSET = Register(0x0920, 8, WRITE, 'system time offset', 'local time to system time')
TIME_DELAY = Register(
    0x0928, 4, WRITE, 'system time delay', 'from the reference clock to this slave')
TIME_DIFFERENCE = Register(
    0x092C, 4, READ, 'system time difference', 'always 0: the clocks do not drift')
SPEED_START = Register(
    0x0930, 2, WRITE, 'speed counter start', 'a write starts the control loop anew', 0x1000)
SPEED_DIFFERENCE = Register(0x0932, 2, READ, 'speed counter difference', 'always 0')
TIME_FILTER = Register(
    0x0934, 2, WRITE, 'time filter depths', 'system time difference, speed counter', 0x0C04)
CYCLIC_CONTROL = Register(
    0x0980, 1, WRITE, 'cyclic unit control', 'bit 0: SYNC by the application')
SYNC_ACTIVATION = Register(
    0x0981, 1, WRITE, 'SYNC activation', 'bit 0: cyclic operation; 1, 2: SYNC0, SYNC1')
PULSE_LENGTH = Register(0x0982, 2, READ, 'SYNC pulse length', 'in steps of 10 ns', 100)
ACTIVATION_STATUS = Register(
    0x0984, 1, READ, 'activation status', 'bits 0, 1: SYNC0, SYNC1 pending; 2: start in the past')
SYNC_START = Register(0x0990, 8, WRITE, 'SYNC start time', 'system time of the first SYNC0')
SYNC0_CYCLE = Register(0x09A0, 4, WRITE, 'SYNC0 cycle', 'in ns')
SYNC1_CYCLE = Register(0x09A4, 4, WRITE, 'SYNC1 cycle', 'in ns after SYNC0')
LATCH_CONTROL = Register(0x09A8, 2, WRITE, 'latch control', 'without effect: no latch inputs')
LATCH_STATUS = Register(0x09AE, 2, READ, 'latch status', 'always 0')

REGISTERS = (
    TYPE, REVISION, BUILD, FMMUS, SYNC_MANAGERS, RAM_SIZE, PORTS, FEATURES, STATION_ADDRESS,
    STATION_ALIAS, DL_CONTROL, DL_STATUS, AL_CONTROL, AL_STATUS, AL_STATUS_CODE, PDI_CONTROL,
    EVENT_MASK, EVENTS, RX_ERRORS, FORWARDED_ERRORS, UNIT_ERRORS, PDI_ERRORS, LOST_LINKS,
    WATCHDOG_DIVIDER, PDI_WATCHDOG, WATCHDOG_TIME, WATCHDOG_STATUS, WATCHDOG_COUNTER,
    PDI_WATCHDOG_COUNTER, EEPROM_CONFIGURATION, EEPROM_ACCESS, EEPROM_CONTROL, EEPROM_ADDRESS,
    EEPROM_WORDS, FMMU_ENTRY, SYNC_MANAGER_SETUP, SYNC_MANAGER_STATUS, SYNC_MANAGER_ACTIVATE,
    SYNC_MANAGER_PDI, RECEIVE_TIMES, SYSTEM_TIME, UNIT_RECEIVE_TIME, TIME_OFFSET, TIME_DELAY,
    TIME_DIFFERENCE, SPEED_START, SPEED_DIFFERENCE, TIME_FILTER, CYCLIC_CONTROL, SYNC_ACTIVATION,
    PULSE_LENGTH, ACTIVATION_STATUS, SYNC_START, SYNC0_CYCLE, SYNC1_CYCLE, LATCH_CONTROL,
    LATCH_STATUS)
"""All registers that a slave has."""


def power_on() -> bytearray:
    """Return the memory of a slave at power-on."""
    memory = bytearray(END)
    for register in REGISTERS:
        if register.copies == 1:
            register.put(memory, register.reset)
    return memory


def writable() -> bytes:
    """Return for each byte of the registers 1 if a master can write it, 2 if a write clears it."""
    mask = bytearray(MEMORY)
    for register in REGISTERS:
        for start in register.starts:
            mask[start:start + register.size] = bytes(
                [{READ: 0, WRITE: 1, CLEAR: 2}[register.access]]) * register.size
    return bytes(mask)


def table() -> Iterator[str]:
    """Yield the lines of the registers' table in docs/ethercat.md."""
    yield '| address | bytes | access | register | meaning |'
    yield '|---|---|---|---|---|'
    for one in REGISTERS:
        several = f', {one.copies} of them {one.stride} apart' if one.copies > 1 else ''
        yield (f'| 0x{one.address:04X} | {one.size}{several} | {one.access} | {one.name} '
               f'| {one.meaning} |')
