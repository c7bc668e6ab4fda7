"""Small groups of checks for the tests of the runner; a worker imports them by name."""

from isa_ros.errors import ConfigError, ParameterError, SimulationDiverged
from isa_ros.validation.actuators import Actuators, SHIPPED
from isa_ros.validation.entry import around, Drawing, Entry, Findings, Group, OWN, PAPER
from isa_ros.validation.plots import stacked


def entry(name: str, ours: float, **more) -> Entry:
    """Return an entry with 1 as the value of the paper."""
    return Entry(**{
        'name': name, 'source': PAPER, 'where': 'Fig 1', 'paper': 1.0, 'ours': ours, 'unit': 'm',
        'tolerance': around(1.0, by=0.1), 'tolerance_source': 'a tenth'} | more)


def good() -> Findings:
    figure, (ax,) = stacked('x', 'y')
    ax.plot([0.0, 1.0], [0.0, 1.0])
    return Findings((entry('a', 1.0), entry('b', 1.05, source=OWN)),
                    (Drawing('line', 'A line.', figure),))


def missed() -> Findings:
    return Findings((
        entry('far', 2.0, reason='the spring is too soft'),
        entry('lost', float('nan'), source=OWN)))


def both_gains() -> Findings:
    return Findings((
        entry('rise', 1.0, gains='table_4'), entry('alone', 1.0),
        entry('rise', 2.0, gains='default', reason='slower')))


def refused() -> Findings:
    raise ConfigError('no such model')


def diverged() -> Findings:
    raise SimulationDiverged(1_000_000, 'spool', float('nan'))


GOOD = Group('good', 'Good ones', good)
MISSED = Group('missed', 'Missed ones', missed, is_long=True)
GAINS = Group('gains', 'Two sets of gains', both_gains)
REFUSED = Group('refused', 'Refused', refused)
DIVERGED = Group('diverged', 'Diverged', diverged)


def stiff(actuators: Actuators = SHIPPED) -> Findings:
    """Measure 1 times the change; refuse more than 5 times as much, diverge beyond 3."""
    ours = 1.0 if actuators.change is None else actuators.change.factor
    if ours > 5.0:
        raise ParameterError('stiffness = 6 N/m, must be <= 5 N/m')
    if ours > 3.0:
        raise SimulationDiverged(1_000_000, 'spool', float('nan'))
    return Findings((entry('bar', ours), entry('hidden', 1.0), entry('late', 2.0 / ours)))


STIFF = Group('stiff', 'A stiffness', stiff)
