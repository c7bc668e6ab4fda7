"""The topics a run records, in their canonical order."""

from isa_ros.bag.metadata import Topic
from isa_ros.coordinator import Order
from isa_ros.run_config import RunConfig
from isa_ros.shared_load import CLOCK_TOPIC, SharedLoad
from msg_adapters import actuator_messages


def topics_of(run: RunConfig, load: SharedLoad) -> tuple[Order, list[Topic]]:
    """Return the canonical order of a run's topics, and the topics in it."""
    sources = [
        *([(f'/{actuator.name}/{suffix}', type_) for suffix, type_ in actuator_messages.TOPICS]
          for actuator in run.actuators),
        [CLOCK_TOPIC], list(load.topics)]
    types = dict(topic for source in sources for topic in source)
    order = Order([[name for name, _ in source] for source in sources])
    return order, [Topic(name, types[name]) for name in order.topics]
