"""The run file and the keys on the page of the sensors."""

from dataclasses import fields
from pathlib import Path
import re

from isa_ros.config.runs.run_file import load_run
from isa_ros.plant.channels import CHANNELS, LINE, PositionChannel
from isa_ros.surroundings.bodies.leg.inertial import LINKS
from tests.sheets import actuator_sheet

PAGE = (Path(__file__).parents[2] / 'docs' / 'sensors.md').read_text()


def test_the_run_file_can_be_read(tmp_path: Path) -> None:
    block, = re.findall(r'```yaml\n(.*?)```', PAGE, re.DOTALL)
    path = tmp_path / 'disturbed_leg.yaml'
    path.write_text(block)
    run = load_run(path)
    assert run.seed == 7 and run.leg is not None
    assert [imu.name for imu in run.leg.imus] == ['trunk', 'kfe']
    assert run.actuator('kfe').sheet.plant.sensors.force.sigma == 8.0


def test_every_key_channel_and_link_is_named() -> None:
    keys = set(re.findall(r'^\| `(\w+)` \|', PAGE, re.MULTILINE))
    assert {f.name for f in fields(PositionChannel)} <= keys
    assert all(f'`{name}`' in PAGE for name in (*CHANNELS, *LINKS))
    assert f'at most {LINE - 1}' in PAGE


def test_the_printed_levels_are_those_of_the_isa_v5() -> None:
    sensors = actuator_sheet('isa_v5', 'default', 'data_sheet_sensors').plant.sensors
    printed = (f'{sensors.force.sigma:g} N, {sensors.pressure_a.sigma * 1e-3:g} kPa, '
               f'{sensors.spool.sigma * 1e6:g} um and {sensors.current.sigma * 1e6:g} uA')
    assert printed in ' '.join(PAGE.split())
