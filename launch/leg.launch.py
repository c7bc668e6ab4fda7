"""
One run in lockstep: the nodes of every actuator of a configuration, and the coordinator.

Legs are also shown, with their lengths and sensors: by robot_state_publisher where that is
installed, one each, and with ``rviz:=true`` the only one by rviz. ``ros2_control:=FILE`` starts
the controllers of a parameter file for the only leg.
"""

from collections.abc import Container, Iterable
from functools import partial
import os
from pathlib import Path

from ament_index_python.packages import get_packages_with_prefixes
from isa_ros.config.paths import CONFIG, CONTROLLERS, find, find_drawing, SCENARIOS
from isa_ros.config.runs.leg_control import control_tag, Controllers, controllers_of, MANAGER
from isa_ros.config.runs.leg_description import urdf_of
from isa_ros.config.runs.run_config import LegConfig, RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.changes import changes_of
from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.domain import Claim, CLAIMED_BY
from isa_ros.processes.launching import refuse_failure
from isa_ros.processes.processes import Process, run_processes
from isa_ros.run.option import flag, namespace
from isa_ros.run.options import launched_elsewhere, launched_parameters, OPTIONS
from launch import Action, LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.events.process import ProcessExited
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

PUBLISHER = 'robot_state_publisher'


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and the nodes."""
    return LaunchDescription([
        *(DeclareLaunchArgument(option.name, default_value=option.launch_text,
                                description=option.description) for option in OPTIONS),
        DeclareLaunchArgument(
            'rviz', default_value='false', description='true: show the leg in rviz'),
        DeclareLaunchArgument(
            'ros2_control', default_value='',
            description='parameter file of the controllers to start, or a shipped one by name'),
        OpaqueFunction(function=_nodes)])


def _nodes(context: LaunchContext) -> list[Node]:
    values = {option.name: LaunchConfiguration(option.name).perform(context)
              for option in OPTIONS}
    config = find(values['config'], CONFIG)
    scenario = find(values['scenario'], SCENARIOS) if values['scenario'] else None
    own, parameters = namespace(values['namespace']), launched_parameters(values)
    run = load_run(config, changes_of(parameters.get('set', [])).run)
    has_rviz = flag('rviz', LaunchConfiguration('rviz').perform(context))
    named = LaunchConfiguration('ros2_control').perform(context)
    controllers = find(named, CONTROLLERS) if named else None
    processes = run_processes(
        run, config, scenario, parameters, launched_elsewhere(values))
    viewers = _viewers(run, own, has_rviz, controllers)
    claim = Claim(own)  # before anything starts; refused while another run is there
    return [*viewers, *(_node(process, own, claim) for process in processes)]


def _viewers(
        run: RunConfig, own: str, has_rviz: bool, controllers: Path | None) -> list[Node]:
    """Return the nodes that show and control legs; their topics are of the run's namespace."""
    legs = [body for body in run.bodies if isinstance(body, LegConfig)]
    above = f'/{own}' if own else ''
    of_run = [(f'/{topic}', f'{above}/{topic}') for topic in ('tf', 'tf_static', 'clock')]
    installed, nodes, tag = get_packages_with_prefixes(), [], []
    if controllers is not None:
        given = f'ros2_control:={controllers.name}'
        leg = _only_leg(run, given)
        claimed = controllers_of(controllers, leg)
        _refuse_missing(installed, given, [PUBLISHER, *claimed.packages])
        tag = [*control_tag(leg, claimed.commands, own)]
        nodes += _control(controllers, claimed, own, of_run)
    for leg in legs if PUBLISHER in installed else ():
        nodes.append(Node(
            package=PUBLISHER, executable=PUBLISHER,
            namespace=f'{own}/{leg.prefix}'.strip('/'), parameters=[{
                'robot_description': ParameterValue(urdf_of(run, leg, tag), value_type=str),
                'use_sim_time': True}], remappings=of_run))
    if has_rviz:
        _only_leg(run, 'rviz:=true')
        _refuse_missing(installed, 'rviz:=true', [PUBLISHER, 'rviz2'])
        nodes.append(Node(
            package='rviz2', executable='rviz2', namespace=own,
            arguments=['-d', str(find_drawing('rviz/leg.rviz'))],
            parameters=[{'use_sim_time': True}], remappings=of_run))
    return nodes


def _only_leg(run: RunConfig, given: str) -> LegConfig:
    if run.leg is None:
        raise ConfigError(f'{given}: {run.source} has no leg, or several')
    return run.leg


def _refuse_missing(installed: Container[str], given: str, packages: Iterable[str]) -> None:
    for package in packages:
        if package not in installed:
            raise ConfigError(f'{given} needs the package {package}, not installed')


def _control(
        path: Path, controllers: Controllers, own: str, of_run: list[tuple[str, str]]
        ) -> list[Node]:
    """Return the controller manager, and what loads and activates its controllers, then ends."""
    return [
        Node(package=MANAGER, executable='ros2_control_node', namespace=own, output='screen',
             parameters=[str(path.resolve()), {'use_sim_time': True}], remappings=of_run,
             on_exit=refuse_failure),
        Node(package=MANAGER, executable='spawner', namespace=own, output='screen',
             arguments=[*controllers.types, '--controller-manager', MANAGER],
             on_exit=refuse_failure)]


def _node(process: Process, own: str, claim: Claim) -> Node:
    is_coordinator = process.executable == 'coordinator'
    namespace, name = process.placed(own)
    return Node(
        package='isa_ros', executable=process.executable, name=name,
        namespace=namespace, output='screen', additional_env={CLAIMED_BY: str(os.getpid())},
        parameters=[{
            key: ParameterValue(list(value), value_type=list[str])
            if isinstance(value, (list, tuple)) else ParameterValue(value, value_type=type(value))
            for key, value in process.parameters}],
        on_exit=partial(_end_of_run, claim) if is_coordinator else refuse_failure)


def _end_of_run(claim: Claim, event: ProcessExited, context: LaunchContext) -> list[Action]:
    """End the launch, and with it the actuators; fail if the run has failed."""
    claim.close()
    refuse_failure(event, context)
    return [Shutdown(reason='the run has ended')]
