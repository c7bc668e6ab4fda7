"""The device that a master sees: objects, profiles and states of one actuator."""
