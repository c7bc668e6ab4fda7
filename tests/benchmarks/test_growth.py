"""Rows and figure of the growth from the results of runs."""

from benchmarks import growth
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.spec import ONE_PROCESS, PROCESSES
import pytest
from tests.bench.artificial import ran
from tests.bench.test_groups import by_name


def test_twelve_actuators_have_aims_and_what_was_not_run_says_so():
    twelve = [next(s for s in specs if s.plant == '12')
              for specs in (growth.IN_ONE_PROCESS, growth.IN_PROCESSES)]
    rows = by_name(growth.growth_rows(Outcomes({spec: [ran(700.0, 12)] for spec in twelve})))
    assert rows['12 actuators, one process'].is_reached is False
    assert rows['12 actuators, processes'].is_reached is True
    assert rows['24 actuators, processes'].value is None


def test_one_actuator_more_costs_what_its_process_has():
    """80 MiB for the coordinator, 50 for each actuator, from 1 to 12."""
    one, twelve = (next(s for s in growth.IN_PROCESSES if s.plant == n) for n in ('1', '12'))
    rows = by_name(growth.growth_rows(Outcomes({
        one: [ran(900.0, 1)], twelve: [ran(300.0, 12)]})))
    assert rows['one actuator more, in processes, 1 to 12'].value == pytest.approx(50.0)
    assert rows['one actuator more, in one process'].value is None


def test_a_figure_needs_both_curves():
    runs = {spec: [ran(3000.0 / int(spec.plant))]
            for spec in growth.IN_ONE_PROCESS + growth.IN_PROCESSES}
    drawing = growth.drawing(Outcomes(runs))
    assert drawing is not None and len(drawing.figure.axes) == 2
    assert growth.drawing(Outcomes({spec: runs[spec] for spec in growth.IN_PROCESSES})) is None


def test_24_processes_are_left_out_where_memory_is_short(monkeypatch):
    monkeypatch.setattr(growth, 'available_memory', lambda: 13 * growth.PROCESS_BYTES)
    wanted = growth.specs()
    assert {s.plant for s in wanted if s.way == PROCESSES} == {'1', '2', '3', '6', '12'}
    assert '24' in {s.plant for s in wanted if s.way == ONE_PROCESS}
