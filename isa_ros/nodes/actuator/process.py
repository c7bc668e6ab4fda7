"""A process with one actuator: with a coordinator, or alone."""

from collections.abc import Sequence
import gc

from isa_ros.config.models.catalogue import model_names
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.parent import end_with_parent
from isa_ros.errors import ConfigError
from isa_ros.nodes.actuator.alone import run_alone
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.middleware.arguments import init_ros
from isa_ros.nodes.middleware.discovery import refuse_off
from isa_ros.nodes.middleware.domain import Claim
from isa_ros.nodes.middleware.environment import set_defaults
from isa_ros.nodes.middleware.parameters import declare, refuse_unknown
from isa_ros.processes.ending import DONE, end_of
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.compiling import reported_compilation
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.utilities import try_shutdown

USAGE = (
    'one actuator: ros2 run isa_ros actuator --ros-args -p model:=isa_v5 '
    '[-r __node:=NAME] [-p real_time_factor:=1.0] [-p force.kp:=GAIN ...] '
    '[-p config_file:=leg.yaml -p lockstep:=true]')


def run(args: Sequence[str] | None, model: str) -> int:
    """
    Run one actuator until it is stopped and return the exit code.

    It ends normally by a signal only, with exit code 0 as launch expects.
    """
    with StopRequest() as should_stop:
        end_with_parent()
        try:
            set_defaults()
            init_ros(args, USAGE)
            with reported_compilation('actuator'):
                _run(model, should_stop)
        except Exception as error:
            return end_of('actuator', error)
        finally:
            try_shutdown()
    return DONE


def _run(model: str, should_stop: StopRequest) -> None:
    node = ActuatorNode(lambda node: _resolve(node, model), model or 'actuator', has_mailbox=True)
    try:
        gc.freeze()  # garbage collection of the loaded objects would delay a tick by 60 ms
        if _boolean(node, 'lockstep'):
            refuse_off(node.setup.config.name)
            from isa_ros.nodes.actuator.in_lockstep import take_part    # one alone needs none
            take_part(node, should_stop)
        else:
            claim = Claim(node.get_namespace(), node.get_name())
            try:
                run_alone(node, _number(node, 'real_time_factor'), should_stop,
                          _boolean(node, 'ros_time'))
            finally:
                claim.close()
    finally:
        node.destroy_node()


def _resolve(node: Node, model: str) -> NodeSetup:
    """Declare the node's parameters and return the actuator they describe."""
    for name, default, description in (
            ('lockstep', False, 'advance only with the ticks of a coordinator'),
            ('model', model, f'one of {", ".join(model_names())}'),
            ('config_file', '', 'run file that declares this actuator'),
            ('scenario_file', '', 'scenario that changes loads or start of that run'),
            ('set', Parameter.Type.STRING_ARRAY, 'other values in these files, each KEY=VALUE'),
            ('ros_time', False, 'stamps of the clock of the host instead of simulation time, '
             'if alone'),
            ('real_time_factor', 1.0,
             'simulated over host time, if alone; 0: as fast as possible')):
        declare(node, name, default, ParameterDescriptor(description=description, read_only=True))
    chosen, path = _text(node, 'model'), _text(node, 'config_file')
    if path:
        from isa_ros.nodes.actuator.of_run import setup_of  # and all that a run may have
        return setup_of(node, path, _text(node, 'scenario_file'), chosen)
    if _boolean(node, 'lockstep'):
        raise ConfigError(f'{node.get_name()}: lockstep needs the parameter config_file')
    if not chosen:
        refuse_unknown(node)  # its name may be misspelt
        raise ConfigError(
            f'{node.get_name()}: set the parameter model, one of {", ".join(model_names())}, or '
            'config_file')
    return NodeSetup(default_actuator(chosen, node.get_name()), DEFAULT_TIMING)


def _text(node: Node, name: str) -> str:
    value: str = node.get_parameter(name).value
    return value


def _boolean(node: Node, name: str) -> bool:
    value: bool = node.get_parameter(name).value
    return value


def _number(node: Node, name: str) -> float:
    value: float = node.get_parameter(name).value
    return value


def main(args: Sequence[str] | None = None, model: str = '') -> int:
    """Run one actuator node; without ``model`` its parameter ``model`` names the model."""
    return run(args, model)
