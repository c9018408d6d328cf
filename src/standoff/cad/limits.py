"""Limits of reading CAD files, so that a huge one is refused before it is read."""

from __future__ import annotations

from typing import Final

MOST_ENTITIES: Final = 1_000_000
"""Entities of a STEP file (lines of an IGES or BREP file) above which it is refused unread: reading
takes about 10 microseconds and 1 kB each, and a part of so many is a mesh in disguise."""

MOST_FACES: Final = 20_000
"""Faces of one solid above which it is refused: making it would take minutes."""
