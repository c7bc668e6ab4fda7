"""docs/scenario_file.md says what the readers of a scenario accept."""

import math
import re

from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.core.signals import COMMAND
from isa_ros.scenario.course_reading import COURSES
from isa_ros.scenario.fault_reading import TARGETS
from isa_ros.scenario.keys import FAULT, SETPOINT
from isa_ros.scenario.scenario import scenario_of
from isa_ros.scenario.track import MOTIONS
import numpy as np
import pytest
from scripts import write_scenario_file

PAGE = write_scenario_file.PAGE.read_text(encoding='utf-8')
EXAMPLE, = re.findall(r'```yaml\n(.*?)```', PAGE, re.DOTALL)
RUN = """
name: one
supply: {kind: constant, pressure_mpa: 20.7, return_pressure_mpa: 0.0}
actuators:
  ram: {model: isa_v5, load: {kind: mass}}
"""


def test_its_tables_are_those_of_the_keys() -> None:
    """`python -m scripts.write_scenario_file` after a change of a key."""
    assert write_scenario_file.page(PAGE) == PAGE
    changed = PAGE.replace('| 1.7 | strides of one leg |', '| 1.8 | strides of one leg |', 1)
    assert changed != PAGE and write_scenario_file.page(changed) == PAGE


def test_motions_courses_and_targets_are_keys() -> None:
    """A waveform or a target that is read, and no key, could not be given."""
    assert set(MOTIONS) <= SETPOINT.keys()
    assert {*COURSES, *TARGETS} <= FAULT.keys()


def test_its_example_goes_where_it_says() -> None:
    """From 80 to 20 mm at 40 mm/s, where it stays, then 5 mm about it at 2 Hz."""
    run = run_of_text(RUN)
    scenario = scenario_of(EXAMPLE, run)
    out = np.zeros(1, COMMAND)
    asked = {}
    for tick in (500, 900, 1999, 2000, 2400, 2500, 2625):
        scenario.commands(tick, out)
        asked[tick] = float(out[0]['position']), float(out[0]['velocity'])
    assert [asked[tick] for tick in (500, 900, 1999, 2000, 2400)] == [
        pytest.approx(wanted, rel=1e-12, abs=0.0) for wanted in (
            (0.08, -0.04), (0.064, -0.04), (0.02004, -0.04), (0.02, 0.0), (0.02, 0.0))]
    assert asked[2500] == pytest.approx((0.02, 0.005 * 4.0 * math.pi), rel=1e-12, abs=0.0)
    assert asked[2625][0] == pytest.approx(0.025, rel=1e-12, abs=0.0)
