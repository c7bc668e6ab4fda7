"""Slaves without a plant, the floor of a bus: `python -m ... CONFIG INTERFACE`, until Ctrl-C."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
import sys

from isa_ros.config.runs.run_file import load_run
from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.ethercat import ethercat_line
from isa_ros.fieldbus.request import PROFILES
import numpy as np


def main(arguments: Sequence[str]) -> None:
    """Serve cycles; every tick has the same sample."""
    config, interface = arguments
    run = load_run(Path(config))
    devices = devices_of(run, PROFILES[0])
    samples, commands = (np.zeros(len(devices), kind) for kind in (SAMPLE, COMMAND))
    line = ethercat_line(devices, interface, run.step_ns)
    print('wait for a master', file=sys.stderr, flush=True)
    tick = 0
    with suppress(KeyboardInterrupt):
        while True:
            for device, sample in zip(devices, samples):
                device.take_sample(sample, tick)
            line.update()
            while not line.serve(1.0):
                pass
            for device, command in zip(devices, commands):
                device.fill_command(command)
            tick += 1
    line.close()


if __name__ == '__main__':
    main(sys.argv[1:])
