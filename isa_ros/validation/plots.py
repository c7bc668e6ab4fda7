"""Axes of the validation's figures, in a common style."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure


def stacked(x_label: str, *y_labels: str) -> tuple[Figure, list[Axes]]:
    """Return a figure with axes one above the other, one for each y label."""
    rows = len(y_labels)
    figure = Figure(figsize=(7.0, 3.2 * rows ** 0.7), dpi=110, layout='constrained')
    axes = list(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])
    for ax, label in zip(axes, y_labels):
        ax.set_ylabel(label)
        ax.grid(visible=True, linewidth=0.4)
        ax.margins(x=0.0)
    axes[-1].set_xlabel(x_label)
    return figure, axes
