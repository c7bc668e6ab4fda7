"""
An EtherCAT master that measures its cycles: `python -m ... STARTED REQUEST RESULT`.

REQUEST is a `MeasuredRing` as JSON, RESULT the file to write. It runs in the network namespace of
its ring, whose slaves it starts and ends.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
import json
import math
from pathlib import Path
import re
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from typing import Any

from benchmarks.bus_ring import Cycles, FLOOR, MASTER_END, MeasuredRing, SLAVE_END
from isa_ros.bench.child import environment
from isa_ros.bench.rigs import config_of
from isa_ros.errors import RunError
from isa_ros.fieldbus.request import REAL_TIME
import pysoem

OUT = struct.Struct('<Hbxiiihhff')
IN = struct.Struct('<HbxiihHfff')
"""Process data of a device: control word, mode, target; status word, mode, position."""
CSP, SWITCHED_ON = 8, 200
"""Mode of operation; cycles until all drives are enabled, which are not measured."""
NEXT = {0x40: 0x06, 0x21: 0x07, 0x23: 0x0F, 0x27: 0x0F}
"""Control word that leads from a state of CiA 402 towards operation enabled."""
STATE, ENABLED = 0x6F, 0x27
RECEIVE_US, READY_S, END_S = 2_000_000, 120.0, 20.0
SWING, PERIOD = 2000, 500       # um | urad, cycles
STEP_S = 1e-3


def main(arguments: Sequence[str]) -> int:
    """Measure one ring and write its cycles."""
    _, text, result = arguments
    ring = MeasuredRing(**json.loads(text))
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        with slaves(ring, Path(directory)) as log:
            round_trips, spent = cycles(ring)
    cuts = statistics.quantiles(round_trips, n=100)
    Path(result).write_text(json.dumps(Cycles(
        ring.cycles / spent, cuts[49], cuts[98], about_real_time(log))._asdict()))
    return 0


def about_real_time(log: Sequence[str]) -> list[str]:
    """Return the lines of the slaves' log about their pace and their lateness."""
    return [line for line in log if REAL_TIME in re.sub('[- ]', '_', line)]


@contextmanager
def slaves(ring: MeasuredRing, directory: Path) -> Iterator[list[str]]:
    """Start the slaves of a ring, wait until they are ready, and end them; yield their log."""
    config = str(config_of(ring.plant, directory))
    if ring.way == FLOOR:
        command = ['-m', 'benchmarks.bus_floor', config, SLAVE_END]
    else:
        command = ['-m', 'isa_ros', 'bus', 'ethercat', config, '--interface', SLAVE_END,
                   '--out', str(directory / 'bag'), '--pace', ring.way]
    process = subprocess.Popen(
        [sys.executable, *command], env=environment(), text=True, stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    assert process.stderr is not None
    log: list[str] = []
    try:
        for line in process.stderr:
            log.append(line.strip())
            if 'wait for a master' in line:
                break
        else:
            raise RunError(log[-1] if log else 'the slaves ended')
        yield log
    finally:
        process.send_signal(signal.SIGINT)
        log += process.communicate(timeout=END_S)[1].splitlines()


def cycles(ring: MeasuredRing) -> tuple[list[float], float]:
    """Bring the drives up, move them, and return each round trip in s and the time of all."""
    master: Any = pysoem.Master()
    master.open(MASTER_END)
    try:
        if master.config_init() <= 0:
            raise RunError(f'no slaves on {MASTER_END}')
        master.config_map()
        master.state = pysoem.OP_STATE
        master.write_state()
        while master.state_check(pysoem.OP_STATE, 2000) != pysoem.OP_STATE:
            master.send_processdata()
            master.receive_processdata(RECEIVE_US)
        starts: dict[int, int] = {}
        round_trips = []
        for cycle in range(SWITCHED_ON + ring.cycles):
            if cycle == SWITCHED_ON:
                begun = due = time.perf_counter()
            for place, slave in enumerate(master.slaves):
                slave.output = output(slave.input, cycle, place, starts)
            if ring.way == REAL_TIME and cycle >= SWITCHED_ON:
                due += STEP_S
                time.sleep(max(0.0, due - time.perf_counter()))
            sent = time.perf_counter()
            master.send_processdata()
            count = master.receive_processdata(RECEIVE_US)
            round_trips.append(time.perf_counter() - sent)
            if count != master.expected_wkc:
                raise RunError(f'cycle {cycle}: working counter {count}, must be '
                               f'{master.expected_wkc}')
        spent = time.perf_counter() - begun
        if len(starts) < len(master.slaves) and ring.way != FLOOR:
            raise RunError(f'{len(starts)} of {len(master.slaves)} drives are enabled')
        return round_trips[SWITCHED_ON:], spent
    finally:
        master.close()


def output(data: bytes, cycle: int, place: int, starts: dict[int, int]) -> bytes:
    """Return the next process data of a slave; ``starts`` has the positions of enabling."""
    status, _, position, *_ = IN.unpack(data)
    state = status & STATE
    target = position
    if state == ENABLED:
        target = starts.setdefault(place, position) + round(
            SWING * math.sin(2.0 * math.pi * cycle / PERIOD))
    return OUT.pack(NEXT.get(state, 0), CSP, target, 0, 0, 0, 0, math.nan, math.nan)


if __name__ == '__main__':
    try:
        code = main(sys.argv[1:])
    except RunError as error:
        print(error, file=sys.stderr)
        code = error.exit_code
    sys.exit(code)
