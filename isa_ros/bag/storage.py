"""How the files of a bag are stored."""

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import choice, defaults, parameter, Parameters

BYTES_PER_MB = 1_000_000


@frozen(kw_only=True)
class Storage(Parameters):
    """Compression and splitting of a bag's files."""

    compression: str = choice('of every chunk of a bag', 'none', 'lz4', 'zstd', absent='none')
    split_mb: float = parameter(
        'size after which the next file of a bag begins; 0: one file', 'MB', absent=0.0, ge=0.0,
        le=1e6)

    @property
    def split_bytes(self) -> int | None:
        """Return the size after which the next file begins, None for one file."""
        return round(self.split_mb * BYTES_PER_MB) if self.split_mb else None


PLAIN = defaults(Storage)
