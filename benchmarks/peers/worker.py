"""Worker: one actuator over a peer, `python -m ... PEER DIRECTORY INDEX CONFIG [SCENARIO]`."""

from collections.abc import Sequence
import gc
from pathlib import Path
import sys

from benchmarks.peers.catalogue import ends, peer
from benchmarks.peers.peer_end import PeerEnd
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.config.assembly import timing_of
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.parent import end_with_parent
from isa_ros.run.warm_up import warmed_up
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.parts import actuator_parts
from isa_ros.run.wire.steps import decode_step, StepKind
from isa_ros.scenario.scenario import load_scenario

SLICE_S = 0.5


def main(arguments: Sequence[str]) -> None:
    """Answer the steps of one run until its end."""
    end_with_parent()
    name, directory, index, *files = arguments
    run = _run(files)
    config = run.actuators[int(index)]
    actuator = SmartActuator(config, timing_of(run))
    load_kernels(run)
    link = ends(peer(name)).worker_end(Path(directory), int(index))
    try:
        answer_steps(link, actuator, int(index))
    finally:
        link.close()


def load_kernels(run: RunConfig) -> None:
    """Load all kernels and freeze the loaded objects for garbage collection, as isa_ros does."""
    warmed_up(run)
    gc.freeze()


def _run(files: Sequence[str]) -> RunConfig:
    run = load_run(files[0])
    for scenario in files[1:]:
        run = load_scenario(scenario, run).run
    return run


def answer_steps(link: PeerEnd, actuator: SmartActuator, index: int) -> None:
    """Execute and answer the steps of one run, as a participant does."""
    memory = actuator.memory
    while True:
        data = link.receive(SLICE_S)
        if data is None:
            continue
        step = decode_step(data)
        if step.kind is StepKind.END:
            return
        if step.kind is StepKind.HELLO:
            actuator.start(*step.start(index).item())
        else:
            command = step.command(index)
            if command['kinds']:
                actuator.accept(command)
            actuator.tick(step.port(index))
        link.send(encode_answer(
            AnswerKind.DONE, step.run_id, step.tick, index, actuator_parts(
                memory.replies, memory.samples, memory.applied, actuator.applied_parameters)))


if __name__ == '__main__':
    main(sys.argv[1:])
