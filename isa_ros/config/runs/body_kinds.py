"""The kinds of bodies; a new kind is one class and its row here."""

from collections.abc import Mapping

from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.config.runs.external_config import ExternalConfig
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.config.runs.robot_config import RobotConfig

BODY_KINDS: Mapping[str, type[BodyConfig]] = {own.kind: own for own in (
    LegConfig,
    ExternalConfig,
    RobotConfig,
)}
