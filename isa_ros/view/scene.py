"""
The scene of a run: bodies by their URDF, other actuators as a cylinder or a rotor.

Bodies and actuators stand side by side along y. A body without a URDF, as one of another
simulator, is shown by its actuators.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.errors import ConfigError
from isa_ros.surroundings.messages import JointStates, Odometry
from isa_ros.view.nodes import Floats, SceneMotion, SceneNode, Shape, WORLD
from isa_ros.view.urdf_nodes import Moved, urdf_nodes
import numpy as np

_BETWEEN = 1.5      # m, between two bodies
_THICK, _THIN = 0.14, 0.07      # radius of barrel and rod, in strokes
_ROTOR = 0.1        # m, radius of a rotor
_ALONG_X = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
_ALONG_Y = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
_ROD_COLOR, _TIP_COLOR = 1, 2


def scene_of(run: RunConfig, folder: Path) -> list[SceneNode]:
    """Return the nodes of a run whose run file is in ``folder``, where URDFs may be."""
    nodes: list[SceneNode] = []
    drawn: set[str] = set()
    y = 0.0
    for body in run.bodies:
        found = _described(run, body, folder, np.array([0.0, y, 0.0]), len(nodes))
        if found:
            nodes += found
            drawn |= {actuator for _, actuator in body.joints}
            y += _BETWEEN
    for actuator in run.actuators:
        if actuator.name not in drawn:
            width = _width(actuator)
            nodes += _alone(actuator, np.array([0.0, y + width, 2.0 * width]), len(nodes))
            y += 4.0 * width
    return nodes


def _described(
        run: RunConfig, body: BodyConfig, folder: Path, place: Floats,
        first: int) -> list[SceneNode]:
    """Return the nodes of a body; none without a URDF, or where its file cannot be read here."""
    if not body.has_urdf:
        return []
    try:
        return urdf_nodes(
            run.description(body, folder), body.label, _moved(run, body, place), first)
    except (ConfigError, ElementTree.ParseError, OSError):
        return []


def _moved(run: RunConfig, body: BodyConfig, place: Floats) -> Moved:
    """Return what moves the joints of a body, by the messages that it declares."""
    joints: Mapping[str, str] = {}
    root: list[str] = []
    for message in body.messages(run.step_ns):
        if isinstance(message, JointStates):
            joints = {name: f'{body.name}.{column}'
                      for name, column in zip(message.names, message.position)}
        elif isinstance(message, Odometry):
            root = [f'{body.name}.{column}'
                    for column in (*message.position, *message.orientation)]
    return Moved(joints, root, place)


def _width(actuator: ConfiguredActuator) -> float:
    """Return the radius of what is drawn of an actuator, m."""
    return _ROTOR if actuator.sheet.is_rotary else _THICK * actuator.sheet.plant.drive.stroke


def _alone(actuator: ConfiguredActuator, place: Floats, first: int) -> Iterator[SceneNode]:
    """Yield the housing of an actuator and what moves in it."""
    width, name, here = _width(actuator), actuator.name, np.zeros(3)
    if actuator.sheet.is_rotary:
        disc = Shape('cylinder', (width, width), here, _ALONG_Y)
        arm = Shape('box', (2.0 * width, 0.3 * width, 0.3 * width),
                    np.array([width, -0.7 * width, 0.0]), np.eye(3), _TIP_COLOR)
        yield SceneNode(name, WORLD, place, np.eye(3), [disc])
        # an angle > 0 lifts the arm: about -y
        yield SceneNode(name, first, here, np.eye(3), [arm], SceneMotion.TURN, (0.0, -1.0, 0.0),
                        [f'{name}.position'])
        return
    stroke = actuator.sheet.plant.drive.stroke
    barrel = Shape('cylinder', (width, 1.1 * stroke), np.array([0.55 * stroke, 0.0, 0.0]),
                   _ALONG_X)
    rod = Shape('cylinder', (_THIN * stroke, 1.1 * stroke), np.array([0.6 * stroke, 0.0, 0.0]),
                _ALONG_X, _ROD_COLOR)
    eye = Shape('box', (width, width, width), np.array([1.2 * stroke, 0.0, 0.0]), np.eye(3),
                _TIP_COLOR)
    yield SceneNode(name, WORLD, place, np.eye(3), [barrel])
    yield SceneNode(name, first, here, np.eye(3), [rod, eye], SceneMotion.SLIDE, (1.0, 0.0, 0.0),
                    [f'{name}.position'], stroke)
