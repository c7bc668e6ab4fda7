"""Rows of the table in docs/ethercat.md: what a master sees when something is wrong."""

from pathlib import Path
import struct

import pytest
from tests.fieldbus.ethercat.namespace import run
from tests.fieldbus.ethercat.raw_master import (
    abort_of, at, BRD, FPRD, frame_of, in_state, INIT, LRW, OP, PREOP, SAFEOP, Sent)
from tests.fieldbus.ethercat.seen import row, table
from tests.fieldbus.toys import Toy

PAGE = Path(__file__).parents[3] / 'docs' / 'ethercat.md'
ERROR, ACKNOWLEDGE = 0x10, 0x10


def upload(index: int, subindex: int = 0) -> bytes:
    """Return an initiate upload."""
    return struct.pack('<HBHBI', 0x2000, 0x40, index, subindex, 0)


def download(index: int, data: bytes) -> bytes:
    """Return an expedited download to subindex 0."""
    return struct.pack('<HBHB', 0x2000, 0x23 | (4 - len(data)) << 2, index, 0) + data.ljust(
        4, b'\0')


@row('an answer is lost (pysoem)', 'no frame within its timeout: working counter -1; the tick of '
     'that cycle has passed', 'goes on with the next cycle')
def test_an_answer_is_lost():
    found = run('lost', '50')
    assert found['counters'] == {str(found['expected']): 196, '-1': 4}
    assert found['ticks'] == 201
    assert found['states'] == [[OP, 0]]


@row('a request is lost', 'no frame within its timeout; there is no tick',
     'goes on with the next cycle')
def test_a_request_is_lost():
    master = in_state(OP)
    master.exchange()
    assert not master.line.serve(0.0)
    assert struct.unpack_from('<H', master.exchange()[0].data, 6)[0] == 1


@row('one of several frames of a cycle is lost', 'no answer to it; the tick passes when the next '
     'cycle begins, with the old outputs of the slaves in the lost frame',
     'goes on with the next cycle')
def test_one_of_several_frames_is_lost():
    toys = Toy('a'), Toy('b', 2)
    master = in_state(OP, *toys)
    for k in (1, 2):
        outputs = struct.pack('<Hi', 15, k)
        master.send(Sent(LRW, 0, outputs.ljust(12, b'\0')))
        if k == 1:
            master.send(Sent(LRW, 0x1000, outputs.ljust(12, b'\0')))
    assert master.ticks == 1
    answer = master.send(Sent(LRW, 0, bytes(12)))[0]
    assert master.ticks == 2 and struct.unpack_from('<H', answer.data, 6)[0] == 2
    assert [toy.target for toy in toys] == [2, 1]


@row('the plant is slower than the timeout (pysoem)', 'working counter -1, although each cycle '
     'has its tick', 'waits longer: `receive_processdata(timeout)`')
def test_the_plant_is_slower_than_the_timeout():
    found = run('slow', '0.02')
    assert -1 in found['counters']
    assert found['last'] == found['expected']
    assert found['ticks'] == found['cycles']


@row('the master is silent, frame pace', 'nothing: simulated time stands still', 'goes on')
def test_silence_in_frame_pace_stops_time():
    found = run('silence', '30', '0.2')
    assert found['after'] == [[OP, 0]] * 2


@row('the master is silent, real-time pace (pysoem)', 'AL status 0x14, code 0x001B; drive fault',
     'SAFEOP with acknowledgement (0x14), then OP; then the reset of the drive')
def test_silence_in_real_time_trips_the_watchdog():
    found = run('silence', '0.3', '10')
    assert found['after'] == [[SAFEOP | ERROR, 0x1B]] * 2
    assert found['acknowledged'] == [[SAFEOP, 0]] * 2
    assert found['recovered'] == [[OP, 0]] * 2
    assert found['counter']


@row('outputs of one slave stay away for its watchdog (0x0400, 0x0420) while others have theirs',
     'that slave: AL status 0x14, code 0x001B, 0x0440 is 0, 0x0442 counts',
     'SAFEOP with acknowledgement, then OP')
def test_one_slave_without_outputs_is_lost():
    master = in_state(OP, Toy('a'), Toy('b', 2))
    master.exchange()
    for _ in range(102):
        master.send(Sent(LRW, 0, bytes(12)))
    assert [master.number(0x0130, 2, slave) for slave in range(2)] == [OP, SAFEOP | ERROR]
    assert master.number(0x0134, 2, 1) == 0x001B
    assert (master.number(0x0440, 2, 1), master.number(0x0442, 1, 1)) == (0, 1)
    assert master.request(SAFEOP | ACKNOWLEDGE, 1) == (SAFEOP, 0)
    assert master.request(OP, 1) == (OP, 0)


@row('sync manager 0 or 1 not as in the SII', 'INIT stays: AL status 0x11, code 0x0016',
     'corrects it and acknowledges')
def test_a_wrong_mailbox_is_refused():
    master = in_state(INIT)
    master.write(0x0800, struct.pack('<HHBBBB', 0x1000, 512, 0x26, 0, 1, 0))
    assert master.request(PREOP) == (INIT | ERROR, 0x0016)
    master.write(0x0800, bytes(8))
    master.configure_mailboxes()
    assert master.request(PREOP | ACKNOWLEDGE) == (PREOP, 0)


@row('sync manager 2 not as long as the outputs assigned',
     'PREOP stays: AL status 0x12, code 0x001D', 'corrects it and acknowledges')
def test_wrong_outputs_are_refused():
    master = in_state(PREOP)
    master.configure_process_data(sizes=(7, 6))
    assert master.request(SAFEOP) == (PREOP | ERROR, 0x001D)
    master.write(0x0810, bytes(8))
    master.configure_process_data()
    assert master.request(SAFEOP | ACKNOWLEDGE) == (SAFEOP, 0)


@row('sync manager 3 not as long as the inputs assigned',
     'PREOP stays: AL status 0x12, code 0x001E', 'corrects it and acknowledges')
def test_wrong_inputs_are_refused():
    master = in_state(PREOP)
    master.configure_process_data(sizes=(6, 5))
    assert master.request(SAFEOP) == (PREOP | ERROR, 0x001E)


@row('sync manager 2 or 3 switched off or changed in SAFEOP or OP',
     'AL status 0x12, code 0x001D or 0x001E', 'corrects it, acknowledges, SAFEOP, OP')
def test_a_sync_manager_switched_off_ends_operation():
    for register, code in ((0x0816, 0x001D), (0x081E, 0x001E)):
        master = in_state(OP)
        master.write(register, b'\0')
        assert (master.number(0x0130), master.number(0x0134)) == (PREOP | ERROR, code)


@row('a state is left out: INIT to SAFEOP or OP, PREOP to OP',
     'the state stays with the error bit, code 0x0011', 'acknowledges, asks for the next state')
def test_a_state_left_out_is_refused():
    for state, wanted in ((INIT, SAFEOP), (INIT, OP), (PREOP, OP)):
        assert in_state(state).request(wanted) == (state | ERROR, 0x0011)


@row('a state that does not exist', 'the state stays with the error bit, code 0x0012',
     'acknowledges')
def test_an_unknown_state_is_refused():
    assert in_state(PREOP).request(6) == (PREOP | ERROR, 0x0012)


@row('BOOTSTRAP', 'INIT stays: AL status 0x11, code 0x0013', 'acknowledges')
def test_bootstrap_is_refused():
    assert in_state(INIT).request(3) == (INIT | ERROR, 0x0013)


@row('any state but INIT without acknowledgement after an error', 'nothing changes',
     'acknowledges: bit 4 of AL control')
def test_an_error_waits_for_its_acknowledgement():
    master = in_state(PREOP)
    master.request(6)
    assert master.request(PREOP) == (PREOP | ERROR, 0x0012)
    assert master.request(PREOP | ACKNOWLEDGE) == (PREOP, 0)


@row('SYNC0 with another cycle time than the tick', 'PREOP stays: AL status 0x12, code 0x0036',
     'sets the step of the simulation as cycle time')
def test_another_cycle_time_is_refused():
    master = in_state(PREOP)
    master.configure_process_data()
    master.write(0x09A0, struct.pack('<I', 500_000))
    master.write(0x0981, b'\x03')
    assert master.request(SAFEOP) == (PREOP | ERROR, 0x0036)


@row('a watchdog shorter than a tick', 'PREOP stays: AL status 0x12, code 0x001F',
     'sets 0x0420, or 0 to switch it off')
def test_a_watchdog_shorter_than_a_tick_is_refused():
    master = in_state(PREOP)
    master.configure_process_data()
    master.write(0x0420, b'\x01\0')
    assert master.request(SAFEOP) == (PREOP | ERROR, 0x001F)


@row('an object or subindex that does not exist',
     'SDO abort 0x06020000 or 0x06090011')
def test_an_unknown_object_is_refused():
    master = in_state(PREOP)
    assert abort_of(master.ask(upload(0x9999))) == 0x06020000
    assert abort_of(master.ask(upload(0x1018, 9))) == 0x06090011


@row('a value written to what is read only, or of a wrong length',
     'SDO abort 0x06010002, 0x06070012 or 0x06070013')
def test_a_wrong_write_is_refused():
    master = in_state(PREOP)
    assert abort_of(master.ask(download(0x1000, b'\0' * 4))) == 0x06010002
    assert abort_of(master.ask(download(0x2002, b'\0' * 4))) == 0x06070012
    assert abort_of(master.ask(download(0x2002, b'\0'))) == 0x06070013


@row('PDOs assigned or mapped anew in SAFEOP or OP', 'SDO abort 0x08000022',
     'does it in PREOP, before sync managers are set')
def test_mappings_are_for_preop():
    master = in_state(OP)
    assert abort_of(master.ask(download(0x1C12, b'\0'))) == 0x08000022


@row('a mail longer than the mailbox (its length)', 'mailbox error 8, invalid size')
def test_a_mail_that_is_too_long_is_refused():
    master = in_state(PREOP)
    assert master.post(upload(0x1000), length=251) == 1
    assert master.fetch() == (0, struct.pack('<HH', 1, 8))


@row('an SDO longer than 65536 bytes', 'SDO abort 0x05040005')
def test_an_sdo_that_is_too_long_is_refused():
    master = in_state(PREOP)
    request = struct.pack('<HBHBI', 0x2000, 0x21, 0x2001, 0, 65537) + bytes(200)
    assert abort_of(master.ask(request)) == 0x05040005


@row('a mail of another protocol: AoE, EoE, FoE, SoE, VoE',
     'mailbox error 2, unsupported protocol')
@pytest.mark.parametrize('kind', [1, 2, 4, 5, 15])
def test_other_protocols_are_refused(kind):
    master = in_state(PREOP)
    master.post(bytes(12), kind)
    assert master.fetch() == (0, struct.pack('<HH', 1, 2))


@row('mails while 17 answers wait unread', 'working counter 0: the mailbox is full (0x0805)',
     'reads its answers')
def test_a_full_mailbox_refuses():
    master = in_state(PREOP)
    while master.post(upload(0x1000), counter=0):
        pass
    assert master.number(0x0805, 1) & 8
    for _ in range(2):
        assert master.fetch() is not None
    assert master.post(upload(0x1000), counter=0) == 1


@row('a read of the mailbox while there is no mail', 'working counter 0', 'looks at 0x080D first')
def test_an_empty_mailbox_is_not_read():
    master = in_state(PREOP)
    assert master.send(Sent(1, at(0, 0x1100), bytes(256)))[0].counter == 0


@row('the answer of a mail is lost', 'working counter -1',
     'changes bit 1 of 0x080E: the mail is there again')
def test_a_lost_mail_is_repeated():
    master = in_state(PREOP)
    master.post(upload(0x1000))
    first = master.read(0x1100, 256)
    master.write(0x080E, b'\x03')
    assert master.read(0x1100, 256) == first


@row('process data below SAFEOP', 'working counter without that slave', 'goes to SAFEOP')
def test_process_data_below_safeop_do_not_count():
    master = in_state(OP, Toy('a'), Toy('b', 2))
    master.request(PREOP, 1)
    assert [one.counter for one in master.exchange()] == [3, 0]


@row('a frame that ends before its datagrams do',
     'the frame comes back as it was; 0x030C counts')
def test_a_frame_that_is_too_short_is_counted():
    master = in_state(INIT)
    frame = bytearray(frame_of([Sent(BRD, 0, bytes(4))]))
    frame[22] = 100
    master.wire.incoming.append(bytes(frame))
    master.line.serve(0.0)
    assert master.wire.outgoing[-1][16:] == bytes(frame[16:])
    assert master.number(0x030C, 1) == 1


@row('the interface goes down and up', 'frames are lost; 0x0310 of the first slave counts',
     'goes on, after its watchdog as above')
def test_a_lost_link_is_counted():
    assert run('interface')['lost links'] == [1, 0, 0, 0]


@row('a slave at an address that does not exist', 'working counter 0')
def test_an_absent_slave_does_not_count():
    assert in_state(PREOP).send(Sent(FPRD, at(4711, 0x0130), bytes(2)))[0].counter == 0


def test_the_page_has_these_rows():
    from tests.fieldbus.ethercat import test_cables     # noqa: F401, has rows too
    assert '\n'.join(table()) in PAGE.read_text(encoding='utf-8')
