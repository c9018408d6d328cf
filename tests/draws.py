"""How many random cases a test draws.

The numbers in the tests are those of ``STANDOFF_DRAWS=1``; a run draws a third of them, as the
draws are the same in each. ``STANDOFF_DRAWS=10`` draws ten times as many everywhere.
"""

import os

EVERY_RUN = 1.0 / 3.0
"""What `make test` draws of them."""
FACTOR = float(os.environ.get("STANDOFF_DRAWS") or EVERY_RUN)


def draws(count: int) -> int:
    """Return how many cases to draw where ``STANDOFF_DRAWS=1`` draws ``count``: at least one."""
    return max(1, round(FACTOR * count))
