"""A number as text."""


def digits(value: float | None, n: int) -> str:
    """Return a number with ``n`` digits, without exponent if it is large; '-' for None."""
    if value is None:
        return '-'
    return f'{value:.0f}' if abs(value) >= 10.0 ** n else f'{value:.{n}g}'
