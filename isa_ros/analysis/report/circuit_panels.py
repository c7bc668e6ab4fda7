"""Panels of a circuit: pressures of its manifolds, temperatures of gas and oil."""

from isa_ros.analysis.report.panels import Curve, drawn, Group, Panel
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.config.runs.supplies import GAS, OIL, SupplyConfig
from isa_ros.config.text.names import parted
from isa_ros.core.units import MPA
from isa_ros.surroundings.circuits.sheet import CircuitSupply


def circuit_signals(supply: SupplyConfig, signals: Signals) -> dict[str, Signal]:
    """Return the recorded pressures and temperatures of the parts of a circuit by name."""
    names = [f'{own.name}.{field}' for own in supply.sampled[1:] for field in own.published]
    return {name: signals.over_time(name) for name in names if name in signals}


def circuit_group(supply: SupplyConfig, signals: Signals) -> Group:
    """
    Return the panels of a circuit.

    The return side, whose pressures are a hundredth of the others, has a panel of its own.
    """
    sheet = supply.sheet
    back = sheet.with_return() if isinstance(sheet, CircuitSupply) else frozenset()
    pressures: list[Curve] = []
    returns: list[Curve] = []
    gas: list[Curve] = []
    oil: list[Curve] = []
    for name, signal in circuit_signals(supply, signals).items():
        part = parted(name.rpartition('.')[0])[1]
        into = (gas if name.endswith(GAS) else oil if name.endswith(OIL)
                else returns if part in back else pressures)
        into.append(Curve(part, signal))
    return Group(supply.name, f'{supply.name} (circuit)', drawn([
        Panel('pressure', 'MPa gauge', MPA, pressures,
              'Of the manifolds: they are apart where a line, filter or valve between them has a '
              'loss.'),
        Panel('return side', 'MPa gauge', MPA, returns, 'What the oil needs on its way back.'),
        Panel('temperature of gas', 'celsius', 1.0, gas,
              'It falls while an accumulator gives oil, and rises while it takes some.'),
        Panel('temperature of the oil', 'celsius', 1.0, oil,
              'What the losses have warmed it, less what tank and coolers gave to the air.')]),
        (supply.name,))
