"""Actuators that a tank warms: however a run goes, one sha256."""

from pathlib import Path

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.scripting.run import load
import pytest
from tests.ros.bags import sha256
from tests.ros.started import bringup

NAME = 'warm_stand'


@pytest.mark.ros
@pytest.mark.slow
def test_memory_one_process_and_processes_record_the_same_bytes(
        domain: int, tmp_path: Path) -> None:
    """The temperature of the tank crosses sockets with the supply's port, the heat comes back."""
    found = [sha256(load(NAME, NAME, duration=0.4).simulate().save(tmp_path / 'python'))]
    for name, options in (('one', ('--in-process',)), ('many', ())):
        with bringup(tmp_path / name, '--scenario', str(find(NAME, SCENARIOS)), '--duration',
                     '0.4', '--join-timeout', '100', *options, config=find(NAME, CONFIG)) as run:
            assert run.exit_code() == 0, run.errors
        found.append(sha256(tmp_path / name))
    assert len(set(found)) == 1, found
