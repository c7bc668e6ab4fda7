"""A key of a data sheet that a model lacks, written with another unit."""

from pathlib import Path

from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError
import pytest

RUN = """
name: own
supply: {{kind: constant, pressure_mpa: 16.0, return_pressure_mpa: 0.0}}
actuators:
  ram:
    model: cylinder
    parameters:
      plant:
        drive: {{bore_mm: 100.0, rod_mm: 56.0, stroke_mm: 535.0, rated_pressure_mpa: 8.0}}
        valve: {{flow: {{{flow}, rated_current_ma: 10.0}}}}
"""


@pytest.mark.parametrize(('flow', 'end'), [
    ('rated_flow_l_min: 40.0',
     'rated_flow_l_min: the key is rated_flow_lpm (the unit belongs to the key)'),
    ('rated_flow_lpn: 40.0', 'rated_flow_lpn: did you mean rated_flow_lpm?'),
    ('zzz: 40.0', 'see your data sheets')])
def test_a_name_that_stands_for_a_missing_one_is_found(
        tmp_path: Path, flow: str, end: str) -> None:
    path = tmp_path / 'own.yaml'
    path.write_text(RUN.format(flow=flow))
    with pytest.raises(ConfigError) as caught:
        load_run(path)
    assert 'lacks plant.valve.flow.rated_flow_lpm: cylinder has none' in str(caught.value)
    assert str(caught.value).endswith(end)
