"""Print the messages of a topic, of any type that is installed."""

from array import array
from collections.abc import Callable
from importlib import import_module
import itertools
from typing import Any

from isa_ros.errors import ConfigError, printable, RunError
from isa_ros.nodes.middleware.domain import DISCOVERY_S
from isa_ros.nodes.terminal.visitor import absolute, not_found, visiting, Visitor
import numpy as np
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
import yaml

_DEPTH = 100            # messages that may wait to be printed
_BACKLOG_S = 0.2        # after the first of the messages that are kept, until all are there
_WIDTH = 1_000_000      # characters: no line of a number list is broken
_TYPE_PARTS = 3         # package/msg/Type


def topics(timeout_s: float, print_line: Callable[[str], None]) -> None:
    """
    Print the name and type of every topic that is published.

    Raises
    ------
    RunError
        None appeared within the timeout.

    """
    with visiting(timeout_s) as visitor:
        if not visitor.wait(lambda: _published(visitor)):
            raise not_found('a topic of', '/', [], visitor.seconds)
        visitor.wait(lambda: False, DISCOVERY_S)    # which ends with nothing to be seen
        for name, types in sorted(_published(visitor).items()):
            print_line(f'{name}  {types}')


def echo(topic: str, count: int | None, timeout_s: float,
         print_line: Callable[[str], None]) -> None:
    """
    Print so many messages of a topic, None: without end.

    Of more that are kept for a later subscription they are the last ones.

    Raises
    ------
    RunError
        Topic or message did not appear within the timeout.
    ConfigError
        The type of its messages is not installed.

    """
    name = absolute(topic)
    with visiting(timeout_s) as visitor:
        if not visitor.wait(lambda: name in _published(visitor)):
            raise not_found('topic', name, list(_published(visitor)), visitor.seconds)
        arrived: list[Any] = []
        quality = _quality(visitor, name)
        visitor.node.create_subscription(
            message_type(_published(visitor)[name]), name, arrived.append, quality)
        for k in itertools.islice(itertools.count(), count):
            if not visitor.wait(lambda: arrived):
                raise RunError(f'topic {name}: no message within {visitor.seconds}')
            if k == 0 and count and quality.durability == DurabilityPolicy.TRANSIENT_LOCAL:
                visitor.wait(lambda: False, _BACKLOG_S)     # the oldest come first
                del arrived[:-count]
            print_line(f'{message_text(arrived.pop(0))}---')


def message_type(name: str) -> Any:
    """
    Return the class of a message type such as sensor_msgs/msg/JointState.

    Raises
    ------
    ConfigError
        It is not installed.

    """
    parts = name.split('/')
    try:
        if len(parts) != _TYPE_PARTS:
            raise AttributeError(name)
        return getattr(import_module('.'.join(parts[:-1])), parts[-1])
    except (ImportError, AttributeError):
        raise ConfigError(f'type {name}: not installed here') from None


def message_text(message: Any) -> str:
    """Return a message as YAML, its numbers exact; texts hold nothing a terminal acts on."""
    text: str = yaml.safe_dump(
        _tree(message), sort_keys=False, default_flow_style=None, width=_WIDTH)
    return text


def _tree(value: Any) -> Any:
    if hasattr(value, 'get_fields_and_field_types'):
        return {name: _tree(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, (np.ndarray, array)):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_tree(each) for each in value]
    if isinstance(value, bytes):        # one for a field of type byte
        return value[0] if len(value) == 1 else list(value)
    return printable(value) if isinstance(value, str) else value


def _published(visitor: Visitor) -> dict[str, str]:
    """Return the type of each topic that others publish; several types have commas between."""
    node, own = visitor.node, visitor.node.get_name()
    return {name: ', '.join(types) for name, types in node.get_topic_names_and_types()
            if any(each.node_name != own for each in node.get_publishers_info_by_topic(name))}


def _quality(visitor: Visitor, name: str) -> QoSProfile:
    """Return a quality of service that every publisher of a topic can serve."""
    offered = [each.qos_profile for each in visitor.node.get_publishers_info_by_topic(name)]
    is_reliable = all(each.reliability == ReliabilityPolicy.RELIABLE for each in offered)
    is_kept = all(each.durability == DurabilityPolicy.TRANSIENT_LOCAL for each in offered)
    return QoSProfile(
        depth=_DEPTH,
        reliability=ReliabilityPolicy.RELIABLE if is_reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if is_kept else DurabilityPolicy.VOLATILE)
