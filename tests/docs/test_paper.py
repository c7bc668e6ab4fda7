"""The table of docs/paper.md names scenarios that fit and figures that are drawn."""

import re

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.run_file import load_run
from isa_ros.scenario.scenario import load_scenario
import pytest
from tests.docs.pages import text_of

FIGURES = [
    (config, scenario, figures)
    for figures, configs, scenario in re.findall(
        r'^\| ([\w. ]+) \| (`\w+`(?:, or `\w+`)?) \| `(\w+)` \|', text_of('paper'), re.MULTILINE)
    for config in re.findall(r'\w+(?=`)', configs)]


@pytest.mark.parametrize('config, scenario, figure', FIGURES)
def test_a_figure_of_the_table_has_a_scenario_that_names_it(
        config: str, scenario: str, figure: str) -> None:
    """A scenario that fits its rig, with a figure that the report can draw."""
    fitted = load_scenario(find(scenario, SCENARIOS), load_run(find(config, CONFIG)))
    assert fitted.figure is not None and fitted.duration_s is not None


def test_the_table_has_every_figure_of_the_paper_with_measurements() -> None:
    """Figures 1 to 3, 7 and 9 to 11 are drawings and pictures, 16 is a photograph."""
    named = {int(figure) for *_, figure in FIGURES if figure.isdigit()}
    assert named == {4, 5, 6, 8, 12, 13, 14, 15, 17, 18, 19, 20}
