"""What real masters do to toys, within a namespace; each scenario prints its findings as JSON."""

from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
import json
import socket
import struct
import subprocess
import sys
import time
from typing import Any

from isa_ros.errors import ConfigError, RunError
from isa_ros.fieldbus.ethercat.interface import open_interface
from isa_ros.fieldbus.ethercat.line import EthercatLine
from isa_ros.fieldbus.ethercat.ring import Ring
import kickcat
import pysoem
from tests.fieldbus.ethercat.namespace import make_interfaces, MASTER, served, SLAVES
from tests.fieldbus.ethercat.raw_master import answers_in, at, frame_of, Sent, STEP_NS
from tests.fieldbus.toys import Toy

_LONG = 1000
_TIMEOUT_US, _STATE_US = 200_000, 2_000
_CYCLES, _FEW = 200, 10
_KICK_SETUP, _KICK_CYCLE = 4 * (0.01,) + 3 * (0.03,) + 2 * (0.1,), 0.5
_PATIENCE, _LONG_PATIENCE, _SHORT, _BUFFER = 5.0, 30.0, 0.5, 2000


def opened() -> Any:
    """Return a master of pysoem that has found and mapped its slaves."""
    master = pysoem.Master()
    master.open(MASTER)
    assert master.config_init() > 0
    master.config_map()
    return master


def operate(master: Any) -> None:
    """Bring all slaves into operation."""
    assert master.state_check(pysoem.SAFEOP_STATE, 500_000) == pysoem.SAFEOP_STATE
    for slave in master.slaves:
        slave.output = bytes(len(slave.output))
    cycle(master)
    master.state = pysoem.OP_STATE
    master.write_state()
    deadline = time.monotonic() + _LONG_PATIENCE
    while master.state_check(pysoem.OP_STATE, _STATE_US) != pysoem.OP_STATE:
        assert time.monotonic() < deadline
        cycle(master)


def cycle(master: Any, timeout_us: int = _TIMEOUT_US) -> int:
    """Exchange process data; return the working counter."""
    master.send_processdata()
    return int(master.receive_processdata(timeout_us))


def command(master: Any, target: int) -> None:
    """Fill the outputs of all slaves."""
    for number, slave in enumerate(master.slaves):
        outputs = struct.pack('<Hi', 15, target + number)
        slave.output = outputs + bytes(len(slave.output) - len(outputs))


def inputs(master: Any) -> list[tuple[int, int]]:
    """Return tick and position of all slaves."""
    return [struct.unpack_from('<Hi', slave.input) for slave in master.slaves]


def states(master: Any) -> list[tuple[int, int]]:
    """Return AL status and AL status code of all slaves."""
    master.read_state()
    return [(slave.state, slave.al_status) for slave in master.slaves]


def soem(number: str, filler: str = '0') -> Mapping[str, Any]:
    """Bring slaves up with clocks and exchange process data."""
    with served('-n', number, '--filler', filler):
        master = opened()
        has_clocks = bool(master.config_dc())
        operate(master)
        counters, times = [], []
        for k in range(_CYCLES):
            command(master, k)
            counters.append(cycle(master))
            times.append(master.dc_time)
        found = {
            'names': [slave.name for slave in master.slaves],
            'ids': [(slave.man, slave.id, slave.rev) for slave in master.slaves],
            'expected': master.expected_wkc, 'counters': sorted(set(counters)),
            'inputs': inputs(master), 'has_clocks': has_clocks,
            'steps_ns': sorted({b - a for a, b in zip(times, times[1:])}),
            'age_s': time.time() - 946_684_800 - times[0] * 1e-9, 'states': states(master)}
        master.close()
    return found


def objects() -> Mapping[str, Any]:
    """Read and write objects in every way that pysoem has."""
    with served():
        master = opened()
        slave = master.slaves[0]
        text = bytes(33 + k % 90 for k in range(650))
        slave.sdo_write(0x2001, 0, text)
        slave.sdo_write(0x2000, 0, struct.pack('<f', 2.5))
        found = {
            'name': slave.sdo_read(0x1008, 0).decode(),
            'gain': struct.unpack('<f', slave.sdo_read(0x2000, 0))[0],
            'is_text_back': slave.sdo_read(0x2001, 0, _LONG) == text,
            'identity': slave.sdo_read(0x1018, 0, ca=True).hex(),
            'dictionary': {one.index: [one.name.decode(), len(one.entries)] for one in slave.od},
            'aborts': [_abort(slave.sdo_read, *key) for key in (
                (0x9999, 0), (0x1018, 9), (0x2002, 0))]
            + [_abort(slave.sdo_write, 0x1000, 0, bytes(4)),
               _abort(slave.sdo_write, 0x2000, 0, bytes(2))],
            'file': _mailbox_error(slave)}
        master.close()
    return found


def _abort(access: Callable[..., Any], *arguments: Any) -> int:
    try:
        access(*arguments)
    except pysoem.SdoError as error:
        return int(error.abort_code)
    return 0


def _mailbox_error(slave: Any) -> int:
    """Return the detail of the mailbox error by which a file is refused."""
    try:
        slave.foe_read('firmware', 0, 100, 100_000)
    except pysoem.MailboxError as error:
        return int(error.error_code)
    return 0


def kick(number: str) -> Mapping[str, Any]:
    """Bring slaves up with KickCAT and exchange process data."""
    with served('-n', number):
        bus = _kick_bus()
        bus.create_mapping(4096)
        slaves = bus.slaves()
        identity = bus.read_sdo(slaves[0], 0x1018, 0, kickcat.COMPLETE, 100, _PATIENCE).hex()
        bus.request_state(kickcat.State.SAFE_OP)
        bus.wait_for_state(kickcat.State.SAFE_OP, _PATIENCE)
        bus.process_data()
        bus.request_state(kickcat.State.OPERATIONAL)
        bus.process_data()
        bus.wait_for_state(kickcat.State.OPERATIONAL, _PATIENCE)
        for k in range(_CYCLES):
            for position, slave in enumerate(slaves):
                slave.set_output_bytes(struct.pack('<Hi', 15, k + position))
            bus.process_data()  # raises where a working counter is wrong
        return {'sizes': [(slave.input_size, slave.output_size) for slave in slaves],
                'identity': identity,
                'inputs': [struct.unpack_from('<Hi', slave.input_data) for slave in slaves]}


def _kick_bus() -> Any:
    """
    Return a bus of KickCAT that has found its slaves.

    After each broadcast it waits for its whole timeout, some 150 times. On a busy host an answer
    can be later than a short one, and the SII later than KickCAT's own limit: it is tried again.
    """
    for timeout in _KICK_SETUP:
        link = kickcat.create_link(MASTER, '')
        link.set_timeout(timeout)
        bus = kickcat.Bus(link)
        try:
            bus.init(0.1)
        except RuntimeError as error:
            print(f'with {timeout} s: {error}', file=sys.stderr)
            continue
        link.set_timeout(_KICK_CYCLE)
        return bus
    raise AssertionError('no slaves found')


def lost(nth: str) -> Mapping[str, Any]:
    """Exchange process data while answers are lost."""
    with served('--lose', nth):
        master = opened()
        operate(master)
        cycle(master)
        first, counters = inputs(master)[0][0], []
        for k in range(_CYCLES):
            command(master, k)
            counters.append(cycle(master))
        command(master, 0)
        while cycle(master) < 0:
            pass
        return {'expected': master.expected_wkc, 'counters': Counter(counters),
                'ticks': inputs(master)[0][0] - first, 'states': states(master)}


def silence(wall: str, pause: str) -> Mapping[str, Any]:
    """Exchange no process data for a while in operation, at most ``pause``; then recover."""
    with served('-n', '2', '--wall', wall):
        master = opened()
        operate(master)
        deadline = time.monotonic() + float(pause)
        while (after := states(master)) == 2 * [(pysoem.OP_STATE, 0)] and (
                time.monotonic() < deadline):
            pass  # reading states is no process data
        cycle(master)
        for slave in master.slaves:
            slave.state = pysoem.SAFEOP_STATE + pysoem.STATE_ACK
            slave.write_state()
        acknowledged = states(master)
        operate(master)
        return {'after': after, 'acknowledged': acknowledged, 'recovered': states(master),
                'counter': cycle(master) == master.expected_wkc}


def slow(wall: str) -> Mapping[str, Any]:
    """Exchange process data with a plant that is slower than the master's timeout."""
    with served('--slow', wall):
        master = opened()
        operate(master)
        patience_us = round(_PATIENCE * 1e6)
        assert cycle(master, patience_us) == master.expected_wkc
        first, counters = inputs(master)[0][0], []
        for k in range(_FEW):
            command(master, k)
            counters.append(cycle(master, int(float(wall) * 1e6 / 4)))
        last = cycle(master, patience_us)
        return {'counters': counters, 'last': last, 'expected': master.expected_wkc,
                'ticks': inputs(master)[0][0] - first, 'cycles': len(counters) + 1}


def interface() -> Mapping[str, Any]:
    """Use interfaces that are missing, the loopback, down, or fail during a run."""
    errors = [_refusal(name) for name in ('absent', '', 'x' * 20, 'lo')]
    line = EthercatLine(Ring([Toy()], STEP_NS), open_interface(SLAVES), SLAVES)
    master = open_interface(MASTER)
    _set(SLAVES, 'down')
    errors.append(_refusal(SLAVES))
    is_tick_while_down = line.serve(_PATIENCE)
    _set(SLAVES, 'up')
    counters = _lost_links(master, line)
    subprocess.run(['ip', 'link', 'del', SLAVES], check=True)
    try:
        line.serve(_SHORT)
    except RunError as error:
        errors.append(str(error))
    line.close()
    return {'errors': errors, 'lost links': list(counters), 'tick': is_tick_while_down}


def _lost_links(master: socket.socket, line: EthercatLine) -> bytes:
    """Read the counters of lost links; a frame is lost while an interface comes up."""
    master.settimeout(_SHORT)
    deadline = time.monotonic() + _LONG_PATIENCE
    while time.monotonic() < deadline:
        master.send(frame_of([Sent(1, at(0, 0x0310), bytes(4))]))
        line.serve(_SHORT)
        with suppress(TimeoutError):
            return answers_in(master.recv(_BUFFER))[0].data
    raise TimeoutError(f'no answer on {MASTER}')


def _refusal(name: str) -> str:
    """Return why an interface cannot be used."""
    try:
        open_interface(name).close()
    except ConfigError as error:
        return str(error)
    return ''


def _set(name: str, state: str) -> None:
    subprocess.run(['ip', 'link', 'set', name, state], check=True)


if __name__ == '__main__':
    make_interfaces()
    print(json.dumps(globals()[sys.argv[1]](*sys.argv[2:])))
