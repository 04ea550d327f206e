"""Numbers in words."""

import math

from asperity.base.words import data_size, duration, thousands, uncertain


def test_numbers_in_words() -> None:
    for value, error, text in (
        (3.0612, 0.0229, "3.061 ± 0.023"),
        (55.2, 13.9, "55 ± 14"),
        (35.0, 212.0, "35 ± 200"),
        (0.5, math.inf, "0.5 (undetermined)"),
        (2.0, 0.0, "2"),
    ):
        assert uncertain(value, error) == text
    assert thousands(40000) == "40\u202f000"
    assert [data_size(n) for n in (999, 2.5e6, 2e10, 3e15)] == ["999 B", "2.5 MB", "20 GB", "3e+03 TB"]
    for seconds, text in (
        (0.26, "0.26 seconds"),
        (59.6, "60 seconds"),
        (200.0, "3.3 minutes"),
        (7260.0, "2 hours"),
        (1e6, "12 days"),
        (math.nan, "not determined"),
    ):
        assert duration(seconds) == text
