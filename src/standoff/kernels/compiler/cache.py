"""Where compiled modules are kept on disk, and when they are trusted.

Numba unpickles what it finds in a cache, and the machine code in it is run: a folder that other
users can write to is refused. A module is kept under a digest of all the kernels' sources, so an
edit of any of them makes them compile again. Modules are looked for in the folder that a wheel
carries (`shipped`), then, for reading and writing, in NUMBA_CACHE_DIR or the package's own
``__pycache__``, or else in the user's cache folder.
"""

from __future__ import annotations

import importlib
import os
import pickle
import sys
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

from llvmlite import binding as llvm
from numba.core import config
from numba.core.caching import (
    Cache,
    CompileResultCacheImpl,
    InTreeCacheLocator,
    UserProvidedCacheLocator,
    UserWideCacheLocator,
)
from numba.core.compiler import CompileResult
from numba.core.runtime import rtsys

from standoff.kernels.compiler import modules, notices, shipped
from standoff.kernels.compiler.machine import KERNELS, bounds_checked, source_digest
from standoff.kernels.compiler.notices import say
from standoff.kernels.compiler.trust import others_can_write

DAMAGED = (
    *(EOFError, pickle.UnpicklingError, ValueError, TypeError, KeyError, IndexError),
    *(AttributeError, ImportError),
)
"""What reading a truncated or overwritten file of pickles raises."""

compiled_elsewhere: Callable[[Any], None] | None = None
"""Set in a process among others: has the entry of a function that is not on disk compiled by the
process that they all ask, so that it is compiled once and reported once."""


class _Trusted:
    """Part of a locator: the digest in place of the file's own, and no folder that others can write
    to."""

    _cache_path: str

    @classmethod
    def from_function(cls, function: Any, path: str) -> Any:
        """One folder for all kernels, wherever below it a kernel's file stands."""
        return super().from_function(function, str(KERNELS / "__init__.py"))  # type: ignore[misc]

    def get_source_stamp(self) -> str:
        return source_digest()

    def ensure_cache_path(self) -> None:
        folder = Path(self._cache_path)
        made = folder
        while not made.exists():
            made = made.parent
        why = others_can_write(made.resolve())
        if why is not None:
            _refuse(str(folder), why)
            raise PermissionError(why)
        super().ensure_cache_path()  # type: ignore[misc]


@lru_cache(maxsize=16)
def _refuse(folder: str, why: str) -> None:
    say(
        f"not using the cache folder {folder}: {why}, and the machine code in it would be run. "
        "Remove that permission (chmod go-w), or name another folder in NUMBA_CACHE_DIR."
    )


class _Named(_Trusted, UserProvidedCacheLocator):  # type: ignore[misc]
    """NUMBA_CACHE_DIR."""


class _InTree(_Trusted, InTreeCacheLocator):  # type: ignore[misc]
    """``__pycache__`` beside the kernels."""


class _UserWide(_Trusted, UserWideCacheLocator):  # type: ignore[misc]
    """The user's cache folder, where the package cannot be written to."""


class _Nowhere:
    """No folder can be used: each process compiles for itself."""

    @classmethod
    def from_function(cls, function: Any, path: str) -> _Nowhere:
        return cls()

    def get_cache_path(self) -> str:
        return os.devnull

    def get_source_stamp(self) -> str:
        return source_digest()

    def get_disambiguator(self) -> str:
        return "0"

    def ensure_cache_path(self) -> None:
        raise OSError("no cache folder")


def stored_of(result: Any) -> Any:
    """What is kept of a compiled module: which others it calls, its symbols, its code."""
    called = [module.origin for module in getattr(result.library, "modules", ())]
    exported = sorted(getattr(result.library, "exported", ()))
    return called, exported, result._reduce()


def rebuilt(target_context: Any, stored: Any) -> Any:
    """The compiled module that `stored_of` took apart."""
    called, exported, reduced = stored
    for module, name, arguments in called:
        # code that calls a symbol needs it in place
        getattr(importlib.import_module(module), name).compile(arguments)
    result = CompileResult._rebuild(target_context, *reduced)
    if exported:
        fndesc = result.fndesc
        result.library.exported = set(exported)
        # a stock function that calls this kernel must not link what stands for it
        declared = "\n".join(f'declare void @"{name}"()' for name in exported)
        result.library._shared_module = llvm.parse_assembly(declared)
        result.library.origin = (fndesc.modname, fndesc.qualname, tuple(fndesc.argtypes))
    return result


class _Modules(CompileResultCacheImpl):  # type: ignore[misc]
    """How Numba's cache takes modules apart, and where it may keep them."""

    _locator_classes = (_Named, _InTree, _UserWide, _Nowhere)

    def reduce(self, result: Any) -> Any:
        return stored_of(result)

    def rebuild(self, target_context: Any, stored: Any) -> Any:
        return rebuilt(target_context, stored)


class ModuleCache(Cache):  # type: ignore[misc]
    """The cache of one entry, which is needed for some `work`, or of one shared kernel.

    Nothing is asked of the disk before machine code is.
    """

    _impl_class = _Modules

    def __init__(self, function: Any, work: str | None = None, called: bool = False) -> None:
        self._function, self._work, self._ready = function, work, False
        self._called = called  # of a kernel that Python calls by itself, as tests do
        self.enable()

    def _begin(self) -> None:
        if not self._ready:
            super().__init__(self._function)
            # an index of other sources is not unpickled: it may name a class that is gone
            index = self._cache_file
            index._version = f"{index._version} {source_digest()}"
            self._ready = True

    def load_overload(self, signature: Any, target_context: Any) -> Any:
        # All that machine code needs. Numba's own `load_overload` imports its whole library of
        # implementations here, which takes half a second; who compiles does that too.
        rtsys.initialize(target_context)
        stored = None if self._called else shipped.load(self._function, signature)
        if stored is not None:
            return rebuilt(target_context, stored)
        self._begin()
        found = self._kept(signature, target_context)
        if found is None and self._work is not None and compiled_elsewhere is not None:
            compiled_elsewhere(self._function)
            found = self._kept(signature, target_context)
        if found is None:
            _tell_stock()
            notices.compiling(self._keeps)
        return found

    @property
    def _keeps(self) -> bool:
        return not isinstance(self._impl.locator, _Nowhere)

    def _kept(self, signature: Any, target_context: Any) -> Any:
        """What is on disk, or None."""
        try:
            if self._keeps:
                with self._guard_against_spurious_io_errors():
                    return self._load_overload(signature, target_context)
        except DAMAGED as error:
            say(f"{self._cache_path}: what was kept is damaged ({error}); compiling it again.")
            self.flush()
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        try:
            super().save_overload(signature, result)
        except OSError as error:
            _unsaved(self._cache_path, str(error))

    def _index_key(self, signature: Any, codegen: Any) -> Any:
        # code of modules calls symbols that stock compilation does not make
        kind = (modules.AVAILABLE, self._called, bounds_checked())
        how = (*kind, str(config.OPT), sys.version_info[:2])
        return signature, codegen.magic_tuple(), how


@lru_cache(maxsize=1)
def _tell_stock() -> None:
    why = modules.why_stock()
    if why:
        say(
            f"{why} ({modules.WRITTEN_FOR}x): each kernel is compiled by itself, which takes ten "
            "times as long; the answers are the same."
        )


@lru_cache(maxsize=1)
def _unsaved(folder: str, why: str) -> None:
    say(f"the compiled kernels could not be kept ({why}): each process will compile them again.")
