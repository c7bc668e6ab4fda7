"""How the run of a bag ended, where it did not come to its end."""

from isa_ros.bag.reader import Bag
from isa_ros.errors import BagError
from isa_ros.run.coordinator import ENDED
from msg_adapters import diagnostics, event
from msg_adapters.cdr import CdrError


def ending(bag: Bag) -> str:
    """
    Return why the run of a bag did not come to its end, in one line; '' if it did, or was stopped.

    An error is among its events; a recorder that was killed left no end of the file, and after
    `isa recover` still no diagnostics of the last instant.

    Raises
    ------
    BagError
        A message is not an event.

    """
    diagnosed = None
    for message in bag.messages((diagnostics.TOPIC[0], event.TOPIC[0])):
        if message.topic == diagnostics.TOPIC[0]:
            diagnosed = message.t_ns
        else:
            try:
                text = event.text(message.data)
            except CdrError as error:
                raise BagError(f'{bag.place_of(message)}: {error}') from error
            if text.startswith(ENDED):
                return f'The run {text.removesuffix(".")}.'
    if not bag.is_whole:
        return 'The bag was cut short, its recorder was killed; `isa recover` completes it.'
    if diagnosed is not None and diagnosed != bag.end_ns:
        return 'The run was cut off: its last instant has no diagnostics.'
    return ''
