"""Configurations of runs are copied, and go to other processes, as those of `multiprocessing`."""

import copy
from pathlib import Path
import pickle
import subprocess
import sys

import isa_ros
from isa_ros.config.paths import CONFIG, shipped
import pytest

ROOT = Path(__file__).parents[3]
_READ = 'import pickle, sys; print([*vars(pickle.load(sys.stdin.buffer).supplies[0].sheet.parts)])'


@pytest.mark.parametrize('name', shipped(CONFIG))
def test_a_run_is_copied_and_pickled(name: str) -> None:
    run = isa_ros.load(name).configuration
    for other in (copy.copy(run), copy.deepcopy(run), pickle.loads(pickle.dumps(run))):
        assert other == run


def test_another_process_makes_classes_of_parts_by_name_itself() -> None:
    """Their order is that of the file."""
    run = isa_ros.load('cooled_station').configuration
    found = subprocess.run([sys.executable, '-c', _READ], input=pickle.dumps(run), cwd=ROOT,
                           capture_output=True, check=True)
    assert found.stdout.decode() == "['tank', 'cooler', 'pump', 'safety', 'stand']\n"
