"""The tables of the page about the objects."""

import isa_ros
from isa_ros.fieldbus.description.object_page import object_rows, table_lines, tables
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.device.objects import ObjectCode

LEG = isa_ros.load('leg').configuration


def test_every_entry_but_a_constant_subindex_0_is_in_a_row():
    device = devices_of(LEG)[-1]
    shown = set()
    for index, subindex, *_ in object_rows(device.table.objects)[1:]:
        first, _, last = index.partition('..')
        low, _, high = subindex.partition('..')
        for k in range(int(first, 16), int(last or first, 16) + 1):
            shown |= {(k, j) for j in range(int(low), int(high or low) + 1)}
    entries = {(one.index, one.subindex) for one in device.table.entries}
    hidden = {(one.index, 0) for one in device.table
              if one.kind is not ObjectCode.VAR and one.entries[0].access == 'const'}
    assert entries - hidden <= shown <= entries


def test_objects_that_differ_by_their_number_share_rows():
    rows = object_rows(devices_of(LEG)[0].table.objects)
    assert ('0x1600..0x1603', '1..8', 'RPDO n mapping: entries') in [row[:3] for row in rows]
    assert ('0x1018', '1', 'Identity: Vendor id') in [row[:3] for row in rows]


def test_a_table_of_a_device_is_aligned_and_has_its_scale():
    lines = table_lines(devices_of(LEG)[0])
    assert next(line for line in lines if line.startswith('0x6077')).split()[-3:] == [
        'tx', 'Nm', '0.17']


def test_a_table_of_a_device_has_the_numbers_of_the_mit_ranges():
    """Stroke and rated torque of the HAA; ten times its gains, 300 Nm/rad and 20 Nms/rad."""
    device = devices_of(LEG)[0]
    lines = [line.split() for line in table_lines(device) if line.startswith('0x2002')]
    at = {line[1]: line for line in lines}
    assert '3000' in at['3'] and '200' in at['4'] and '170' in at['5']
    assert next(line for line in table_lines(device) if line.startswith('0x6041')).endswith('tx')


def test_every_table_of_the_page_has_a_header_and_full_rows():
    for rows in tables(devices_of(LEG)[-1], devices_of(LEG, 'cia408')[-1]).values():
        header, *body = rows()
        assert body
        assert {len(row) for row in body} == {len(header)}
