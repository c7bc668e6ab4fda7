"""What is commanded at which tick: setpoints, waveforms, the trot."""
