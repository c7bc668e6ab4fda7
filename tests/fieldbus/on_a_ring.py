"""
A run of `isa bus ethercat` and its master in one network namespace: `python -m ... PLAN RESULT`.

PLAN is a `Plan` as JSON. It must run in the namespace: `benchmarks.bus_ring.NEW_NAMESPACE`.
"""

from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import asdict, dataclass
import io
from itertools import count
import json
import math
import os
from pathlib import Path
import sys
import time
from typing import Any

from benchmarks.bus_ring import MASTER_END, SLAVE_END
from isa_ros.examples import ethercat_master
import pysoem
from tests.fieldbus.served import served, stalls

LONGEST_STALL = 0.3
CYCLES, FIRST_ENABLED, SWITCHED = 120, 30, 10
"""Of the master that does not look at its inputs."""
FIFO = 20
PATIENT_US, IMPATIENT_US = 5_000_000, 1000
PATIENCE_S = 60.0


@dataclass(frozen=True)
class Plan:
    """Slaves and master of a run."""

    bag: str
    options: tuple[str, ...] = ()
    """Of `isa bus ethercat`, besides interface and bag."""
    has_ros: bool = False
    config: str = 'leg'
    stalls: int = 0
    """Pauses of the example's master, of up to 0.3 s."""
    is_first: bool = False
    """Whether both are scheduled by SCHED_FIFO."""
    is_blind: bool = False
    """Whether the master commands by its cycle only, instead of the example's."""
    receive_us: int = PATIENT_US
    """How long the blind master waits for a frame."""
    ends_silent: bool = False
    """Whether the run is interrupted once the blind master's silence was noticed."""


def main(arguments: Sequence[str]) -> None:
    """Run, and write what the master printed, the slaves printed, and how many frames it lost."""
    tree = json.loads(arguments[0])
    plan = Plan(**tree | {'options': tuple(tree['options'])})
    if plan.is_first:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(FIFO))
    printed = io.StringIO()
    with served('ethercat', plan.config, '--interface', SLAVE_END, '--out', plan.bag,
                *plan.options, has_ros=plan.has_ros) as slaves, redirect_stdout(printed):
        lost = blind(plan) if plan.is_blind else example(plan)
        if plan.ends_silent:
            slaves.interrupt()
    Path(arguments[1]).write_text(json.dumps({
        'printed': printed.getvalue().splitlines(), 'lines': slaves.lines, 'lost': lost,
        'code': slaves.code}))


def example(plan: Plan) -> int:
    """Run the example's master, with pauses between cycles."""
    pauses = stalls(3, ethercat_master.CYCLES, plan.stalls, LONGEST_STALL)
    exchange, cycles = ethercat_master.exchange, count()

    def stalling(master: Any) -> None:
        time.sleep(pauses.get(next(cycles), 0.0))
        exchange(master)
    ethercat_master.exchange = stalling
    ethercat_master.main([MASTER_END])
    return 0


def blind(plan: Plan) -> int:
    """Command by the number of the cycle; return how many frames came too late."""
    master: Any = pysoem.Master()
    master.open(MASTER_END)
    assert master.config_init() > 0, 'the slaves are there'
    master.config_map()
    master.state = pysoem.OP_STATE
    master.write_state()
    while master.state_check(pysoem.OP_STATE, 2000) != pysoem.OP_STATE:
        master.send_processdata()
        master.receive_processdata(PATIENT_US)
    master.send_processdata()
    master.receive_processdata(PATIENT_US)
    starts = [ethercat_master.IN.unpack(slave.input)[2] for slave in master.slaves]
    lost = 0
    for cycle in range(CYCLES):
        word = 0x06 if cycle < SWITCHED else 0x07 if cycle < 2 * SWITCHED else 0x0F
        lift = 3000.0 * math.sin(0.1 * max(0, cycle - FIRST_ENABLED))
        for slave, start in zip(master.slaves, starts):
            slave.output = ethercat_master.OUT.pack(
                word, ethercat_master.CSP, start + round(lift), 0, 0, 0, 0, math.nan, math.nan)
        master.send_processdata()
        lost += master.receive_processdata(plan.receive_us) != master.expected_wkc
    deadline = time.monotonic() + PATIENCE_S
    while plan.ends_silent and master.read_state() == pysoem.OP_STATE:
        assert time.monotonic() < deadline, 'the slaves stay operational'
    return lost


def text_of(plan: Plan) -> str:
    """Return a plan as an argument."""
    return json.dumps(asdict(plan))


if __name__ == '__main__':
    main(sys.argv[1:])
