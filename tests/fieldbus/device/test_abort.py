"""Abort codes of SDO transfers."""

from isa_ros.fieldbus.device import abort
import pytest


def test_every_code_has_a_meaning():
    codes = {value for name, value in vars(abort).items() if name.isupper() and name != 'MEANINGS'}
    assert codes == set(abort.MEANINGS)


def test_a_refusal_shows_its_code_as_the_standard_prints_it():
    refused = abort.SdoAbort(abort.NO_OBJECT)
    assert refused.code == 0x06020000
    assert str(refused) == '0x06020000: object does not exist in the object dictionary'


def test_a_code_of_no_standard_is_not_raised():
    with pytest.raises(KeyError):
        abort.SdoAbort(1)


@pytest.mark.parametrize('code', abort.MEANINGS)
def test_the_codes_are_those_of_the_canopen_package(code):
    """`canopen` shows its own words for nearly all codes of CiA 301."""
    canopen = pytest.importorskip('canopen')
    assert code in canopen.sdo.exceptions.SdoAbortedError.CODES or code in (
        abort.NOT_EMPTIED_FIRST, abort.NO_COMPLETE_ACCESS)
