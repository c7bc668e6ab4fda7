"""
The door of saved states: altered texts, and texts of altered content with the right checksum.

Damage is found by the checksum. Content with the right one may be anything: it is refused, or the
run continues from it with finite numbers until it diverges.
"""

from collections.abc import Callable
import copy
import json
import random
from typing import Any

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.saved_state import RunState, sealed
from isa_ros.core.signals import SAMPLE
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
import numpy as np
from tests.fuzz.bytes_of import altered
from tests.fuzz.property import refused

TICKS = 1
_ODD: tuple[Any, ...] = (
    None, True, -1, 0, 7, 2**40, 10**40, 1.5, '', 'zz', '00', 'ä', [], ['00'], [[]], {}, {'a': 1})


class Saved:
    """A run, and a state of it."""

    def __init__(self, run: RunConfig) -> None:
        self.simulation = Simulation(idle(run))
        for _ in range(3):
            self.simulation.step()
        self.digest = run.digest
        self.state = self.simulation.state()
        self.text = self.state.to_json(self.digest, {'numpy': '2.0'})


def fuzz_texts(saved: Saved, cases: int, seed: int) -> int:
    """Read altered texts; return how many were refused."""
    def read(dice: random.Random) -> None:
        data = altered(saved.text.encode(), dice)
        text = data.decode('utf-8', 'replace')  # a file that is not UTF-8 is refused before
        assert RunState.from_json(text, saved.digest, 'state.json') == saved.state

    return _refusals(read, 'text', cases, seed)


def fuzz_contents(saved: Saved, cases: int, seed: int) -> int:
    """Continue from altered content with the right checksum; return how many were refused."""
    tree = json.loads(saved.text)
    del tree['sha256']
    simulation = saved.simulation

    def resume(dice: random.Random) -> None:
        changed = _changed(copy.deepcopy(tree), dice)
        state = RunState.from_json(sealed(changed), saved.digest, 'state.json')
        simulation.resume(state)
        assert _is_finite(simulation), 'goes on from a number that is not finite'
        for _ in range(TICKS):
            simulation.step()
        assert simulation.ticks == state.tick + TICKS

    return _refusals(resume, 'content', cases, seed)


def _refusals(
        attempt: Callable[[random.Random], None], what: str, cases: int, seed: int) -> int:
    return sum(refused(lambda: attempt(random.Random(case)), f'{what} {case}')
               for case in range(seed, seed + cases))


def _changed(tree: dict[str, Any], dice: random.Random) -> dict[str, Any]:
    """Return a tree with one value altered: mostly the bytes of a state, keeping their length."""
    key = dice.choice(('load', 'requests', 'participants', 'participants', 'any'))
    if key == 'any':
        name = dice.choice(sorted(tree))
        if dice.random() < 0.2:
            del tree[name]
        else:
            tree[name] = dice.choice(_ODD)
    elif key == 'participants':
        tree[key] = [_bytes(own, dice) for own in tree[key]]
    else:
        tree[key] = _bytes(tree[key], dice)
    return tree


def _bytes(text: str, dice: random.Random) -> str:
    """Return hexadecimal bytes altered; three times of four with as many of them."""
    data = bytes.fromhex(text)
    found = altered(data, dice)
    if dice.random() < 0.75:
        found = found[:len(data)] + data[len(found):]
    return found.hex()


def _is_finite(simulation: Simulation) -> bool:
    """Return whether everything that a run shows is finite."""
    rows = [simulation.group.samples, simulation.surroundings.supplies]
    return all(np.isfinite(row[name]).all() for row in rows for name in row.dtype.names or ()
               ) and simulation.group.samples.dtype == SAMPLE
