"""One actuator over a peer: `python -m ... PEER DIRECTORY INDEX CONFIG [SCENARIO]`."""

from collections.abc import Sequence
import gc
from pathlib import Path
import sys

from isa_ros.actuator.actuator import Timing
from isa_ros.bench.peers.catalogue import ends, peer
from isa_ros.bench.peers.frames import decode_step, encode_answer, Kind
from isa_ros.bench.peers.link import Link
from isa_ros.config.run_config import RunConfig
from isa_ros.config.run_file import load_run
from isa_ros.processes.stopping import end_with_parent
from isa_ros.run.stepping import SteppedActuator
from isa_ros.run.warm_up import warmed_up
from isa_ros.scenario.scenario import load_scenario

SLICE_S = 0.5


def main(arguments: Sequence[str]) -> None:
    """Answer the steps of one run until its end."""
    end_with_parent()
    name, directory, index, *files = arguments
    run = _run(files)
    config = run.actuators[int(index)]
    stepped = SteppedActuator(config, Timing(run.step_ns, run.controller_offset_ns))
    settle(run)
    link = ends(peer(name)).worker_end(Path(directory), int(index))
    try:
        answer_steps(link, stepped, int(index))
    finally:
        link.close()


def settle(run: RunConfig) -> None:
    """Load all kernels and spare the collector what is loaded, as a run of isa_ros does."""
    warmed_up(run)
    gc.freeze()


def _run(files: Sequence[str]) -> RunConfig:
    run = load_run(files[0])
    for scenario in files[1:]:
        run = load_scenario(scenario, run).run
    return run


def answer_steps(link: Link, stepped: SteppedActuator, index: int) -> None:
    """Take part in one run, as a participant does."""
    while True:
        data = link.receive(SLICE_S)
        if data is None:
            continue
        step = decode_step(data)
        if step.kind is Kind.END:
            return
        if step.kind is Kind.START:
            applied = stepped.start(step.start(index))
        else:
            command = step.command(index)
            if command['kinds']:
                stepped.actuator.accept(command)
            applied = stepped.advance(step.port(index))
        actuator = stepped.actuator
        link.send(encode_answer(index, step.tick, actuator.reply, actuator.sample, applied))


if __name__ == '__main__':
    main(sys.argv[1:])
