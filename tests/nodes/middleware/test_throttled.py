"""How often warnings about messages of others are logged."""

from types import SimpleNamespace

from isa_ros.nodes.middleware.throttled import BURST, ThrottledWarnings


def test_a_few_in_a_row_are_logged_and_of_many_one_a_second():
    """A pause gives back as many as it has seconds, and no more than at first."""
    at, logged = 0.0, []
    warn = ThrottledWarnings(SimpleNamespace(warning=logged.append), lambda: at)

    def after(pause: float, n: int) -> int:
        nonlocal at
        at += pause
        before = len(logged)
        for k in range(n):
            warn(f'{at} {k}')
        return len(logged) - before
    assert after(0.0, 3) == 3 and after(0.01, 5) == BURST - 3
    assert after(0.9, 5) == 0 and after(0.1, 5) == 1
    assert sum(after(0.001, 1) for _ in range(10_000)) == 10
    assert after(2.5, 9) == 2
    assert after(60.0, 9) == BURST
    assert logged[:2] == ['0.0 0', '0.0 1']
