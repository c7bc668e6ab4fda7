"""Figures of the paper that a scenario is drawn as."""

from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError

FIGURES = (
    'position_torque_tracking', 'torque_step', 'force_step', 'impact', 'weight', 'knee_sine',
    'leg_drop', 'valve_response', 'flow_gain', 'leakage', 'current_step', 'bandwidth')
"""Figures of the paper that a scenario may be drawn as; `analysis.report` draws them."""


def figure_of(tree: Tree, place: Place) -> str | None:
    """
    Return the figure that a scenario is drawn as, None for a scenario without the key.

    Raises
    ------
    ConfigError
        The figure does not exist.

    """
    figure = tree.get('figure')
    if figure is None or figure in FIGURES:
        return figure
    raise ConfigError(
        f"{place / 'figure'} = {figure!r} is not a figure; {alternatives(str(figure), FIGURES)}")
