"""The actuators of a run as devices on a real bus: EtherCAT, CANopen, serial."""
