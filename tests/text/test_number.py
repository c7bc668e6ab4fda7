"""Numbers as text."""

from isa_ros.text.number import digits
import pytest


@pytest.mark.parametrize('value, n, expected', [
    (None, 3, '-'), (0.0, 3, '0'), (0.012345, 3, '0.0123'), (999.4, 3, '999'),
    (1000.0, 3, '1000'), (-41712.3, 3, '-41712'), (9999.0, 4, '9999'), (12345.0, 4, '12345')])
def test_a_large_number_has_no_power_of_ten(value, n, expected):
    assert digits(value, n) == expected
