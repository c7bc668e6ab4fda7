"""One long run in one process: its memory stays flat, and tick, `/clock` and log time agree."""

from pathlib import Path
import re
import struct
import time
from typing import NamedTuple

from isa_ros.bag.reader import Bag
import numpy as np
from tests.ros.faults import ONE_SECOND_NS
from tests.ros.started import bringup, RIG, Started, wait_for

LOOK_S = 0.25
WARM_UP = 0.25  # part of the run in which every buffer finds its size
STEP_NS = 1_000_000
_STAMP = struct.Struct('<iI')  # of /clock, behind four bytes of CDR header
_STORAGE = '\nrecord: {compression: lz4, split_mb: 100}\n'


class LongRun(NamedTuple):
    """Duration and memory of a long run."""

    simulated_s: float
    elapsed_s: float
    least_mb: float
    """Resident memory after the warm-up."""
    most_mb: float
    growth_mb_per_h: float
    """Slope of a straight line through resident memory over simulated time."""
    ticks: int

    def __str__(self) -> str:
        return (f'{self.simulated_s:.0f} s simulated in {self.elapsed_s:.0f} s, {self.ticks} '
                f'ticks: {self.least_mb:.1f} to {self.most_mb:.1f} MB resident, '
                f'{self.growth_mb_per_h:+.2f} MB per simulated hour')


def long_run(directory: Path, seconds: float) -> LongRun:
    """Simulate the rig for ``seconds``, into files of 100 MB, and examine run and bag."""
    config, bag = directory / 'rig.yaml', directory / 'bag'
    config.write_text(RIG.read_text() + _STORAGE)
    begin = time.monotonic()
    with bringup(bag, '--scenario', 'wheel_sine', '--duration', str(seconds), '--in-process',
                 config=config) as run:
        wait_for(lambda: (bag / 'metadata.yaml').exists() or not run.is_running(), 'tick 0')
        samples = np.array(resident_over_time(run, bag))
        assert run.exit_code() == 0, run.errors
    elapsed = time.monotonic() - begin
    samples[:, 0] *= seconds / recorded_bytes(bag)
    # The last sample may be of a process that has released its memory.
    settled = samples[(samples[:, 0] >= WARM_UP * seconds) & (samples[:, 0] < seconds)]
    slope = np.polyfit(settled[:, 0], settled[:, 1], 1)[0]
    least, most = settled[:, 1].min(), settled[:, 1].max()
    return LongRun(seconds, elapsed, least, most, 3600.0 * slope, assert_times_agree(bag))


def resident_over_time(run: Started, bag: Path) -> list[tuple[float, float]]:
    """Return (bytes of the bag, resident memory in MB) until a run ends."""
    samples: list[tuple[float, float]] = []
    while not run.has_ended_within(LOOK_S):
        try:
            status = Path(f'/proc/{run.pid}/status').read_text()
        except ProcessLookupError:
            break
        if (resident := re.search(r'^VmRSS:\s+(\d+) kB$', status, re.M)) is not None:
            samples.append((recorded_bytes(bag), int(resident[1]) * 1024e-6))
    return samples


def recorded_bytes(bag: Path) -> float:
    """Return the size of the files of a bag, which grow by whole chunks as time goes on."""
    return float(sum(file.stat().st_size for file in bag.glob('*.mcap')))


def assert_times_agree(bag: Path) -> int:
    """Fail unless tick, log time and `/clock` of every sample agree; return the last tick."""
    due = 0
    for message in Bag(bag).messages():
        assert message.t_ns == message.sequence * STEP_NS, message
        if message.topic == '/clock':
            sec, nanosec = _STAMP.unpack_from(message.data, 4)
            assert sec * ONE_SECOND_NS + nanosec == message.t_ns, message
            assert message.sequence == due, message
            due += 1
    return due - 1
