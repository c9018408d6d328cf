"""Compiled kernels: Numba over tuples and flat arrays, in the order of the paper.

Numba's disk cache looks at the file of a kernel only, not at those of the kernels it calls; an
edited callee would leave stale machine code in its callers. So the cache is dropped whenever any
file of this folder has changed.
"""

import hashlib
from pathlib import Path


def _drop_stale_cache() -> None:
    folder = Path(__file__).parent
    cache = folder / "__pycache__"
    digest = hashlib.sha256()
    for source in sorted(folder.glob("*.py")):
        digest.update(source.read_bytes())
    stamp = cache / "kernels.sha256"
    try:
        if stamp.exists() and stamp.read_text() == digest.hexdigest():
            return
        cache.mkdir(exist_ok=True)
        for stale in (*cache.glob("*.nbi"), *cache.glob("*.nbc")):
            stale.unlink(missing_ok=True)
        stamp.write_text(digest.hexdigest())
    except OSError:
        # A read-only installation: Numba caches elsewhere, and an installer gave every file of
        # this version a new time stamp, which Numba does look at.
        return


_drop_stale_cache()
