"""
The middleware settings a lockstep wants, where the user has set none.

Must be called before `rclpy.init`; children inherit them.
"""

from collections.abc import MutableMapping
import os
from pathlib import Path

PROFILE = Path(__file__).with_name('fastdds_profile.xml')

_PROFILE_VARIABLES = ('FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE')
_PROFILE_IN_DIRECTORY = 'DEFAULT_FASTRTPS_PROFILES.xml'
_OTHER_SETTINGS = ('RMW_FASTRTPS_USE_QOS_FROM_XML', 'ROS_DISCOVERY_SERVER')
_DISCOVERY_VARIABLES = (
    'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_LOCALHOST_ONLY', 'ROS_STATIC_PEERS')


def set_defaults(environment: MutableMapping[str, str] = os.environ) -> None:
    """
    Use the packaged Fast DDS profile and stay on this host, unless the user chose otherwise.

    Fast DDS 2 reads the first of the two variables, Fast DDS 3 the second.
    """
    chosen = any(name in environment for name in (*_PROFILE_VARIABLES, *_OTHER_SETTINGS))
    if not chosen and not Path(_PROFILE_IN_DIRECTORY).exists():
        for name in _PROFILE_VARIABLES:
            environment[name] = str(PROFILE)
    if not any(name in environment for name in _DISCOVERY_VARIABLES):
        environment['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
