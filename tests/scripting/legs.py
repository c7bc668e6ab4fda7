"""Two legs in one run."""

import json
from typing import Any

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.text.yaml_text import read

IMU = {'trunk': {'link': 'slider_link', 'rate_hz': 500.0, 'gyro_sigma': 0.01}}


def two_legs() -> dict[str, Any]:
    """Return the run file of two shipped legs, left and right."""
    tree = read(find('leg', CONFIG))
    leg, actuators = tree.pop('leg'), tree.pop('actuators')
    sides = ('left', 'right')
    return json.loads(json.dumps({**tree, 'actuators': {
        f'{side}_{name}': own for side in sides for name, own in actuators.items()},
        'bodies': {side: {'kind': 'leg', **leg, 'imus': IMU, 'joints': {
            joint: f'{side}_{name}' for joint, name in leg['joints'].items()}}
            for side in sides}}))     # nothing is shared
