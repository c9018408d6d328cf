"""Loops of the studies that are compiled with the library's kernels, and kept on disk like them."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from standoff.kernels.compiler.cache import ModuleCache
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.compiler.modules import Part


class _OwnCache(ModuleCache):
    """Keeps machine code under a digest of its function's file, too, which is none of the library's
    sources."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function, called=True)
        self._file = Path(function.__code__.co_filename)

    def _begin(self) -> None:
        if not self._ready:
            super()._begin()
            own = hashlib.sha256(self._file.read_bytes()).hexdigest()
            self._cache_file._version += f" {own}"


def own_kernel(function: Callable[..., Any]) -> Any:
    """Compile what Python and other such functions of the same file call.

    It takes some ten seconds the first time. By a Numba for which the library's compiler was not
    written, each process compiles it.
    """
    made = kernel(function)
    if isinstance(made, Part):
        made.cache_of_calls = _OwnCache(function)
    return made
