"""One run of lockstep nodes: every actuator of a configuration, and the coordinator."""

from isa_ros.config.run_file.paths import CONFIG, find, SCENARIOS
from isa_ros.config.run_file.run_file import load_run
from isa_ros.processes.processes.processes import Process, run_processes
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ARGUMENTS = {
    'config': ('leg.yaml', 'a run file, or a shipped one by name'),
    'scenario': ('', 'what is commanded: a file, or a shipped one by name; empty: nothing'),
    'out': ('', 'directory of the bag; empty: a new one in runs/'),
    'duration': ('0.0', 'simulated time in s; 0: that of the scenario, else until Ctrl-C'),
    'in_process': ('false', 'all nodes in one process: faster, and the same bytes in the bag'),
    'real_time_factor': ('0.0', 'not faster than this times real time; 0: as fast as it goes'),
    'paused': ('false', 'wait for /coordinator/step or the end of the pause before tick 0'),
    'compression': ('', 'of the bag: none, lz4, zstd; empty: that of the run file'),
    'split_mb': ('-1.0', 'size of the files of the bag in MB; 0: one; < 0: as in the run file'),
    'namespace': ('', 'of all nodes'),
}


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and the nodes."""
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=default, description=description)
          for name, (default, description) in ARGUMENTS.items()),
        OpaqueFunction(function=_nodes)])


def _nodes(context: LaunchContext) -> list[Node]:
    values = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    config = find(values['config'], CONFIG)
    scenario = find(values['scenario'], SCENARIOS) if values['scenario'] else None
    options = {
        'out': values['out'],
        'duration': float(values['duration']),
        'in_process': _is_true(values['in_process']),
        'paused': _is_true(values['paused']),
        'real_time_factor': float(values['real_time_factor']),
        'compression': values['compression'],
        'split_mb': float(values['split_mb'])}
    return [_node(process, values['namespace'])
            for process in run_processes(load_run(config), config, scenario, options)]


def _is_true(text: str) -> bool:
    return text.lower() in ('true', '1')


def _node(process: Process, namespace: str) -> Node:
    is_coordinator = process.executable == 'coordinator'
    return Node(
        package='isa_ros', executable=process.executable, name=process.name,
        namespace=namespace, output='screen',
        parameters=[{
            key: ParameterValue(value, value_type=type(value))
            for key, value in process.parameters}],
        # The end of the run is the end of its actuators.
        on_exit=[Shutdown(reason='the run is over')] if is_coordinator else None)
