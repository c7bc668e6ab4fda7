"""Objects 0x1010 and 0x1011: nothing is stored, and the defaults are restored by a reset."""

from isa_ros.fieldbus.device.abort import NOT_TRANSFERABLE, READ_ONLY, SdoAbort
import pytest

from ..rig import Master, Rig

LOAD, SAVE = int.from_bytes(b'load', 'little'), int.from_bytes(b'save', 'little')


@pytest.fixture(scope='module')
def master():
    return Master(Rig())


@pytest.mark.parametrize('group', [1, 2, 3])
def test_load_is_accepted_before_a_reset(master, group):
    assert (master.upload(0x1011, group), master.upload(0x1010, group)) == (1, 0)
    master.download(0x6066, 0, 7)
    master.download(0x1011, group, LOAD)
    assert (master.upload(0x1011, group), master.upload(0x6066)) == (1, 7)
    master.device.restart(is_whole=True)
    assert master.upload(0x6066) == 0


@pytest.mark.parametrize(('index', 'subindex', 'value', 'code'), [
    (0x1011, 1, SAVE, NOT_TRANSFERABLE), (0x1010, 1, SAVE, NOT_TRANSFERABLE),
    (0x1010, 3, LOAD, NOT_TRANSFERABLE), (0x1011, 0, 3, READ_ONLY)])
def test_everything_else_is_refused(master, index, subindex, value, code):
    with pytest.raises(SdoAbort) as refused:
        master.download(index, subindex, value)
    assert refused.value.code == code
    assert master.upload(0x2003).startswith(f'0x{index:04X}:{subindex}: ')
