"""One run in lockstep: the nodes of every actuator of a configuration, and the coordinator."""

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.run_file import load_run
from isa_ros.processes.processes import Process, run_processes
from isa_ros.run.options import launched_elsewhere, launched_parameters, OPTIONS
from launch import Action, LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.events.process import ProcessExited
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and the nodes."""
    return LaunchDescription([
        *(DeclareLaunchArgument(option.name, default_value=option.launch_text,
                                description=option.description) for option in OPTIONS),
        OpaqueFunction(function=_nodes)])


def _nodes(context: LaunchContext) -> list[Node]:
    values = {option.name: LaunchConfiguration(option.name).perform(context)
              for option in OPTIONS}
    config = find(values['config'], CONFIG)
    scenario = find(values['scenario'], SCENARIOS) if values['scenario'] else None
    return [_node(process, values['namespace']) for process in run_processes(
        load_run(config), config, scenario, launched_parameters(values),
        launched_elsewhere(values))]


def _node(process: Process, namespace: str) -> Node:
    is_coordinator = process.executable == 'coordinator'
    return Node(
        package='isa_ros', executable=process.executable, name=process.name,
        namespace=namespace, output='screen',
        parameters=[{
            key: ParameterValue(value, value_type=list[str] if key == 'controllers'
                                else type(value))
            for key, value in process.parameters}],
        on_exit=_end_of_run if is_coordinator else _refuse_failure)


def _end_of_run(event: ProcessExited, context: LaunchContext) -> list[Action]:
    """End the launch, and with it the actuators; fail if the run has failed."""
    _refuse_failure(event, context)
    return [Shutdown(reason='the run has ended')]


def _refuse_failure(event: ProcessExited, context: LaunchContext) -> None:
    """Make the launch fail: an exception is the only way to an exit code other than 0."""
    if event.returncode and not context.is_shutdown:
        raise RuntimeError(f'{event.process_name}: ended with exit code {event.returncode}')
