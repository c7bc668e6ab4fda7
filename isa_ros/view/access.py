"""
Who may talk to the page's server: the browser that was given its address, and nobody else.

Every path begins with a token that is drawn at the start. The header Host must be that of the
server, so that another name that leads to it (DNS rebinding) is refused; where there is an Origin,
as in every POST of a browser, it must be the page's own.
"""

from collections.abc import Sequence
import hmac
import secrets

HOST = '127.0.0.1'
"""The only address that the server listens at."""
_NAMES = (HOST, 'localhost')
_BYTES = 24


class Access:
    """The token of a server and its names at a port."""

    def __init__(self, port: int) -> None:
        self.token = secrets.token_urlsafe(_BYTES)
        """First part of every path."""
        self.url = f'http://{HOST}:{port}/{self.token}/'
        """Address of the page."""
        self._hosts = {f'{name}:{port}' for name in _NAMES}
        self._origins = {f'http://{host}' for host in self._hosts}

    def path_in(
            self, path: str, hosts: Sequence[str], origins: Sequence[str], *, writes: bool
            ) -> str | None:
        """
        Return the part of a path behind the token; None: the request is refused.

        ``hosts`` and ``origins`` are the values of these headers.
        """
        if len(hosts) != 1 or hosts[0] not in self._hosts:
            return None
        if len(origins) > 1 or (writes and not origins):
            return None
        if origins and origins[0] not in self._origins:
            return None
        token, slash, rest = path.removeprefix('/').partition('/')
        if not hmac.compare_digest(token.encode(), self.token.encode()) or not slash:
            return None
        return rest
