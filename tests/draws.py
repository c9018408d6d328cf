"""How many random cases a test draws.

The numbers in the tests are those of every run. ``STANDOFF_DRAWS=10`` draws ten times as many
everywhere, ``STANDOFF_DRAWS=0.1`` a tenth.
"""

import os

FACTOR = float(os.environ.get("STANDOFF_DRAWS") or 1.0)


def draws(count: int) -> int:
    """Return how many cases to draw where every run draws ``count``: at least one."""
    return max(1, round(FACTOR * count))
