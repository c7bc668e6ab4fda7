"""Names and topics of the coordinator."""

from msg_adapters import applied_parameters

WORLD_FRAME = 'world'
APPLIED_PARAMETERS = ('/coordinator/applied_parameters', applied_parameters.TYPE)
"""Parameters of the supplies that took effect, named SUPPLY.KEY."""
NODE = 'coordinator'


def supply_topic(supply: str, signal: str) -> str:
    """Return the topic of a signal of a supply: in its namespace, or among the coordinator's."""
    return f'/{supply}_{signal}' if '/' in supply else f'/{NODE}/{supply}_{signal}'
