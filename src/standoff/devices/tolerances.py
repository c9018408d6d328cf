"""Limits on what a device may say and how long it may take: each with its unit and its reason."""

from typing import Final

FARTHEST_CURSOR: Final = 1.0
"""Length [m], from a device's origin: an Inverse3 reaches a fifth of a metre, so a greater value is
wrong."""

FASTEST_CURSOR: Final = 20.0
"""Length a second [m/s]: a thrown ball leaves a hand faster, but a held handle does not reach half
of it; a cursor that jumps farther in the time between two frames is broken."""

JUMP_ALLOWED: Final = 5e-3
"""Length [m] by which a cursor may move between two frames however soon they follow each other:
the service samples by its own clock."""

LONGEST_FRAME: Final = 65_536
"""So many bytes of one message: an inventory of several devices has five thousand."""

CONNECTED_WITHIN: Final = 3.0
"""Seconds, a time to wait: many times what a service on the same machine takes to answer."""

CLOSED_WITHIN: Final = 0.2
"""Seconds, a time to wait: many times what a service on the same machine takes to say goodbye. One
that floods the connection never does, and the force was set to zero before."""

PERIOD_ROUNDING: Final = 1e-9
"""Relative: a trace may fall short of whole periods by this part and still have its last reading:
the roundoff of its stamps."""

ASKED_AGAIN: Final = 0.25
"""Seconds without an answer, many times what one takes, after which it counts as lost and the
device is asked again, with no force."""

BETWEEN_LOOKS: Final = 5e-5
"""Seconds, parts of the time that an answer takes, between two looks for it."""
