"""What happened in the run of a bag, as a table."""

from isa_ros.bag.reader import Bag
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.run.events import Event, events_in
from isa_ros.run.recorded import history_of
from isa_ros.text.table import aligned, Cells

HEADER = ('t, s', 'of', '', 'what')
MOST = 200      # rows of a table


def recorded_events(bag: Bag, run: RunConfig) -> list[Event]:
    """
    Return what happened in the run of a bag, in the order of time.

    Raises
    ------
    BagError
        A message is not what its topic has.

    """
    return events_in(run, history_of(bag, run))


def event_rows(events: list[Event]) -> list[Cells]:
    """Return the rows of a table with its header; of very many events the first ones."""
    rows: list[Cells] = [HEADER, *((f'{own.t_s:.6f}', own.source, own.kind, own.what)
                                   for own in events[:MOST])]
    if len(events) > MOST:
        rows.append(('', '', '', f'and {len(events) - MOST} more'))
    return rows


def events_text(events: list[Event]) -> str:
    """Return events as a table of text; '' if there are none."""
    return '\n'.join(aligned(event_rows(events))) if events else ''
