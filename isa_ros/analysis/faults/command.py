"""`isa faults`: list the faults of the device, or inject them into a rig and show what happens."""

from argparse import Namespace
import sys

from isa_ros.analysis.faults import page, situations
from isa_ros.analysis.faults.measure import outcomes
from isa_ros.errors import ConfigError
from isa_ros.text.json_file import write_wanted
from isa_ros.text.page import refuse_a_part, write_wanted_page
from isa_ros.text.progress import counted


def faults(options: Namespace) -> bool:
    """
    Do what is asked for; return whether every faulty run could be simulated to its end.

    Raises
    ------
    ConfigError
        A fault is unknown, or options do not go together.

    """
    if options.list:
        for option in ('only', 'json', 'out'):
            if getattr(options, option) is not None:
                raise ConfigError(f'--{option} is not used with --list')
        if options.situations:
            raise ConfigError('--situations is not used with --list')
        print(page.listing())
        return True
    if options.situations:
        return _situations(options)
    if options.out is not None:
        refuse_a_part(options.out / page.PAGE, options.only)
    found = outcomes(options.only, counted(sys.stderr, 'faults', stays=True))
    print(page.as_text(found))
    write_wanted(page.as_tree(found), options.json)
    write_wanted_page(page, found, options.out)
    return not any(own.diverged for own in found)


def _situations(options: Namespace) -> bool:
    if options.out is not None:
        refuse_a_part(options.out / situations.PAGE, options.only)
    found = situations.situations(options.only, counted(sys.stderr, 'runs', stays=True))
    print(situations.as_text(found))
    write_wanted(situations.as_tree(found), options.json)
    write_wanted_page(situations, found, options.out)
    return not any(own.diverged for own in found)
