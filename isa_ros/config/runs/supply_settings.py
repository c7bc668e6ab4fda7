"""Settings of supplies that defeat each other: reported before a run, which is not refused."""

from collections.abc import Iterator

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.surroundings.accumulator import AccumulatorSupply
from isa_ros.surroundings.circuits.accumulator import AccumulatorPart
from isa_ros.surroundings.circuits.sheet import CircuitSupply


def defeated_settings(run: RunConfig) -> Iterator[str]:
    """
    Yield a line for each relief valve and each accumulator that the pump's pressure makes useless.

    The relief valve of an accumulator supply that opens below its pump's compensator, and gas
    precharged above the pressure of the pumps.
    """
    for supply in run.supplies:
        sheet = supply.sheet
        if isinstance(sheet, AccumulatorSupply):
            held = f'{supply.name}.pressure_mpa = {sheet.pressure_mpa:g} MPa'
            if sheet.relief_mpa < sheet.pressure_mpa and sheet.pump_flow_lpm > 0.0:
                yield (f'{supply.name}.relief_mpa = {sheet.relief_mpa:g} MPa < {held}: the pump '
                       'never reaches its pressure, its flow leaves through the relief valve')
            if sheet.precharge_mpa > sheet.pressure_mpa:
                yield _dead(f'{supply.name}.precharge_mpa = {sheet.precharge_mpa:g} MPa > {held}')
        elif isinstance(sheet, CircuitSupply):
            for name, part in sheet.by_name.items():
                if isinstance(part, AccumulatorPart) and part.precharge_mpa > sheet.pressure_mpa:
                    yield _dead(
                        f'{supply.name}.parts.{name}.precharge_mpa = {part.precharge_mpa:g} MPa > '
                        f'{sheet.pressure_mpa:g} MPa of the pumps of {supply.name}')


def _dead(what: str) -> str:
    return f'{what}: the accumulator takes no oil'
