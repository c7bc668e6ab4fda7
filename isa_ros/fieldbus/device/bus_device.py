"""What a bus sees of one actuator: objects, process data, and the state of the bus."""

from collections.abc import Mapping
from typing import NamedTuple, Protocol

from isa_ros.fieldbus.device.objects import ObjectTable, Value
import numpy as np

VENDOR = 0xBAD
"""Placeholder: not an assigned vendor id."""

RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT = 0x1C12, 0x1C13
"""Objects with the PDOs of EtherCAT: from the master, to the master."""


class Identity(NamedTuple):
    """Object 0x1018 of a device."""

    vendor: int
    product: int
    """Differs between kinds of actuators."""
    revision: int
    serial: int


class Emergency(NamedTuple):
    """An emergency message (EMCY) of CiA 301."""

    code: int
    """As object 0x603F; 0: the error is gone."""
    register: int
    """Object 0x1001."""
    data: bytes
    """5 bytes of the manufacturer."""


class BusDevice(Protocol):
    """
    One actuator as a bus sees it.

    The bus calls `read` to `emergencies`, the run calls `take_sample`, `fill_command` and
    `changes`, once per tick; all from one thread.
    """

    name: str
    identity: Identity
    table: ObjectTable
    is_wanted: bool
    """Whether a control word that is not 0 has been received: simulated time begins then."""

    def read(self, index: int, subindex: int) -> bytes:
        """Return the bytes of an entry, a text without a final 0; raises `SdoAbort`."""

    def write(
            self, index: int, subindex: int, data: bytes, *, is_preoperational: bool) -> None:
        """Write an entry; mappings only while preoperational. Raises `SdoAbort`."""

    def read_all(self, index: int) -> bytes:
        """Return all entries of an object, subindex 0 as 16 bit; raises `SdoAbort`."""

    def write_all(self, index: int, data: bytes, *, is_preoperational: bool) -> None:
        """Write all entries of an object, subindex 0 as 16 bit; raises `SdoAbort`."""

    def store(self, index: int, subindex: int, value: Value) -> None:
        """Set an entry on behalf of the bus itself (COB-IDs, cycle times): without checks."""

    def assigned(self, assignment: int) -> list[int]:
        """Return the PDOs of `RECEIVE_ASSIGNMENT` or `TRANSMIT_ASSIGNMENT`, in their order."""

    def size(self, pdo: int) -> int:
        """Return the bytes of a PDO by its mapping: 0x1600 on, 0x1A00 on."""

    def receive(self, pdo: int, data: bytes) -> None:
        """Take process data from the master; they take effect at the next tick."""

    def transmit(self, pdo: int) -> bytes:
        """Return process data to the master: the state at the end of the last tick."""

    def begin_operation(self) -> None:
        """Note that the bus has entered the state operational."""

    def end_operation(self, is_lost: bool) -> None:
        """Note that the bus has left it; ``is_lost``: by a watchdog or a lost bus, unasked."""

    def restart(self, *, is_whole: bool) -> None:
        """
        Return to power-on, while not operational: mappings, assignments, and state of the drive.

        With ``is_whole`` (reset of the node) also all other objects and the faults; the outputs
        are off at once. Without it a fault stays, and a stop that is under way goes on.
        """

    def emergencies(self) -> list[Emergency]:
        """Return the emergency messages since the last call."""

    def take_sample(self, sample: np.void, tick: int) -> None:
        """Take the `SAMPLE` at the start of a tick into the objects."""

    def fill_command(self, command: np.void) -> None:
        """Write what the master commands at this tick into its `COMMAND` row."""

    def changes(self) -> dict[str, float]:
        """Return gains and limits written since the last call, SI, as `SmartActuator.tune`."""

    def take_changes(self, values: Mapping[str, float]) -> None:
        """Show gains and limits that took effect, also those changed from elsewhere; SI."""
