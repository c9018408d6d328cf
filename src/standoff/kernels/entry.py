"""Entries: compiled for one signature each, before the first call or by `prepare`, never again."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types
from numba.core.registry import CPUDispatcher
from numba.core.typing.typeof import Purpose, typeof

from standoff.kernels import modules, notices
from standoff.kernels.cache import ModuleCache

INT, REAL, BOOL = types.int64, types.float64, types.boolean
# What bodies and options hold is read-only; everything else that Python hands over is not.
INTS = types.Array(INT, 1, "C", readonly=True)
READ = types.Array(REAL, 1, "C", readonly=True)
WRITE = types.Array(REAL, 1, "C")
ROWS = types.Array(REAL, 2, "C")
PAIR = types.Tuple((INTS, READ, INTS, READ))
WRITE_INTS = types.Array(INT, 1, "C")
VECTOR = types.UniTuple(REAL, 3)
# Batches: read-only ones take both kinds.
READ_ROWS = types.Array(REAL, 2, "C", readonly=True)
READ_BLOCKS = types.Array(REAL, 3, "C", readonly=True)
BLOCKS = types.Array(REAL, 3, "C")


class Entry(CPUDispatcher):  # type: ignore[misc]
    """A function that Python calls, compiled for the types of `signature` alone."""

    def __init__(self, function: Any, options: Any, signature: tuple[Any, ...], work: str) -> None:
        pipeline = {"pipeline_class": modules.EntryCompiler} if modules.AVAILABLE else {}
        super().__init__(function, targetoptions=options, **pipeline)
        self.signature, self.work = signature, work
        self._cache = ModuleCache(function, work)

    @property
    def ready(self) -> bool:
        """Is the machine code loaded?"""
        return self.signature in self.overloads

    def prepare(self) -> None:
        """Load the machine code, or compile it."""
        if not self.ready:
            with notices.waiting(self.work):
                self.compile(self.signature)

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        """Called by Numba where no machine code fits the arguments."""
        self.prepare()
        names = self._compiler.pysig.parameters
        for name, given, wanted in zip(names, args, self.signature, strict=True):
            kind = typeof(given, Purpose.argument)
            if self.typingctx.can_convert(kind, wanted) is None:
                raise TypeError(
                    f"{self.py_func.__name__}: {name} is {kind}, not {wanted}; the kernels are "
                    "compiled for one kind of arguments, before the loop begins."
                )
        return self.overloads[self.signature].entry_point


def read_only(array: Any, dtype: Any = np.float64) -> Any:
    """A read-only, contiguous view or copy of an array, as entries take bodies and options."""
    fitting = np.ascontiguousarray(array, dtype=dtype)
    if fitting.flags.writeable:
        fitting = fitting.view()
        fitting.flags.writeable = False
    return fitting
