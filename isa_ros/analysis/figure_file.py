"""Files of figures that a command writes."""

from pathlib import Path

from isa_ros.errors import ConfigError


def refuse_figure(path: Path | None) -> None:
    """
    Refuse, before the work, a figure in an unknown format.

    Raises
    ------
    ConfigError
        The end of its name is not that of a format of Matplotlib.

    """
    if path is None:
        return
    from matplotlib.figure import Figure    # without a figure it is never loaded
    known = sorted(Figure().canvas.get_supported_filetypes())
    if path.suffix[1:] not in known:
        raise ConfigError(f'--out {path}: must end in one of .{", .".join(known)}')
