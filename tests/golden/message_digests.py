"""
Digests of the messages of every shipped configuration under each of its scenarios.

    python -m tests.golden.message_digests          # write message_digests.json anew

A digest is the sha256 over (time, sequence, CDR bytes) of one topic over `SECONDS`. It changes
only where an equation or a message does; the commit that writes the file anew explains it.
"""

import hashlib
import json
from pathlib import Path
import struct

from isa_ros.config.paths import CONFIG, SCENARIOS, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError
from isa_ros.run.local_run import LocalRun
from isa_ros.scenario.scenario import idle, load_scenario, Scenario
from isa_ros.tick.source import ScheduledSource

FILE = Path(__file__).with_suffix('.json')
SECONDS = 0.3
IDLE = 'idle'
_INSTANT = struct.Struct('<qq')


class Digests:
    """A recorder that keeps one digest per topic; ``topics`` are their names, in order."""

    def __init__(self, topics: list[str]) -> None:
        self._topics = topics
        self._hashes = [hashlib.sha256() for _ in topics]

    def write_tick(self, t_ns: int, sequence: int, messages: list[tuple[int, bytes]]) -> None:
        """Take the messages of one instant: (topic index, CDR bytes)."""
        instant, hashes = _INSTANT.pack(t_ns, sequence), self._hashes
        for k, data in messages:
            hashes[k].update(instant + data)

    def by_topic(self) -> dict[str, str]:
        """Return the digests so far, those of topics without a message among them."""
        return {name: own.hexdigest() for name, own in zip(self._topics, self._hashes)}


def pairs() -> dict[str, Scenario]:
    """Return every shipped configuration with no scenario and with each that fits it."""
    found = {}
    for config, path in shipped(CONFIG).items():
        run = load_run(path)
        found[f'{config} {IDLE}'] = idle(run)
        for name, scenario in shipped(SCENARIOS).items():
            try:
                found[f'{config} {name}'] = load_scenario(scenario, run)
            except ConfigError:
                continue  # it is for actuators of another configuration
    return found


def digests(scenario: Scenario) -> dict[str, str]:
    """Return the digest of every topic over the first `SECONDS` of a scenario."""
    local = LocalRun(scenario.run)
    recorder = Digests([topic.name for topic in local.topics])
    local.simulate(
        round(SECONDS * 1e9 / scenario.run.step_ns),
        ScheduledSource(scenario.commands, scenario.changes), recorder)
    return recorder.by_topic()


def main() -> None:
    """Write the digests of every pair."""
    tree = {name: digests(scenario) for name, scenario in pairs().items()}
    FILE.write_text(json.dumps(tree, indent=1) + '\n', encoding='utf-8')
    print(f'{FILE}: {len(tree)} runs')


if __name__ == '__main__':
    main()
