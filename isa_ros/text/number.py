"""A number as text."""


def digits(value: float | None, n: int) -> str:
    """Return ``n`` digits and no power of ten for a large number; - for none."""
    if value is None:
        return '-'
    return f'{value:.0f}' if abs(value) >= 10.0 ** n else f'{value:.{n}g}'
