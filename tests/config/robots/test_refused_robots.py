"""Robots of run files that cannot work are refused by a line."""

import math
from pathlib import Path

from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError
import pytest

ROOT = Path(__file__).parents[3]
CRANE = 'body.drives.lift'
LEG = 'body.drives.knee'


@pytest.mark.parametrize('name, changes, message', [
    ('crane', {f'{CRANE}.retracted_length_mm': 900.0},
     'body.drives.lift: the range of lift, -24.0642 to 89.9544 deg, takes it from -78.8 to 451.3 '
     'mm, must be within its stroke, 0 to 535 mm; it reaches -6.7 to 90.0 deg'),
    ('crane', {f'{CRANE}.retracted_length_mm': 1200.0},
     'actuators.lift: the start of the robot puts it at -98.35 mm, must be within its stroke, 0 '
     'to 535 mm: its retracted_length_mm = 1200 mm'),
    ('crane', {'actuators.lift.parameters.plant.drive.stroke_mm': 450.0},
     'takes it from 1.196 to 531.3 mm, must be within its stroke, 0 to 450 mm; it reaches -24.1 '),
    ('crane', {f'{CRANE}.base_mm': [1037.0, 0.0, 1836.0]},
     'body.drives.lift: its lever is'),
    ('crane', {f'{CRANE}.rod': 'pillar'},
     'body.drives.lift moves nothing: no joint that turns or slides is between its links base = '
     'pillar and rod = pillar'),
    ('crane', {f'{CRANE}.rod': 'bracket_3'},
     "body.drives.lift.rod = 'bracket_3' is not a link of the URDF; did you mean bracket_2"),
    ('two_joint_leg', {'body.drives.knee.linkage': 'direct'},
     'body.drives.knee.linkage = direct, must be cylinder: base is not used otherwise'),
    ('two_joint_leg', {'body.drives.hip.joint': 'knee'},
     "body.drives.hip.joint = 'knee', which the drive knee moves; hip is a joint of its own"),
    ('two_joint_leg', {'body.drives.knee.range': [math.nan, 1.0]},
     'body.drives.knee.range[0] = nan deg, must be finite'),
    ('crane', {f'{CRANE}.joint': 'lift'}, 'body.drives.lift.joint is not used: a cylinder moves '),
    ('crane', {f'{CRANE}.high_deg': 60.0},
     'body.drives.lift.high_deg is not used: the range of the joint that a cylinder moves is '),
    ('crane', {f'{CRANE}.low_deg': 0.0}, 'body.drives.lift.low_deg is not used: the range of '),
    ('crane', {'body.drives.tilt.range': [-90.0, 0.0]},
     'body.drives.tilt.linkage = four_bar, must be cylinder: range is not used otherwise'),
    ('crane', {f'{CRANE}.range': [-30.0, 60.0]},
     'body.drives.lift.range = -30 to 60, must be within the -24.0642 to 89.9544 deg of '),
    ('crane', {'body.drives.tilt.high_deg': 5.0},
     'body.drives.tilt has the range -166.158 to 5 deg, must be within that of the joint '),
    ('crane', {'body.passive': ['swing_pitch']},
     'body: no actuator moves the joint swing_roll: give it a drive, or name it in passive'),
    ('crane', {'body.passive': ['*']}, 'body.passive has lift, which lift moves'),
    ('crane', {'body.passive': ['swing']}, 'body.passive.swing is unknown; did you mean swing_'),
    ('crane', {'body.drives.tilt.joint': 'bracket_1_mount'},
     "body.drives.tilt.joint: 'bracket_1_mount' moves nothing: it is not a joint of the URDF"),
    ('crane', {'body.drives.tilt.joint': 'swing_roll'},
     'body.drives.tilt lacks low_deg and high_deg, the range of its linkage: '),
    ('crane', {'body.drives.tilt.linkage': 'direct'}, 'body.drives.tilt'),
    ('crane', {'body.drives.tilt.ar_mm': 200.0, 'body.drives.tilt.br_mm': 200.0},
     'cannot be assembled at joint angle'),
    ('crane', {'body.drives.tilt.like': 'tilt'},
     "body.drives.tilt.like = 'tilt' is not a linkage of the file, nor LEG.JOINT of a packaged "),
    ('crane', {'body.drives.tilt.like': 'hyq.knee'}, 'body.drives.tilt.like.hyq.knee is unknown'),
    ('crane', {'body.drives.tilt.mirrored': True},
     'body.drives.tilt.mirrored is not used: the drive is like no other'),
    ('crane', {'body.urdf': 'derrick.urdf'},
     'body.urdf = derrick.urdf: there is no such file in the folder of the run file; shipped: '),
    ('crane', {'body.start.joints_deg': {'lift': 91.0}},
     'body.start.joints_deg.lift = 91 deg, must be within its range -24.0642 to 89.9544 deg'),
    ('crane', {'body.start.joints_mm': {'lift': 91.0}},
     'body.start.joints_mm.lift: this joint belongs to joints_deg'),
    ('crane', {'body.start.joints_deg': {'*_yaw': 0.0}}, 'body.start.joints_deg.*_yaw means none'),
    ('crane', {'body.start.joints_deg.lift': 10.0},
     'body.start: the contact load_bottom is '),
    ('crane', {'body.contacts.load_bottom.link': 'log'},
     "body.contacts.load_bottom.link: 'log' is not a link of the URDF"),
    ('crane', {'body.contacts.load_bottom.ground': 'mud'},
     "body.contacts.load_bottom.ground = 'mud' is not a material; "),
    ('two_joint_leg', {'body.contacts': {'foot': {}}},
     'body.contacts.foot lacks ground, and the robot has none: name a material'),
    ('two_joint_leg', {'body.contacts': {'knee': {'link': 'calf', 'ground': 'wood'}}},
     "body.contacts.knee: the name 'knee' is that of a joint; both have columns"),
    ('two_joint_leg', {'body.imus': {'top': {'link': 'lid'}}},
     "body.imus.top.link = 'lid' is not a link of the URDF"),
    ('two_joint_leg', {'body.imus': {'top': {'link': 'rail', 'rate_hz': 300.0}}},
     'body.imus.top.rate_hz = 300 Hz, its period must be a multiple of step_ms = 1 ms'),
    ('two_joint_leg', {'body.start.release_s': 0.0005}, 'body.start.release_s = 0.0005'),
    ('two_joint_leg', {'actuators.hip.model': 'smart_manifold'},
     'body.drives.hip: its actuator hip is rotary, must be of a linkage direct'),
    ('two_joint_leg', {f'{LEG}.actuator': 'hip'}, "body.drives.knee.actuator = 'hip' already mov"),
    ('two_joint_leg', {'body.drives.hip': {}},
     'body.drives.hip lacks linkage, one of direct, slider_crank, four_bar, cylinder, or like'),
    ('two_joint_leg', {'body.start': {'joints': {'hip': 3.0}}},
     'body.start.joints is unknown; the key is joints_deg'),
    ('quadruped', {'body.root': 'floating'}, "body.root = 'floating', must be one of free, fixed"),
    ('quadruped', {'body.start.height_mm': -1.0}, 'is 1 mm below the ground'),
])
def test_what_cannot_work_is_refused_by_a_line(name, changes, message):
    with pytest.raises(ConfigError) as error:
        load_run(ROOT / 'config' / f'{name}.yaml', changes)
    assert message in str(error.value)
    assert str(error.value).startswith(f'{name}.yaml: ') and '\n' not in str(error.value)
