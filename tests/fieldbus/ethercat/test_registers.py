"""Registers as data: complete, without overlap, and what the docs say of them."""

from pathlib import Path

from isa_ros.fieldbus.ethercat import registers
from isa_ros.fieldbus.ethercat.registers import Register, REGISTERS, table, writable
import pytest
from tests.fieldbus.ethercat.raw_master import RawMaster

PAGE = Path(__file__).parents[3] / 'docs' / 'ethercat.md'


def test_every_register_is_in_the_list_in_order():
    named = [one for one in vars(registers).values() if isinstance(one, Register)]
    assert sorted(named, key=lambda one: one.address) == list(REGISTERS)


def test_registers_do_not_overlap():
    taken: dict[int, str] = {}
    for one in REGISTERS:
        for start in one.starts:
            for address in range(start, start + one.size):
                assert address not in taken, (one, taken[address])
                taken[address] = one.name


OWN = (registers.DL_STATUS, registers.SYNC_MANAGER_STATUS, registers.SYNC_MANAGER_PDI)
"""Show the place in the ring, buffers without content, and the locks of the application."""


@pytest.mark.parametrize(
    'register', [one for one in REGISTERS if one not in OWN], ids=lambda one: one.name)
def test_a_master_finds_the_value_at_power_on(register):
    assert RawMaster().number(register.address, register.size) == register.reset


@pytest.mark.parametrize('register', REGISTERS, ids=lambda one: one.name)
def test_access_is_as_declared(register):
    master = RawMaster()
    before = master.read(register.address, register.size)
    counter = master.write(register.address, before)
    assert counter == (0 if register.access == registers.READ else 1)
    assert set(writable()[register.address:register.address + register.size]) == {
        {'r': 0, 'rw': 1, 'clear': 2}[register.access]}


def test_the_page_has_the_table_of_the_code():
    assert '\n'.join(table()) in PAGE.read_text(encoding='utf-8')
