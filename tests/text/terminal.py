"""A stream that is a terminal, for tests of what is shown there only."""

import io


class Terminal(io.StringIO):
    """Keeps what was written to it."""

    def isatty(self) -> bool:
        return True
