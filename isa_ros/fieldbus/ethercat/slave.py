"""A slave: the controller, and the application that connects it to a device."""

from collections.abc import Callable

from isa_ros.fieldbus.device.bus_device import BusDevice, RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT
from isa_ros.fieldbus.ethercat import al_codes
from isa_ros.fieldbus.ethercat.application_layer import AlState, ApplicationLayer
from isa_ros.fieldbus.ethercat.clock import DistributedClock, SharedClock
from isa_ros.fieldbus.ethercat.coe import CanOverEthercat
from isa_ros.fieldbus.ethercat.controller import AL_EVENT, DL_EVENT, SlaveController
from isa_ros.fieldbus.ethercat.fmmu import Fmmu
from isa_ros.fieldbus.ethercat.layout import AREAS
from isa_ros.fieldbus.ethercat.registers import DL_STATUS
from isa_ros.fieldbus.ethercat.sii import build_sii, process_data_sizes
from isa_ros.fieldbus.ethercat.slave_mailbox import SlaveMailbox
from isa_ros.fieldbus.ethercat.sync_manager import (
    INPUTS, MAILBOX_IN, MAILBOX_OUT, OUTPUTS, SyncManager)
from isa_ros.fieldbus.ethercat.watchdog import Watchdog

WRITTEN, READ = 1, 2
_FROM_MASTER = {MAILBOX_OUT: True, MAILBOX_IN: False, OUTPUTS: True, INPUTS: False}
_WITHOUT_LINKS, _OPEN, _CLOSED = 0x5001, (0x0210, 0x0820), (0x0100, 0x0400)
"""DL status: the application runs, loops 2 and 3 are closed; link and communication of ports 0 and
1; their loops closed."""


class Slave:
    """
    One device at its position in the ring.

    ``sii`` is its memory of that name as it was before its power was lost, and with it the links;
    None: a new one, which is linked.
    """

    def __init__(self, device: BusDevice, position: int, n_slaves: int, shared: SharedClock,
                 on_change: Callable[[], None], sii: bytearray | None = None) -> None:
        self.device = device
        self.controller = SlaveController(build_sii(device) if sii is None else sii)
        memory = self.controller.memory
        self._is_linked = [sii is None, sii is None and position < n_slaves - 1]
        self._show_links()
        self._sync = self.controller.sync
        self._step_ns = shared.step_ns
        self._on_change = on_change
        self.clock = DistributedClock(memory, shared, position, n_slaves)
        self._coe = CanOverEthercat(device)
        self._mailbox = SlaveMailbox(self._sync[MAILBOX_OUT], self._sync[MAILBOX_IN], self._coe)
        self._sync[OUTPUTS].lock(True)
        self._sync[INPUTS].lock(True)
        self.watchdog = Watchdog(memory, shared.step_ns)
        self._al = ApplicationLayer(memory, self)
        self._received: list[tuple[int, int, int]] = []
        self._transmitted: list[int] = []
        self.exchanged = 0
        """Bits `WRITTEN`, `READ`: what the master has exchanged in this cycle."""
        self.controller.attach(
            self.clock, on_control=self._take_control, on_buffer=self._take_buffer,
            on_setup=self._check_setup)

    @property
    def state(self) -> AlState:
        """Return the state of the slave."""
        return self._al.state

    def link(self, port: int, is_linked: bool) -> None:
        """Note that a port has lost its link or has it again."""
        if self._is_linked[port] != is_linked:
            self._is_linked[port] = is_linked
            self._show_links()
            if is_linked:
                self.controller.note_event(DL_EVENT)
            else:
                self.controller.lose_link(port)

    def _show_links(self) -> None:
        DL_STATUS.put(self.controller.memory, _WITHOUT_LINKS | sum(
            _OPEN[port] if is_linked else _CLOSED[port]
            for port, is_linked in enumerate(self._is_linked)))

    def cut_power(self) -> None:
        """Switch the device off: it is that of power-on when it has power again."""
        if self.state == AlState.OP:
            self.device.end_operation(is_lost=False)
        self.device.restart(is_whole=True)

    def refusal(self, state: AlState) -> int:
        """Return why a state cannot be, as a code of `al_codes`; 0 if it can."""
        if state == AlState.PREOP:
            is_right = self._fits(MAILBOX_OUT, AREAS[MAILBOX_OUT].length) and self._fits(
                MAILBOX_IN, AREAS[MAILBOX_IN].length)
            return al_codes.NO_ERROR if is_right else al_codes.INVALID_MAILBOX
        return self._process_data_refusal()

    def _process_data_refusal(self) -> int:
        """Return why process data cannot be exchanged, 0 if they can."""
        sizes = process_data_sizes(self.device)
        for manager, code in (
                (OUTPUTS, al_codes.INVALID_OUTPUTS), (INPUTS, al_codes.INVALID_INPUTS)):
            if not self._fits(manager, sizes[manager]):
                return code
        if self._is_watched and 0 < self.watchdog.time_ns < self._step_ns:
            return al_codes.INVALID_WATCHDOG
        if not self.clock.is_cycle_right():
            return al_codes.SYNC0_CYCLE_TIME
        return al_codes.NO_ERROR

    def _fits(self, manager: int, length: int) -> bool:
        """Return whether a sync manager is as the application needs it; of 0 bytes: off."""
        setup, area = self._sync[manager].setup, AREAS[manager]
        if not length:
            return not setup.is_active or not setup.length
        return (setup.is_active and setup.length == length <= area.length
                and setup.start == area.start
                and setup.is_from_master == _FROM_MASTER[manager]
                and setup.is_mailbox == (manager in (MAILBOX_OUT, MAILBOX_IN)))

    @property
    def _is_watched(self) -> bool:
        """Return whether the watchdog watches the outputs."""
        return self._sync[OUTPUTS].setup.has_watchdog and self._sync[OUTPUTS].covers

    def change(self, old: AlState, new: AlState, is_lost: bool) -> None:
        """Act on a change of state; ``is_lost``: the master did not ask for it."""
        self._coe.is_preoperational = new == AlState.PREOP
        if old == AlState.OP:
            self.device.end_operation(is_lost)
        if old == AlState.INIT:
            self._mailbox.start()
        elif new == AlState.INIT:
            self._mailbox.stop()
            self.device.restart(is_whole=False)
        is_exchanging = new in (AlState.SAFEOP, AlState.OP)
        if is_exchanging and old == AlState.PREOP:
            self._assign()
        if is_exchanging != (old in (AlState.SAFEOP, AlState.OP)):
            self._sync[OUTPUTS].lock(not is_exchanging)
            self._sync[INPUTS].lock(not is_exchanging)
        if is_exchanging:
            self.put_inputs()
        if new == AlState.OP:
            self.watchdog.feed()
            self.device.begin_operation()
        if is_lost:
            self.controller.note_event(AL_EVENT)

    def _assign(self) -> None:
        """Note which PDOs are in the buffers, and where."""
        self._received, at = [], 0
        for pdo in self.device.assigned(RECEIVE_ASSIGNMENT):
            size = self.device.size(pdo)
            self._received.append((pdo, at, at + size))
            at += size
        self._transmitted = self.device.assigned(TRANSMIT_ASSIGNMENT)
        self.exchanged = 0

    def is_whole_buffer(self, start: int, end: int, is_output: bool) -> bool:
        """Return whether these addresses are all of an open buffer of process data."""
        manager = self._sync[OUTPUTS if is_output else INPUTS]
        setup = manager.setup
        return (manager.covers and not manager.is_locked and not setup.is_mailbox
                and setup.is_from_master == is_output
                and (start, end) == (manager.start, manager.end))

    @property
    def awaited(self) -> int:
        """Return what a cycle exchanges through FMMUs, as bits `WRITTEN` and `READ`."""
        if self._al.state not in (AlState.SAFEOP, AlState.OP):
            return 0
        fmmus = self.controller.fmmus
        return (WRITTEN if any(one.writes and self._reaches(one, OUTPUTS) for one in fmmus) else 0
                ) | (READ if any(one.reads and self._reaches(one, INPUTS) for one in fmmus) else 0)

    def _reaches(self, fmmu: Fmmu, number: int) -> bool:
        """Return whether an FMMU maps any of a sync manager's buffer."""
        manager = self._sync[number]
        return (manager.covers and fmmu.physical < manager.end
                and fmmu.physical + fmmu.length > manager.start)

    def _take_control(self) -> None:
        self._al.control()
        self._on_change()

    def _check_setup(self) -> None:
        """Fall back if sync managers no longer fit the state."""
        if self._al.state != AlState.INIT and self.refusal(AlState.PREOP):
            self._al.fall(AlState.INIT, al_codes.INVALID_MAILBOX)
        elif self._al.state in (AlState.SAFEOP, AlState.OP):
            sizes = process_data_sizes(self.device)
            if not self._fits(OUTPUTS, sizes[OUTPUTS]):
                self._al.fall(AlState.PREOP, al_codes.INVALID_OUTPUTS)
            elif not self._fits(INPUTS, sizes[INPUTS]):
                self._al.fall(AlState.PREOP, al_codes.INVALID_INPUTS)
        self._mailbox.repeat()
        self._on_change()

    def _take_buffer(self, manager: SyncManager) -> None:
        """Act on a buffer that the master has filled or emptied."""
        if manager.number == MAILBOX_OUT:
            self._mailbox.receive()
        elif manager.number == MAILBOX_IN:
            self._mailbox.note_read()
        elif manager.number == OUTPUTS:
            self.exchanged |= WRITTEN
        elif manager.number == INPUTS:
            self.exchanged |= READ

    def end_cycle(self) -> None:
        """Hand new outputs to the device, or count a cycle without them."""
        exchanged, self.exchanged = self.exchanged, 0
        if exchanged & WRITTEN:
            self.watchdog.feed()
            outputs = self._sync[OUTPUTS].take()
            if self._al.state == AlState.OP:
                for pdo, start, end in self._received:
                    self.device.receive(pdo, outputs[start:end])
        elif self._al.state == AlState.OP and self._is_watched and self.watchdog.miss():
            self._lose()

    def miss(self) -> None:
        """Let the watchdog expire: nothing has arrived for its wall time."""
        if self._al.state == AlState.OP and self._is_watched and self.watchdog.expire():
            self._lose()

    def _lose(self) -> None:
        self._al.fall(AlState.SAFEOP, al_codes.WATCHDOG)
        self._on_change()

    def update(self) -> None:
        """Take the device's new state as inputs, and its emergencies as mails."""
        if self._al.state in (AlState.SAFEOP, AlState.OP):
            self.put_inputs()
        for emergency in self.device.emergencies():
            if self._al.state != AlState.INIT:
                self._mailbox.post_emergency(emergency)

    def put_inputs(self) -> None:
        """Fill the buffer of inputs."""
        if self._transmitted:
            self._sync[INPUTS].put(b''.join(map(self.device.transmit, self._transmitted)))
