"""Names and topics of the coordinator."""

from msg_adapters import applied_parameters

WORLD_FRAME = 'world'
APPLIED_PARAMETERS = ('/coordinator/applied_parameters', applied_parameters.TYPE)
"""Parameters of the supplies that took effect, named SUPPLY.KEY."""
NODE = 'coordinator'
