"""Hoses, load holding, return spring, motor and cushions: three ways of running, one sha256."""

from pathlib import Path

from isa_ros.scripting.run import load
import pytest
from tests.parts import written
from tests.ros.bags import sha256
from tests.ros.started import bringup


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.filterwarnings('ignore::isa_ros.tick.trips.TripWarning')
def test_python_one_process_and_processes_record_the_same_bytes_of_all_parts(
        domain: int, tmp_path: Path) -> None:
    config, scenario = written(tmp_path)
    found = [sha256(load(config, scenario).simulate().save(tmp_path / 'python'))]
    for name, options in (('one', ('--in-process',)), ('many', ())):
        with bringup(tmp_path / name, '--scenario', str(scenario), '--join-timeout', '100',
                     *options, config=config) as run:
            assert run.exit_code() == 0, run.errors
        found.append(sha256(tmp_path / name))
    assert len(set(found)) == 1, found
