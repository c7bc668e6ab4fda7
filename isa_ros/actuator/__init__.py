"""One smart actuator: data sheet, kernel of a tick, memory, commands, tuning."""
