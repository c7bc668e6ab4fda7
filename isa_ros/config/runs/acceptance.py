"""Who commands a run: its key `accept`."""

from isa_ros.config.text.keys import choice_of, Key

ACCEPT_ALL, ACCEPT_SCENARIO = 'all', 'scenario'

ACCEPT = Key(
    'accept', choice_of((ACCEPT_ALL, ACCEPT_SCENARIO)),
    'commands of all, or not those of topics, services and parameters', None, ACCEPT_ALL,
    of=lambda run: None if run.accept == ACCEPT_ALL else run.accept)
"""The scenario, controllers and the master of a bus may always command."""
