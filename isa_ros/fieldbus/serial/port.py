"""
The door to a serial line: a pseudo terminal made here, or a serial device that exists.

A pseudo terminal has no rate; the given one is that of the modelled line, and its frames must fit.
"""

import fcntl
import os
from pathlib import Path
import select
import stat
import termios
import tty

from isa_ros.errors import ConfigError, RunError

_CHUNK = 65536      # bytes read at once


class SerialPort:
    """One end of the line."""

    def __init__(self, path: Path, baud: int) -> None:
        """
        Open the line: ``path`` becomes a link to a new pseudo terminal, unless it is a terminal.

        Raises
        ------
        ConfigError
            The path is something else, cannot be made or opened, is locked by another program,
            or the rate is not one of a serial device.

        """
        self._path, self._link_target = path, ''
        self._kept = -1
        self.unsent = 0
        """Frames that nobody has read in time."""
        try:
            if path.exists() and stat.S_ISCHR(path.stat().st_mode) and not path.is_symlink():
                self._own = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
                _refuse_unusable(self._own, path)
                tty.setraw(self._own)
                _set_rate(self._own, path, baud)
            else:
                self._make_pseudo_terminal()
        except (OSError, termios.error) as error:
            raise ConfigError(
                f'serial line {path}: cannot be opened: {error}') from error

    def receive(self, timeout: float) -> bytes:
        """
        Return the bytes that arrive within ``timeout`` seconds, b'' if none.

        Raises
        ------
        RunError
            The line is lost.

        """
        ready, _, _ = select.select([self._own], [], [], max(0.0, timeout))
        if not ready:
            return b''
        try:
            data = os.read(self._own, _CHUNK)
        except BlockingIOError:
            return b''
        except OSError as error:
            raise RunError(f'serial line {self._path} is lost: {error}') from error
        if not data:
            raise RunError(f'serial line {self._path} is lost: it was closed')
        return data

    def send(self, data: bytes) -> None:
        """Send a frame; one that finds the line full is counted, and cut where it was full."""
        try:
            self.unsent += os.write(self._own, data) < len(data)
        except BlockingIOError:
            self.unsent += 1
        except OSError as error:
            raise RunError(f'serial line {self._path} is lost: {error}') from error

    def close(self) -> None:
        """Close the line, and remove the link to the pseudo terminal."""
        for handle in (self._own, self._kept):
            if handle >= 0:
                os.close(handle)
        self._own = self._kept = -1
        if self._link_target and self._path.is_symlink() \
                and os.readlink(self._path) == self._link_target:
            self._path.unlink()

    def _make_pseudo_terminal(self) -> None:
        if self._path.is_symlink() and not self._path.exists():
            self._path.unlink()     # of a run that was killed
        if self._path.exists() or self._path.is_symlink():
            raise ConfigError(
                f'serial line {self._path}: exists and is no serial device; the line is made as a '
                'link to a new pseudo terminal')
        self._own, self._kept = os.openpty()
        os.set_blocking(self._own, False)
        # Kept open, so that the line outlives a master that closes its end.
        tty.setraw(self._kept)
        self._link_target = os.ttyname(self._kept)
        try:
            self._path.symlink_to(self._link_target)
        except OSError:
            self._link_target = ''
            self.close()
            raise


def _refuse_unusable(handle: int, path: Path) -> None:
    """Refuse what is no serial device; lock it by flock, as other programs for them do."""
    if not os.isatty(handle):
        os.close(handle)
        raise ConfigError(f'serial line {path}: is no serial device')
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise ConfigError(
            f'serial line {path}: another program uses it (it holds its lock); end that one or '
            'take another line') from None


def _set_rate(handle: int, path: Path, baud: int) -> None:
    speed = getattr(termios, f'B{baud}', None)
    if speed is None:
        os.close(handle)
        known = sorted(int(name[1:]) for name in dir(termios)
                       if name[0] == 'B' and name[1:].isdigit() and name != 'B0')
        raise ConfigError(
            f'serial line {path}: baud = {baud} is no rate of it; one of '
            f'{", ".join(map(str, known))}')
    attributes = termios.tcgetattr(handle)
    attributes[4] = attributes[5] = speed
    termios.tcsetattr(handle, termios.TCSANOW, attributes)
