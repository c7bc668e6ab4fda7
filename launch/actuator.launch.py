"""One actuator alone, in real time with its default load."""

from isa_ros.processes.launching import refuse_failure
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and the node."""
    return LaunchDescription([
        DeclareLaunchArgument('model', default_value='isa_v5', description='of the actuator'),
        DeclareLaunchArgument('name', default_value='actuator', description='of the node'),
        DeclareLaunchArgument('namespace', default_value='', description='of the node'),
        DeclareLaunchArgument(
            'real_time_factor', default_value='1.0', description='0: as fast as possible'),
        Node(
            package='isa_ros', executable='actuator', name=LaunchConfiguration('name'),
            namespace=LaunchConfiguration('namespace'), output='screen', on_exit=refuse_failure,
            parameters=[{
                'model': LaunchConfiguration('model'),
                'real_time_factor': ParameterValue(
                    LaunchConfiguration('real_time_factor'), value_type=float),
            }])])
