"""Times of a servo loop: each with its unit and its reason."""

from typing import Final

LONGEST_GAP: Final = 0.1
"""Seconds, many times what a loaded machine delays a loop by: beyond it a clock jumped or the
machine stood still, and a force from before must not be held now."""

SPIN: Final = 1e-4
"""Seconds before each deadline, parts of a period, in which the loop spins: a sleeping thread is
woken late by some tens of microseconds."""

SPIN_SHARE: Final = 0.3
"""Share of a period that the loop may spin at most, so that a real-time loop leaves its core to
others."""

RATES_AGREE: Final = 1e-9
"""Relative: a rate that is given may differ from the operator's by this part: roundoff of both."""

SLOWEST: Final = 10.0
"""Times a second: below it no hand feels a steady force."""

FASTEST: Final = 10_000.0
"""Times a second: beyond it a period leaves less time beside a tick than a clock costs."""

STOPPED_WITHIN: Final = 5.0
"""Seconds, many times a period, within which a loop that is asked to stop must have ended."""
