"""
A ring of slaves: every frame passes all of them in their order and returns to the master.

The working counter of a datagram grows by 1 for each slave that was read, and by 1 for each that
was written; by 2 for a write of a datagram that also reads.
"""

from collections.abc import Sequence
import struct

from isa_ros.config.models.bus_port import POWERLESS
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.ethercat.application_layer import AlState
from isa_ros.fieldbus.ethercat.cabling import Cabling
from isa_ros.fieldbus.ethercat.clock import SharedClock
from isa_ros.fieldbus.ethercat.controller import irq_of
from isa_ros.fieldbus.ethercat.cycle import Cycle
from isa_ros.fieldbus.ethercat.datagrams import (
    Command, Datagram, Datagrams, datagrams, is_ethercat)
from isa_ros.fieldbus.ethercat.logical import execute, plan, SlaveAccess
from isa_ros.fieldbus.ethercat.registers import EVENTS, UNIT_ERRORS
from isa_ros.fieldbus.ethercat.slave import Slave, WRITTEN

_WORD = struct.Struct('<H')
_WRAP = 0xFFFF
_EVENTS = EVENTS.address
_SOURCE, _LOCAL = 6, 0x02
"""First byte of the source address, and its bit for a locally administered one."""
_SLAVE, _IRQ = 2, 8
"""Offsets in a datagram's header."""
_LOGICAL = (Command.LRD, Command.LWR, Command.LRW)
_POSITION = (Command.APRD, Command.APWR, Command.APRW, Command.ARMW)
_STATION = (Command.FPRD, Command.FPWR, Command.FPRW, Command.FRMW)
_BROADCAST = (Command.BRD, Command.BWR, Command.BRW)
_MULTIPLE = (Command.ARMW, Command.FRMW)
_PHYSICAL = (*_POSITION, *_STATION, *_BROADCAST)
_READS = (Command.APRD, Command.APRW, Command.FPRD, Command.FPRW, Command.BRD, Command.BRW)
_WRITES = (Command.APWR, Command.APRW, Command.FPWR, Command.FPRW, Command.BWR, Command.BRW)


class Ring:
    """The slaves of devices, the first next to the master."""

    def __init__(self, devices: Sequence[BusDevice], step_ns: int) -> None:
        self.clock = SharedClock(step_ns)
        self.cycle = Cycle()
        self._plans: dict[tuple[int, int, int, int], list[SlaveAccess]] = {}
        self._taken: Datagrams | None = None
        self._awaited: list[tuple[Slave, int]] = []
        self._highest = AlState.INIT
        self._is_operational = self._is_surveyed = False
        self.slaves = [Slave(device, position, len(devices), self.clock, self._replan)
                       for position, device in enumerate(devices)]
        self._cabling = Cabling(len(devices))
        self.reached = self.slaves
        """Those that the frames of the master reach."""
        self._is_cut = False
        self._memories = [slave.controller.memory for slave in self.slaves]

    def set_port(self, device: str, fault: str, is_on: bool) -> None:
        """Pull the cable of a device towards the master, cut its power, or end that."""
        position = next(k for k, slave in enumerate(self.slaves) if slave.device.name == device)
        if fault == POWERLESS:
            if is_on:
                self._cut_power(position)
            self._cabling.is_powered[position] = not is_on
        else:
            self._cabling.pull(position, is_on)
        links, powered = self._cabling.links, self._cabling.is_powered
        for k, slave in enumerate(self.slaves):
            if powered[k]:
                for port in range(2):
                    slave.link(port, links[k + port])
        n_reached = self._cabling.n_reached
        for slave in self.slaves:
            slave.clock.end_at(n_reached)
        self.reached = self.slaves[:n_reached]
        self._is_cut = n_reached < len(self.slaves)
        self._memories = [slave.controller.memory for slave in self.reached]
        self._replan()

    def _cut_power(self, position: int) -> None:
        """Put a slave that has just been switched on in the place of one that loses its power."""
        lost = self.slaves[position]
        lost.cut_power()
        self.slaves[position] = Slave(
            lost.device, position, len(self.slaves), self.clock, self._replan,
            lost.controller.eeprom.image)

    def _replan(self) -> None:
        """Forget what was planned: a master has configured a slave."""
        self._plans.clear()
        self._is_surveyed = False
        self.cycle.forget()

    def _survey(self) -> None:
        """Note what a cycle exchanges, and the highest state."""
        self._awaited = [(slave, slave.awaited) for slave in self.reached]
        self._highest = max(slave.state for slave in self.slaves)
        self._is_surveyed = True

    def take(self, frame: bytearray, size: int) -> Datagrams | None:
        """Return the datagrams of a frame, None if it is not EtherCAT."""
        if self._taken is None or not self._taken.describe(frame, size):
            if not is_ethercat(frame, size):
                return None
            self._taken = datagrams(frame, size)
        return self._taken

    def is_next_cycle(self, taken: Datagrams) -> bool:
        """Return whether a frame begins a cycle while another is not complete."""
        return self.cycle.is_open and self.cycle.is_over(taken.writes)

    def process(self, frame: bytearray, taken: Datagrams) -> None:
        """Let a frame pass all slaves, in place."""
        frame[_SOURCE] |= _LOCAL
        self.clock.take()
        irq = self._irq()
        for datagram in taken.found:
            command = datagram.command
            if command in _LOGICAL:
                self._add(frame, datagram.end, self._logical(frame, datagram))
            elif command in _PHYSICAL:
                self._add(frame, datagram.end, self._physical(frame, datagram))
            if irq:
                at = datagram.at + _IRQ
                _WORD.pack_into(frame, at, _WORD.unpack_from(frame, at)[0] | irq)
        if not taken.is_whole:
            for slave in self.reached:
                slave.controller.count(UNIT_ERRORS)
        if taken.writes and (self._is_cut or any(
                slave.exchanged & WRITTEN for slave in self.reached)):
            self.cycle.add(taken.writes)

    def _add(self, frame: bytearray, at: int, count: int) -> None:
        """Add to a working counter."""
        _WORD.pack_into(frame, at, _WORD.unpack_from(frame, at)[0] + count & _WRAP)

    def _irq(self) -> int:
        """Return the events of all slaves that their masks let through."""
        irq = 0
        for memory in self._memories:
            if memory[_EVENTS]:
                irq |= irq_of(memory)
        return irq

    def _logical(self, frame: bytearray, datagram: Datagram) -> int:
        """Exchange logical memory; return the count."""
        key = (datagram.command, datagram.logical, datagram.data, datagram.end)
        steps = self._plans.get(key)
        if steps is None:
            steps = self._plans[key] = plan(self.reached, datagram)
        return execute(steps, frame, datagram)

    def _physical(self, frame: bytearray, datagram: Datagram) -> int:
        """Access the memories of the slaves addressed; return the count."""
        command, wanted, count = datagram.command, datagram.slave, 0
        reads, writes, is_multiple = command in _READS, command in _WRITES, command in _MULTIPLE
        is_station, is_position = command in _STATION, command in _POSITION
        is_broadcast = command in _BROADCAST
        for position, slave in enumerate(self.reached):
            if is_station:
                is_addressed = wanted in slave.controller.addresses
            else:
                is_addressed = is_broadcast or wanted + position & _WRAP == 0
            if is_multiple:
                count += _access(slave, frame, datagram, is_addressed, not is_addressed)
            elif is_addressed:
                count += _access(slave, frame, datagram, reads, writes)
        if is_position or is_broadcast:
            _WORD.pack_into(frame, datagram.at + _SLAVE, wanted + len(self.reached) & _WRAP)
        return count

    @property
    def is_complete(self) -> bool:
        """Return whether all process data have been exchanged in this cycle."""
        if not self.cycle.is_open:
            return False
        if not self._is_surveyed:
            self._survey()
        for slave, awaited in self._awaited:
            if slave.exchanged & awaited != awaited:
                return False
        return True

    def end_cycle(self) -> bool:
        """
        Hand the outputs of a cycle to the devices; return whether it is a tick.

        It is from the first cycle in the state operational on, until all slaves are in INIT or
        PREOP: a slave that has fallen to SAFEOP still moves. While one is not reached, time goes
        on, for its fault has an end.
        """
        self.cycle.end()
        if not self._is_surveyed:
            self._survey()
        self._is_operational = self._highest >= (
            AlState.SAFEOP if self._is_operational else AlState.OP
            ) or self._is_operational and self._is_cut
        for slave in self.slaves:
            slave.end_cycle()
        return self._is_operational

    def until_sync_ns(self) -> int:
        """Return the time until SYNC0 of the first slave that has it, ns; 0 if none has."""
        self.clock.take()
        found = (slave.clock.until_sync_ns for slave in self.slaves)
        return next((one for one in found if one is not None), 0)

    def lose_link(self) -> None:
        """Count that the link to the master was lost."""
        self.slaves[0].controller.lose_link(port=0)

    def miss(self) -> None:
        """Let the watchdogs of all slaves expire."""
        for slave in self.slaves:
            slave.miss()

    def update(self) -> None:
        """Let a tick pass: clocks, inputs and emergencies."""
        self.clock.advance()
        for slave in self.slaves:
            slave.update()


def _access(slave: Slave, frame: bytearray, datagram: Datagram, reads: bool, writes: bool) -> int:
    """Access the memory of one slave; return what it adds to the working counter."""
    start, end, count = datagram.data, datagram.end, 0
    sent = bytes(frame[start:end])
    if reads:
        content = slave.controller.read(datagram.offset, end - start)
        if content is not None:
            count += 1
            is_merged = datagram.command in _BROADCAST
            frame[start:end] = _merged(content, sent) if is_merged else content
    if writes and slave.controller.write(datagram.offset, sent):
        count += 2 if reads else 1
    return count


def _merged(content: bytes, sent: bytes) -> bytes:
    """Return the bits that are set in either."""
    return (int.from_bytes(content, 'little') | int.from_bytes(sent, 'little')).to_bytes(
        len(content), 'little')
