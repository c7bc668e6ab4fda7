"""Bags that processes have recorded."""

import hashlib
from pathlib import Path


def mcap_file(bag: Path) -> Path:
    """Return the recorder's file."""
    return bag / f'{bag.name}_0.mcap'


def sha256(bag: Path) -> str:
    """Return the SHA-256 of the recorded messages."""
    return hashlib.sha256(mcap_file(bag).read_bytes()).hexdigest()
