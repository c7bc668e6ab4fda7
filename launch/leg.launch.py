"""One run in lockstep: the nodes of every actuator of a configuration, and the coordinator."""

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.run_file import load_run
from isa_ros.processes.processes import Process, run_processes
from isa_ros.run.options import launched_parameters, OPTIONS
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ARGUMENTS = [option for option in OPTIONS if option.is_launched]


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and the nodes."""
    return LaunchDescription([
        *(DeclareLaunchArgument(option.name, default_value=option.launch_text,
                                description=option.description) for option in ARGUMENTS),
        OpaqueFunction(function=_nodes)])


def _nodes(context: LaunchContext) -> list[Node]:
    values = {option.name: LaunchConfiguration(option.name).perform(context)
              for option in ARGUMENTS}
    config = find(values['config'], CONFIG)
    scenario = find(values['scenario'], SCENARIOS) if values['scenario'] else None
    return [_node(process, values['namespace']) for process in run_processes(
        load_run(config), config, scenario, launched_parameters(values))]


def _node(process: Process, namespace: str) -> Node:
    is_coordinator = process.executable == 'coordinator'
    return Node(
        package='isa_ros', executable=process.executable, name=process.name,
        namespace=namespace, output='screen',
        parameters=[{
            key: ParameterValue(value, value_type=type(value))
            for key, value in process.parameters}],
        # When the run has ended, launch ends the actuators.
        on_exit=[Shutdown(reason='the run has ended')] if is_coordinator else None)
