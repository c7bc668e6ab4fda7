"""The connection of an actuator to the bus of `isa bus`, and what can be wrong with it."""

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, Parameters


@frozen(kw_only=True)
class BusPort(Parameters):
    """Faults of a connection, each 1 while it lasts; a scenario sets them (docs/fieldbus.md)."""

    pulled: float = fault(
        'the cable towards the master is pulled', '1', is_whole=True, ge=0.0, le=1.0)
    powerless: float = fault(
        'the device has no supply voltage', '1', is_whole=True, ge=0.0, le=1.0)
    bus_off: float = fault(
        'the CAN controller has left the bus after too many errors', '1',
        is_whole=True, ge=0.0, le=1.0)


SOUND_PORT = BusPort()
PULLED, POWERLESS, BUS_OFF = 'pulled', 'powerless', 'bus_off'
