"""Parts of a Markdown page that scripts write: from ``<!-- NAME -->`` to ``<!-- end -->``."""

from collections.abc import Mapping, Sequence

from isa_ros.errors import ConfigError

END = '<!-- end -->'


def with_parts(page: str, parts: Mapping[str, Sequence[str]]) -> str:
    """
    Return a page with the lines of its marked parts anew, an empty line above and below each.

    Raises
    ------
    ConfigError
        The page does not have the marker of a part exactly once, or no end after it.

    """
    for name, lines in parts.items():
        marker = f'<!-- {name} -->'
        head, _, rest = page.partition(marker)
        _, end, tail = rest.partition(END)
        if page.count(marker) != 1 or not end:
            raise ConfigError(
                f'{marker} ... {END} is in the page {page.count(marker)} times, must be once')
        page = '\n'.join([f'{head}{marker}', '', *lines, '', f'{END}{tail}'])
    return page
