"""A topic and the quality of service its publisher offers."""

from isa_ros.core.frozen import frozen

_INFINITE = (9223372036, 854775807)  # RMW_DURATION_INFINITE (s, ns)


@frozen
class Qos:
    """Offered quality of service; deadline, lifespan and lease are infinite."""

    history: str = 'keep_last'
    depth: int = 10
    reliability: str = 'reliable'
    durability: str = 'volatile'

    @property
    def is_kept(self) -> bool:
        """Return whether a later subscription receives the last messages too."""
        return self.durability == 'transient_local'

    def to_yaml(self) -> str:
        """Return a YAML list that holds this profile, without a final newline."""
        lines = [
            f'- history: {self.history}', f'  depth: {self.depth}',
            f'  reliability: {self.reliability}', f'  durability: {self.durability}',
            *_duration('deadline'), *_duration('lifespan'),
            '  liveliness: automatic', *_duration('liveliness_lease_duration'),
            '  avoid_ros_namespace_conventions: false']
        return '\n'.join(lines)


KEPT = Qos(durability='transient_local')
"""Of messages that are rare and stay in force."""


@frozen
class Topic:
    """One topic of a bag: fully qualified name, message type, offered quality of service."""

    name: str
    type_name: str
    qos: Qos = Qos()


def _duration(name: str) -> list[str]:
    sec, nsec = _INFINITE
    return [f'  {name}:', f'    sec: {sec}', f'    nsec: {nsec}']
