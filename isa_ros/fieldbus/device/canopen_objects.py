"""
The communication objects that CANopen adds to an actuator's table, 0x1005 to 0x1FFF.

`communication_objects` and `pdo_parameters` are part of the table, so that dictionary and EDS have
the same; `isa_ros.fieldbus.canopen.communication` keeps their values for one node.
"""

from isa_ros.fieldbus.device.can_identifiers import (
    EMERGENCY, INVALID, RECEIVE, SDO_ANSWER, SDO_REQUEST, SYNC, TRANSMIT)
from isa_ros.fieldbus.device.objects import (
    DataType, Object, ObjectCode, ObjectEntry, record_of, variable)

SYNC_ID, CYCLE_PERIOD, SYNC_OVERFLOW = 0x1005, 0x1006, 0x1019
EMERGENCY_ID = 0x1014
GUARD_TIME, LIFE_TIME_FACTOR = 0x100C, 0x100D
HEARTBEAT_CONSUMED, HEARTBEAT_PRODUCED = 0x1016, 0x1017
ERROR_BEHAVIOUR = 0x1029
SDO_SERVER = 0x1200
RECEIVE_PARAMETERS, RECEIVE_MAPPINGS = 0x1400, 0x1600
TRANSMIT_PARAMETERS, TRANSMIT_MAPPINGS = 0x1800, 0x1A00
CONSUMERS = 4           # producers of a heartbeat that a node can watch

# Subindices of the parameters of a PDO.
COB_ID, TRANSMISSION, INHIBIT_TIME, EVENT_TIMER, SYNC_START = 1, 2, 3, 5, 6
CANOPEN = 'canopen'
_NS_PER_US = 1000
_MICROSECOND, _MILLISECOND, _INHIBIT = 1e-6, 1e-3, 1e-4     # s of a count
_U8, _U16, _U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32


def communication_objects(step_ns: int) -> list[Object]:
    """Return the services of CANopen without the PDOs, of a run with this tick."""
    cycle_us = step_ns // _NS_PER_US
    return [
        variable(ObjectEntry(SYNC_ID, 0, 'COB-ID SYNC', _U32, 'rw', SYNC, meaning='the tick'),
                 CANOPEN),
        variable(ObjectEntry(CYCLE_PERIOD, 0, 'Communication cycle period', _U32, 'rw', cycle_us,
                             's', _MICROSECOND, choices=(0, cycle_us),
                             meaning='the tick; 0: not checked'), CANOPEN),
        variable(ObjectEntry(GUARD_TIME, 0, 'Guard time', _U16, 'rw', 0, 's', _MILLISECOND,
                             meaning='times 0x100D without a request is a lost bus, in simulated '
                                     'time; 0: off'), CANOPEN),
        variable(ObjectEntry(LIFE_TIME_FACTOR, 0, 'Life time factor', _U8, 'rw',
                             meaning='0: off'), CANOPEN),
        variable(ObjectEntry(EMERGENCY_ID, 0, 'COB-ID EMCY', _U32, 'rw', EMERGENCY, adds_node=True,
                             meaning='bit 31: off'), CANOPEN),
        Object(HEARTBEAT_CONSUMED, 'Consumer heartbeat time', ObjectCode.ARRAY, (
            ObjectEntry(HEARTBEAT_CONSUMED, 0, 'Highest subindex', _U8, 'const', CONSUMERS),
            *(ObjectEntry(HEARTBEAT_CONSUMED, k, f'Consumer heartbeat time {k}', _U32, 'rw',
                          meaning='node in bits 16 to 22, ms of simulated time in the low '
                                  'word; 0: off')
              for k in range(1, CONSUMERS + 1))), CANOPEN),
        variable(ObjectEntry(HEARTBEAT_PRODUCED, 0, 'Producer heartbeat time', _U16, 'rw', 0, 's',
                             _MILLISECOND, meaning='wall time; 0: off'), CANOPEN),
        variable(ObjectEntry(SYNC_OVERFLOW, 0, 'Synchronous counter overflow value', _U8, 'rw',
                             meaning='0: SYNC without a counter; 2 to 240: the highest counter'),
                 CANOPEN),
        record_of(ERROR_BEHAVIOUR, 'Error behaviour', [
            ObjectEntry(ERROR_BEHAVIOUR, 1, 'Communication error', _U8, 'rw', choices=(0, 1, 2),
                        meaning='0: preoperational, 1: no change, 2: stopped')], CANOPEN),
        record_of(SDO_SERVER, 'SDO server parameter', [
            ObjectEntry(SDO_SERVER, 1, 'COB-ID client to server', _U32, 'const', SDO_REQUEST,
                        adds_node=True),
            ObjectEntry(SDO_SERVER, 2, 'COB-ID server to client', _U32, 'const', SDO_ANSWER,
                        adds_node=True)], CANOPEN)]


def pdo_parameters(mapping: int, *, is_on: bool) -> Object:
    """Return the communication parameters of the PDO with this mapping; on at power-on or not."""
    if mapping < TRANSMIT_MAPPINGS:
        place, index, bases = mapping - RECEIVE_MAPPINGS, RECEIVE_PARAMETERS, RECEIVE
        kinds = '0 to 240: with the next SYNC; 254, 255: at once'
        timer = 'simulated time without it that is an error; 0: off'
    else:
        place, index, bases = mapping - TRANSMIT_MAPPINGS, TRANSMIT_PARAMETERS, TRANSMIT
        kinds = '0: after a SYNC, if changed; n to 240: after every n-th; 254, 255: if changed'
        timer = 'of types 254 and 255: longest time between two; 0: off'
    index += place
    is_transmit = bases is TRANSMIT
    rows = [
        ObjectEntry(index, COB_ID, 'COB-ID', _U32, 'rw', bases[place] | (0 if is_on else INVALID),
                    adds_node=True, meaning='bit 31: off'),
        ObjectEntry(index, TRANSMISSION, 'Transmission type', _U8, 'rw', 1, meaning=kinds)]
    if is_transmit:
        rows.append(ObjectEntry(index, INHIBIT_TIME, 'Inhibit time', _U16, 'rw', 0, 's', _INHIBIT,
                                meaning='of types 254 and 255: shortest time between two'))
    rows.append(ObjectEntry(index, EVENT_TIMER, 'Event timer', _U16, 'rw', 0, 's', _MILLISECOND,
                            meaning=timer))
    if is_transmit:
        rows.append(ObjectEntry(index, SYNC_START, 'SYNC start value', _U8, 'rw',
                                meaning='counter of the first SYNC; 0: any'))
    return record_of(index, f'{"TPDO" if is_transmit else "RPDO"} {place + 1} communication '
                     'parameter', rows, CANOPEN)
