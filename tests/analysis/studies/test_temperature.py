"""The oil's temperature, measured from bags and compared with its laws."""

from dataclasses import replace
import json
from pathlib import Path

from isa_ros.analysis.signals.signals import read_signals, Signals
from isa_ros.analysis.studies import command, temperature
from isa_ros.analysis.studies.temperature import (
    Effects, law, measured, results, rig_at, TemperatureEffects, TEMPERATURES)
from isa_ros.cli import main as cli
import pytest

COLD, WARM = 30.0, 60.0     # celsius
DOCS = Path(__file__).parents[3] / 'docs'


@pytest.fixture(scope='module')
def bags(tmp_path_factory: pytest.TempPathFactory) -> dict[float, Signals]:
    """Return the signals of two bags of the rig, by temperature."""
    directory = tmp_path_factory.mktemp('temperature')
    return {celsius: read_signals(rig_at(celsius).simulate().save(directory / f'{celsius:g}'))
            for celsius in (COLD, WARM)}


@pytest.fixture(scope='module')
def found() -> list[TemperatureEffects]:
    """Return the study, run once."""
    return results()


@pytest.mark.parametrize('celsius', [COLD, WARM])
def test_a_bag_shows_the_laws_of_the_oil(celsius: float, bags: dict[float, Signals]) -> None:
    """
    Leakage, viscous friction, oil spring and null of a bath of 30 and of 60 celsius.

    The oil of an actuator that moves is up to 0.026 K warmer than its bath, in which viscosity
    changes by 5 %/K: 0.13 % of friction. At null it is 0.001 K, and V5 is 0.005 % below the
    root: 0.02 % of leakage. The swing's damping of 1.2 % takes 0.007 % off its frequency, and
    its oil of 10 % compression has chambers of other volumes: 0.1 %. The spool is read in codes
    of 0.03 nm.
    """
    shown, expected = measured(bags[celsius]), law(bags[celsius], celsius)
    assert shown.leakage == pytest.approx(expected.leakage, rel=2e-4, abs=0.0)
    assert shown.viscous_friction == pytest.approx(expected.viscous_friction, rel=2e-3)
    assert shown.frequency == pytest.approx(expected.frequency, rel=1e-3)
    assert shown.null == pytest.approx(expected.null, abs=3e-11)


def test_from_30_to_60_celsius_the_oil_gets_thin_and_soft(bags: dict[float, Signals]) -> None:
    """VG 46 is 3.66 times thinner, 14 % more compressible; without the model nothing changes."""
    cold, warm = (measured(bags[celsius]) for celsius in (COLD, WARM))
    tare = 1e-6     # m3/s: the pilot stage's 0.06 l/min do not depend on the viscosity
    thinner = (warm.leakage - tare) / (cold.leakage - tare)
    assert thinner == pytest.approx(3.656, rel=2e-3)
    assert cold.viscous_friction / warm.viscous_friction == pytest.approx(thinner, rel=2e-3)
    assert (cold.frequency / warm.frequency) ** 2 == pytest.approx(1.123, rel=2e-3)


def test_a_bag_has_the_temperature_of_every_second(bags: dict[float, Signals]) -> None:
    t, values = bags[WARM].over_time('swing.temperature')
    assert list(t) == [0.0, 1.0]
    assert values[0] == WARM and 0.0 < values[1] - WARM < 0.03
    assert bags[WARM].unit('swing.temperature') == 'celsius'


def test_memory_and_bag_show_the_same(
        found: list[TemperatureEffects], bags: dict[float, Signals]) -> None:
    assert [result.celsius for result in found] == list(TEMPERATURES)
    by_celsius = {result.celsius: result for result in found}
    for celsius, signals in bags.items():
        assert by_celsius[celsius].measured == measured(signals)


def test_the_page_is_that_of_the_study(
        found: list[TemperatureEffects], tmp_path: Path) -> None:
    page, = temperature.STUDY.write_page(found, tmp_path)
    assert page.read_text() == (DOCS / page.name).read_text()


def test_the_command_prints_the_table_and_writes_json(
        found: list[TemperatureEffects], monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
        capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(
        command._OWN, 'temperature', replace(temperature.STUDY, results=lambda progress: found))
    file = tmp_path / 'study.json'
    assert cli.main(['study', 'temperature', '--json', str(file)]) == 0
    assert temperature.STUDY.as_text(found) in capsys.readouterr().out
    tree = json.loads(file.read_text())
    assert [Effects(**outcome['measured']) for outcome in tree['outcomes']] == [
        result.measured for result in found]


@pytest.mark.parametrize('option', [['--model', 'isa_v5'], ['--values', '30'], ['--all']])
def test_an_option_of_other_studies_is_refused(
        option: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(['study', 'temperature', *option]) == 2
    assert capsys.readouterr().err == (
        f'isa: {option[0]} is not used by the study temperature\n')
