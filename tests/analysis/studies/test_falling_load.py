"""The study of a crane whose hose bursts."""

from isa_ros.analysis.studies import falling_load
import pytest


@pytest.mark.slow
def test_a_counterbalance_valve_holds_what_a_burst_hose_drops(tmp_path):
    """As docs/falling_load.md has it: 206, 33 and 2 mm in 3 s."""
    found = {own.case: own for own in falling_load.results()}
    assert found['hoses alone'].fallen > 0.15
    assert 0.01 < found['pilot check'].fallen < 0.06
    assert 0.0 < found['counterbalance'].fallen < 0.005
    assert found['counterbalance'].fastest < found['pilot check'].fastest < 0.1
    paths = falling_load.STUDY.write_page(list(found.values()), tmp_path)
    assert [path.name for path in paths] == ['falling_load.md', 'falling_load.png']
    assert 'counterbalance' in falling_load.STUDY.as_text(list(found.values()))
