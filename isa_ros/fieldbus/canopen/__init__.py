"""The actuators of a run as nodes of a CAN bus: CANopen (CiA 301) and MIT-mode frames."""
