"""Small groups of checks for the tests of the runner; a worker imports them by name."""

from isa_ros.errors import ConfigError, ParameterError, SimulationDiverged
from isa_ros.validation.actuators import CheckedActuators, SHIPPED
from isa_ros.validation.entry import (
    around, CheckGroup, Drawing, Entry, Findings, INPUT, Observation, OWN, PAPER, WORDS)
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
                    (Drawing('line', 'A line.', figure),),
                    (Observation(name='seen', where='Fig 2', paper='it hums', ours=0.25, unit='N',
                                 how='held by hand'),))


def missed() -> Findings:
    return Findings((
        entry('far', 2.0, reason='the spring is too soft'),
        entry('lost', float('nan'), source=OWN)))


def every_kind() -> Findings:
    """Return other numbers of entries of each kind, reached and not."""
    one, five = {'reading': 'erratum 1: one'}, around(5.0, by=0.1)
    return Findings((
        entry('p', 1.0), entry('w', 1.0, source=WORDS), entry('w2', 9.0, source=WORDS),
        *(entry(f'i{k}', 1.0, source=INPUT) for k in range(3)),
        *(entry(f'r{k}', ours, source=source, tolerance=five, **one) for k, (source, ours) in
          enumerate(((PAPER, 5.0), (INPUT, 5.0), (INPUT, 5.0), (WORDS, 1.0)))),
        entry('o', 5.0, source=OWN, tolerance=five, **one),
        *(entry(f'o{k}', 9.0, source=OWN) for k in range(4))))


def both_gains() -> Findings:
    return Findings((
        entry('rise', 1.0, gains='table_4'), entry('alone', 1.0),
        entry('rise', 2.0, gains='default', reason='slower')))


def refused() -> Findings:
    raise ConfigError('no such model')


def diverged() -> Findings:
    raise SimulationDiverged(1_000_000, 'spool', float('nan'))


GOOD = CheckGroup('good', 'Good ones', good)
MISSED = CheckGroup('missed', 'Missed ones', missed, is_long=True)
GAINS = CheckGroup('gains', 'Two sets of gains', both_gains)
KINDS = CheckGroup('kinds', 'Every kind', every_kind)
REFUSED = CheckGroup('refused', 'Refused', refused)
DIVERGED = CheckGroup('diverged', 'Diverged', diverged)


def stiff(actuators: CheckedActuators = SHIPPED) -> Findings:
    """Measure 1 times the change; refuse more than 5 times as much, diverge beyond 3."""
    ours = 1.0 if actuators.change is None else actuators.change.factor
    if ours > 5.0:
        raise ParameterError('stiffness = 6 N/m, must be <= 5 N/m')
    if ours > 3.0:
        raise SimulationDiverged(1_000_000, 'spool', float('nan'))
    return Findings((entry('bar', ours), entry('hidden', 1.0), entry('late', 2.0 / ours)))


STIFF = CheckGroup('stiff', 'A stiffness', stiff)
