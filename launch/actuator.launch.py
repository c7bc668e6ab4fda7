"""One actuator alone, in real time with its own or its default load."""

from isa_ros.processes.launching import refuse_failure
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

_MODEL = 'isa_v5'
_TEXTS = {
    'model': f'of the actuator; empty: that of config_file, else {_MODEL}',
    'config_file': 'a run file, or a shipped one by name, that declares an actuator of this name',
    'scenario_file': 'a scenario that changes loads or start of that run'}


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and the node."""
    return LaunchDescription([
        DeclareLaunchArgument('name', default_value='actuator', description='of the node'),
        DeclareLaunchArgument('namespace', default_value='', description='of the node'),
        *(DeclareLaunchArgument(name, default_value='', description=text)
          for name, text in _TEXTS.items()),
        DeclareLaunchArgument(
            'real_time_factor', default_value='1.0', description='0: as fast as possible'),
        OpaqueFunction(function=_nodes)])


def _nodes(context: LaunchContext) -> list[Node]:
    texts = {name: LaunchConfiguration(name).perform(context) for name in _TEXTS}
    if not texts['config_file']:
        texts['model'] = texts['model'] or _MODEL
    return [Node(
        package='isa_ros', executable='actuator', name=LaunchConfiguration('name'),
        namespace=LaunchConfiguration('namespace'), output='screen', on_exit=refuse_failure,
        parameters=[{
            **{name: ParameterValue(text, value_type=str) for name, text in texts.items()},
            'real_time_factor': ParameterValue(
                LaunchConfiguration('real_time_factor'), value_type=float)}])]
