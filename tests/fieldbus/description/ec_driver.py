"""
What `ethercat_driver_ros2` does with its files, written down from its public sources (52be2c2).

A channel has one of the types below and an index; a command c becomes factor c + offset, cut to a
whole number, and NaN or no interface leaves ``default``; a state is factor value + offset. The
plugin of CiA 402 reads status word, mode and position by their index, gives the control word that
leads to operation enabled, and holds the last position until a position is commanded in mode 8.
It counts channels without gaps, so that a gap shifts every channel behind it.
"""

from collections.abc import Mapping, Sequence
import math
from pathlib import Path
import struct
from typing import Any
from xml.etree import ElementTree

import yaml

TYPES = {'bool': '?', 'int8': 'b', 'uint8': 'B', 'int16': 'h', 'uint16': 'H', 'int32': 'i',
         'uint32': 'I', 'int64': 'q', 'uint64': 'Q'}
KEYS = {
    'slave': {'vendor_id', 'product_id', 'assign_activate', 'auto_fault_reset',
              'auto_state_transitions', 'sm', 'sdo', 'rpdo', 'tpdo'},
    'sm': {'index', 'type', 'pdo', 'watchdog'}, 'pdo': {'index', 'channels'},
    'rpdo': {'index', 'sub_index', 'type', 'command_interface', 'default', 'factor', 'offset',
             'mask'},
    'tpdo': {'index', 'sub_index', 'type', 'state_interface', 'factor', 'offset', 'mask'}}
CONTROL, STATUS, MODE_SHOWN, TARGET, POSITION = 0x6040, 0x6041, 0x6061, 0x607A, 0x6064
CSP = 8
NEXT = ((0x4F, 0x40, 0x06), (0x6F, 0x21, 0x07), (0x6F, 0x23, 0x0F))
"""Mask and value of the status word, and the control word that follows."""


def check_slave(config: Mapping[str, Any]) -> None:
    """Assert what the plugin asks of a file."""
    assert set(config) <= KEYS['slave'] and config['vendor_id'] and config['product_id']
    assert [one['index'] for one in config['sm']] == [0, 1, 2, 3]
    for one in config['sm']:
        assert set(one) <= KEYS['sm'] and one['type'] == ('output', 'input')[one['index'] % 2]
        assert one.get('pdo') in (None, 'rpdo', 'tpdo')
    for side in ('rpdo', 'tpdo'):
        for pdo in config[side]:
            assert set(pdo) == KEYS['pdo']
            for channel in pdo['channels']:
                assert set(channel) <= KEYS[side], channel
                assert channel['index'] >= 0x1000 and channel['type'] in TYPES, channel
                assert isinstance(channel.get('factor', 1.0), float), channel


class EcDriver:
    """The driver of one joint of a tag: its interfaces are ``commands`` and ``states``."""

    def __init__(self, tag: Path, joint: str) -> None:
        root = ElementTree.parse(tag).getroot()
        assert root.tag == 'robot'
        own, = (one for one in root.iterfind('ros2_control/joint') if one.get('name') == joint)
        module = own.find('ec_module')
        assert module is not None
        parameters = {one.get('name'): one.text for one in module.iterfind('param')}
        assert module.findtext('plugin') == 'ethercat_generic_plugins/EcCiA402Drive'
        self.frequency = float(root.findtext('ros2_control/hardware/param[2]') or 'nan')
        self.place = float(parameters['position'] or 'nan')
        assert float(parameters['alias'] or 'nan') == 0.0
        self.mode = float(parameters['mode_of_operation'] or 'nan')
        self.config = yaml.safe_load(Path(parameters['slave_config'] or '').read_text())
        check_slave(self.config)
        self.commands = {one.get('name'): math.nan for one in own.iterfind('command_interface')}
        self.states = {one.get('name'): math.nan for one in own.iterfind('state_interface')}
        self._status = self._shown = 0
        self._position = 0.0

    def channels(self, side: str) -> Sequence[Mapping[str, Any]]:
        """Return the channels of the only PDO of a side."""
        pdo, = self.config[side]
        channels: Sequence[Mapping[str, Any]] = pdo['channels']
        return channels

    def mapping(self, side: str) -> list[int]:
        """Return the words that the master writes into the mapping."""
        return [one['index'] << 16 | one['sub_index'] << 8
                | 8 * struct.calcsize(f'<{TYPES[one["type"]]}') for one in self.channels(side)]

    def outputs(self) -> bytes:
        """Return the process data of a cycle."""
        return b''.join(struct.pack(f'<{TYPES[one["type"]]}', int(self._output(one)))
                        for one in self.channels('rpdo'))

    def _output(self, channel: Mapping[str, Any]) -> float:
        factor, offset = channel.get('factor', 1.0), channel.get('offset', 0.0)
        default = float(channel.get('default', math.nan))
        wanted = self.commands.get(channel.get('command_interface'), math.nan)
        if channel['index'] == CONTROL:
            default = next((control for mask, value, control in NEXT
                            if self._status & mask == value), default)
            if self._status & 0x6F == 0x27:
                default = 0x0F
        elif channel['index'] == TARGET:
            default = factor * self._position + offset if self._shown else 0.0
            if self._shown != CSP:
                wanted = math.nan
        elif channel['index'] == 0x6060:
            default = self.mode
        return default if math.isnan(wanted) else factor * wanted + offset

    def take(self, data: bytes) -> None:
        """Take the process data of the slave."""
        for one in self.channels('tpdo'):
            layout = struct.Struct(f'<{TYPES[one["type"]]}')
            value = one.get('factor', 1.0) * layout.unpack_from(data)[0] + one.get('offset', 0.0)
            data = data[layout.size:]
            if one.get('state_interface') in self.states:
                self.states[one['state_interface']] = value
            if one['index'] == STATUS:
                self._status = int(value)
            elif one['index'] == MODE_SHOWN:
                self._shown = int(value)
            elif one['index'] == POSITION:
                self._position = value
        assert not data

    @property
    def is_enabled(self) -> bool:
        """Return whether the drive is in operation enabled."""
        return self._status & 0x6F == 0x27
