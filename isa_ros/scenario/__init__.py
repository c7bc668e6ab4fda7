"""Commands by tick: setpoints, waveforms, the trot."""
