"""Recording a session with all actuators in this process."""

from pathlib import Path
from typing import Any

from isa_ros.bag.reader import Bag
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.run.options import Request
from isa_ros.run.output import Outlets
from isa_ros.run.packing import Packer
from isa_ros.run.session import prepare, record
from isa_ros.tick.in_process import InProcess
import pytest


def test_the_packer_of_a_run_is_built_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """It encodes every message, which takes a millisecond for a leg."""
    make, built = Packer.__init__, []

    def count(self: Packer, *arguments: Any) -> None:
        built.append(self)
        make(self, *arguments)

    monkeypatch.setattr(Packer, '__init__', count)
    session = prepare(Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag',
                              duration_s=0.005))
    surroundings = surroundings_of(session.run)
    transport = InProcess(group_of(session.run), surroundings.starts())
    record(session, transport, surroundings, lambda topics: Outlets(), None, lambda: False)
    assert len(built) == 1
    assert Bag(tmp_path / 'bag').end_ns == 5_000_000
