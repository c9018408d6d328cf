"""Times of a servo loop: each with its unit and its reason."""

from typing import Final

LONGEST_GAP: Final = 0.1
"""Seconds, a time many times over what a loaded machine holds a loop up: beyond it a clock jumped
or the machine stood still, and a force of then is not to be held now."""

SPIN: Final = 1e-4
"""Seconds before each deadline, parts of a period, in which the loop spins: a sleeping thread is
woken late by some tens of microseconds."""

SPIN_SHARE: Final = 0.3
"""Share of a period that the loop may spin at most, so that a real-time loop leaves its core to
others."""

RATES_AGREE: Final = 1e-9
"""Relative: by this part a rate that is given may differ from the operator's: roundoff of both."""

SLOWEST: Final = 10.0
"""Times a second: below it no hand takes a force for one."""

FASTEST: Final = 10_000.0
"""Times a second: beyond it what a period leaves beside a tick is less than a clock's own cost."""

STOPPED_WITHIN: Final = 5.0
"""Seconds, many times a period, in which a loop that is asked to stop must have ended."""
