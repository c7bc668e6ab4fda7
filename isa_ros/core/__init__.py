"""What every other package stands on: kernels, parameters, units, time, signals, contact."""
