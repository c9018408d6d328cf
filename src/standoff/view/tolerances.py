"""Limits of the live page, each with its unit and reason."""

from __future__ import annotations

from typing import Final

MAX_MESSAGE: Final = 16384
"""Longest message that a page may send, bytes: a pose, a camera or a value is below 1000."""

MESSAGE_RATE: Final = 240.0
"""Messages that a page may send for long, so many a second: its camera and one dragged frame are
each sent up to 50 times a second."""

MESSAGE_BURST: Final = 480.0
"""Messages that a page may send at once, so many: two seconds of `MESSAGE_RATE`, for a machine that
slept."""

MAX_PAGES: Final = 8
"""Pages that may be open at the same time, so many: each is sent the whole scene."""

MAX_TEXT: Final = 200
"""Longest text among the values of a message, so many characters: names of scenes and laws."""

MAX_DEPTH: Final = 4
"""Deepest nesting of a message that is read, so many levels: viser's own have three."""

LIFT: Final = 2e-3
"""How far the active feature is drawn off the body, over its size: drawn in the same place, the
two would flicker through each other."""

TICK: Final = 1e-3
"""Time step of coupler, dynamics and contact [s]: the rate of haptic devices."""

FILM_RATE: Final = 25.0
"""Most pictures of a film, so many a second: motion looks smooth with them, and a GIF, which
counts in hundredths of a second, shows them exactly."""

LEAST_FILM_RATE: Final = 2.0
"""Fewest pictures of a film, so many a second: with fewer it looks as if it had stopped."""

MOST_LOGGED: Final = 2000
"""Most frames of a run that are written for rerun, so many: each takes some 4 kB there."""

LEVEL_PLOT: Final = 1e-6
"""Change of the distance over the bodies' size below which the curve counts as level: scaled up,
it would show the roundoff of poses, in numbers of many digits."""

SAID_TO_TOUCH: Final = 1e-9
"""Distance and depth, over the bodies' size, up to which they are said to touch: far above the
bounds' roundoff, and far below what can be seen or made."""

SEEN_INTO: Final = 0.02
"""Depth over the smaller body's size from which bodies are shown as of glass: above what a tool of
the coupler presses in, so that a contact does not flicker."""

MOST_COURSE: Final = 100_000
"""Most frames of a world's motion, so many: tracked before the page opens, at some 0.3 ms each."""

NEAR_MINIMA: Final = 0.3
"""Distance over the smaller one's size below which a page shows local minima, and down to which it
follows places of an overlap: those of its own neighbourhood, and so few that a frame takes
milliseconds."""

FRAME_EVALUATIONS: Final = 200_000
"""Most evaluations of a frame of solids, so many: some tenths of a second, after which the page
answers a hand again, and goes on with the next frame from there."""
