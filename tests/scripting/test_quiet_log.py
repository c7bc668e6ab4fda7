"""The bag of a result is the same whether kernels pack its ticks or Python each."""

from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.scripting.log import Log
from isa_ros.scripting.quiet_log import QuietLog
from isa_ros.scripting.result import Result
from isa_ros.tick.exchange import Rows, RowSink
import numpy as np
import pytest

LINK = {'link': {'kind': 'can', 'cycle_ms': 1.0}}
FAULTS = [{'t_s': 0.03, 'actuator': 'kfe', 'fault': 'valve_stuck', 'until_s': 0.05}]


def bytes_of(result: Result, folder: Path) -> bytes:
    file, = result.save(folder).glob('*.mcap')
    return file.read_bytes()


class Far(isa_ros.Controller):
    """Requests what is refused, at one tick."""

    def step(self, state: isa_ros.State) -> dict[str, isa_ros.Setpoint]:
        return {'kfe': isa_ros.Setpoint(position=9.0)} if state.t_ns == 41_000_000 else {}


@pytest.mark.parametrize(('name', 'scenario', 'given', 'least'), [
    ('leg', 'drop', {}, 0.9), ('leg', 'trot_leg', {'faults': FAULTS}, 0.85),
    ('leg', 'drop', {'controllers': [Far()]}, 0.9), ('rig_linear', 'identify_linear', {}, 0.9),
    ('quadruped', None, {}, 0.9), ('pump_station', 'pump_station', {}, 0.9),
    ('linked', None, {}, 0.0)])
def test_it_has_the_same_bytes(
        name: str, scenario: str | None, given: dict[str, Any], least: float, tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch) -> None:
    """With motions, faults and events between its ticks; of a link Python looks at each."""
    n, kept = 110, []
    own = isa_ros.load('rig_linear', changes=LINK) if name == 'linked' else isa_ros.load(
        name, scenario)
    result = own.simulate(n * 1e-3, **given)
    run = QuietLog.run

    def counted(own: QuietLog, tick: int, most: int, sink: RowSink) -> int:
        kept.append(run(own, tick, most, sink))
        return kept[-1]
    monkeypatch.setattr(QuietLog, 'run', counted)
    by_kernels = bytes_of(result, tmp_path / 'kernels')
    assert sum(kept) >= least * n and (sum(kept) > 0) == (least > 0.0)
    monkeypatch.setattr(QuietLog, 'run', lambda *given: 0)
    assert bytes_of(result, tmp_path / 'python') == by_kernels
    assert bool(result.log.events) == ('controllers' in given)


def test_what_has_another_form_is_left_to_python(tmp_path: Path) -> None:
    """A body whose sample in the log has not the fields of its rows."""
    result = isa_ros.load('leg').simulate(0.01)
    rows = Rows(3, isa_ros.load('leg').simulation().surroundings)
    bodies = {'body': np.zeros(11, [('position', 'f8')])}
    log: Log = result.log._replace(bodies=bodies)
    assert QuietLog(log, rows, 1_000_000).run(0, 5, RowSink()) == 0
