"""What a sweep's numbers depend on besides its job: the library, and what it computes with."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import scipy

import standoff
from standoff.kernels.compiler.machine import source_digest, system
from standoff.version import __version__

NOT_COMPUTING = ("cli", "view", "clearance")
"""Packages that no number of a sweep comes from."""


@lru_cache(maxsize=1)
def code_facts() -> dict[str, Any]:
    """Return the versions and digests of sources, as plain data."""
    digest = hashlib.sha256()
    root = Path(standoff.__file__).parent
    for source in sorted(root.rglob("*.py")):
        name = source.relative_to(root).as_posix()
        if name.partition("/")[0] not in NOT_COMPUTING:
            digest.update(name.encode() + b"\0" + source.read_bytes())
    return {
        "standoff": __version__,
        "sources_sha256": digest.hexdigest(),
        "kernels_sha256": source_digest(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "system": system(),
    }
