"""Limits of reading CAD files, so that a huge one is refused before it is read."""

from __future__ import annotations

from typing import Final

MOST_ENTITIES: Final = 1_000_000
"""Entities of a STEP file (lines of an IGES or BREP file) above which it is refused unread: reading
takes about 10 microseconds and 1 kB each, and a part of so many is a mesh in disguise."""

MOST_FACES: Final = 20_000
"""Faces of one solid above which it is refused: making it would take minutes."""

STORE_MEGABYTES: Final = 2000
"""Size of the store of finished parts, in MB, where STANDOFF_CACHE_SIZE names none: a part has some
10 kB a face, so these are thousands of parts."""

TRIMMED_TO: Final = 0.9
"""Fraction of its size to which a store that is larger is trimmed, so that it is not trimmed for
each part."""

STALE: Final = 3600.0
"""Age of a temporary file of the store, s, from which on its writer is taken to be gone: writing
takes less than a second."""
