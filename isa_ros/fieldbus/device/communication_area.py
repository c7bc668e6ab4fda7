"""Objects 0x1000 to 0x1FFF: identity, errors, and the settings of CANopen and EtherCAT."""

from collections.abc import Mapping

from isa_ros.fieldbus.device.bus_device import Identity, RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT
from isa_ros.fieldbus.device.canopen_objects import pdo_parameters
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.objects import (
    DataType, Object, ObjectCode, ObjectEntry, record_of, variable)
from isa_ros.fieldbus.device.process_data import (
    assignment_object, CAN_PDOS, Mapped, mapping_object, RECEIVE, TRANSMIT)

ERROR_REGISTER = 0x1001
ERROR_FIELD = 0x1003
"""Object with the last errors."""
ERRORS_KEPT = 8
STORE, RESTORE, LOAD = 0x1010, 0x1011, int.from_bytes(b'load', 'little')
"""Objects that store and restore parameters, and the signature of the latter."""
_U8, _U16, _U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32
_PDOS_ON = 2
"""PDOs of CANopen in each direction that are on at power-on."""
_NANOSECOND = 1e-9
_FREE_RUN, _SYNC_MANAGER, _SYNC0 = 0, 1, 2


def identity_objects(
        device_type: int, identity: Identity, name: str, model: str, version: str
        ) -> list[Object]:
    """Return the objects that say what the device is."""
    text = DataType.VISIBLE_STRING
    return [
        variable(ObjectEntry(0x1000, 0, 'Device type', _U32, 'const', device_type,
                             meaning='profile number in the low word')),
        variable(ObjectEntry(0x1008, 0, 'Manufacturer device name', text, 'const', name)),
        variable(ObjectEntry(0x1009, 0, 'Manufacturer hardware version', text, 'const', model)),
        variable(ObjectEntry(0x100A, 0, 'Manufacturer software version', text, 'const', version)),
        record_of(0x1018, 'Identity', [
            ObjectEntry(0x1018, 1, 'Vendor id', _U32, 'const', identity.vendor,
                        meaning='placeholder, not assigned'),
            ObjectEntry(0x1018, 2, 'Product code', _U32, 'const', identity.product,
                        meaning='profile, and a hash of the kind of actuator'),
            ObjectEntry(0x1018, 3, 'Revision number', _U32, 'const', identity.revision),
            ObjectEntry(0x1018, 4, 'Serial number', _U32, 'const', identity.serial,
                        meaning='place in the run file')])]


def parameter_objects() -> list[Object]:
    """Return the objects that store and restore parameters: nothing is stored."""
    groups = ('All parameters', 'Communication parameters', 'Application parameters')

    def of(index: int, name: str, default: int, meaning: str) -> Object:
        return record_of(index, name, [
            ObjectEntry(index, k, group, _U32, 'rw', default, meaning=meaning)
            for k, group in enumerate(groups, 1)])
    return [
        of(STORE, 'Store parameters', 0, 'nothing is stored: what to keep is in the run file'),
        of(RESTORE, 'Restore default parameters', 1,
           '"load" (0x64616F6C): accepted, since every reset restores the defaults')]


def error_objects() -> list[Object]:
    """Return the objects of errors."""
    count = ObjectEntry(ERROR_FIELD, 0, 'Number of errors', _U8, 'rw', meaning='0 deletes them',
                        choices=(0,))
    return [
        variable(ObjectEntry(ERROR_REGISTER, 0, 'Error register', _U8, pdo='tx',
                             meaning='bits: 0 any, 1 current, 2 voltage, 3 temperature, '
                                     '4 communication, 5 profile, 7 manufacturer')),
        Object(ERROR_FIELD, 'Pre-defined error field', ObjectCode.ARRAY, (count, *(
            ObjectEntry(ERROR_FIELD, k, f'Error {k}', _U32,
                        meaning='newest first, code in the low word')
            for k in range(1, ERRORS_KEPT + 1))))]


def pdo_objects(pdos: Mapping[int, Mapped], entries: dict[Key, ObjectEntry]) -> list[Object]:
    """Return mappings, assignments and PDO parameters; ``pdos`` are the mappings by index."""
    return [
        *(mapping_object(pdo, mapped, entries) for pdo, mapped in pdos.items()),
        *(assignment_object(one, pdos) for one in (RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT)),
        *(pdo_parameters(first + place, is_on=place < _PDOS_ON and bool(pdos[first + place]))
          for first in (RECEIVE, TRANSMIT) for place in range(CAN_PDOS))]


def ethercat_objects(step_ns: int) -> list[Object]:
    """Return the objects of EtherCAT's sync managers."""
    types = ('mailbox from the master', 'mailbox to the master',
             'process data from the master', 'process data to the master')
    return [
        Object(0x1C00, 'Sync manager types', ObjectCode.ARRAY, (
            ObjectEntry(0x1C00, 0, 'Highest subindex', _U8, 'const', len(types)),
            *(ObjectEntry(0x1C00, k + 1, f'Sync manager {k}', _U8, 'const', k + 1, meaning=meaning)
              for k, meaning in enumerate(types))), 'ethercat'),
        *(_sync_object(0x1C30 + manager, manager, step_ns) for manager in (2, 3))]


def _sync_object(index: int, manager: int, step_ns: int) -> Object:
    return record_of(index, f'Sync manager {manager} synchronisation', [
        ObjectEntry(index, 1, 'Synchronisation type', _U16, 'rw', _SYNC_MANAGER,
                    choices=(_FREE_RUN, _SYNC_MANAGER, _SYNC0),
                    meaning='0 free run, 1 with the sync manager, 2 with SYNC0: all are one tick '
                            'a frame'),
        ObjectEntry(index, 2, 'Cycle time', _U32, 'rw', step_ns, 's', _NANOSECOND,
                    choices=(0, step_ns), meaning='the tick; another one is refused'),
        ObjectEntry(index, 3, 'Shift time', _U32, 'ro', 0, 's', _NANOSECOND),
        ObjectEntry(index, 4, 'Synchronisation types supported', _U16, 'const', 0b111,
                    meaning='bits by type'),
        ObjectEntry(index, 5, 'Minimum cycle time', _U32, 'const', step_ns, 's', _NANOSECOND)],
        'ethercat')
