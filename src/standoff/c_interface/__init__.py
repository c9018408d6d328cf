"""Standoff without Python: a shared library with a C header, and files of pairs that it loads.

``build_library`` makes the library once; ``save_pair`` writes a tracker's bodies and law to a file.
docs/c-interface.md has a whole program.
"""

from standoff.c_interface.library import build_library
from standoff.c_interface.pair_file import save_pair

__all__ = ["build_library", "save_pair"]
