"""Entries: compiled for one signature each, before the first call or by `prepare`, never again."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.core.typing.typeof import Purpose, typeof

from standoff.kernels.compiler import modules, notices
from standoff.kernels.compiler.cache import ModuleCache

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


@contextmanager
def uncollected() -> Iterator[None]:
    """Without collection of garbage: a compiler keeps nearly all of the many objects that it makes,
    and searching them for cycles again and again takes an eighth of its time."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


class WrongKind(TypeError):
    """Arguments of a terse entry are of another kind than it is compiled for."""


class Entry(CPUDispatcher):  # type: ignore[misc]
    """A function that Python calls, compiled for the types of `signature` alone.

    A terse one refuses other types without saying which (`WrongKind`): its caller converts them.
    `ready` says whether its machine code is loaded.
    """

    def __init__(
        self,
        function: Any,
        options: Any,
        signature: tuple[Any, ...],
        work: str,
        terse: bool = False,
    ) -> None:
        pipeline = {"pipeline_class": modules.EntryCompiler} if modules.AVAILABLE else {}
        super().__init__(function, targetoptions=options, **pipeline)
        self.signature, self.work, self.terse = signature, work, terse
        self.ready = False
        self._cache = ModuleCache(function, work)

    def prepare(self) -> None:
        """Load the machine code, or compile it; nothing is compiled after that.

        Of threads that call at once, one does it and the others wait.
        """
        if self.ready:
            return
        with global_compiler_lock:
            if not self.ready:
                with notices.waiting(self.work, self.py_func.__name__), uncollected():
                    self.compile(self.signature)
                self.disable_compile()
                self.ready = True

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        """Called by Numba at the first call, where nothing was prepared."""
        self.prepare()
        self._check(args)
        return self.overloads[self.signature].entry_point

    def _explain_matching_error(self, *args: Any, **kws: Any) -> None:
        """Called by Numba where the machine code does not fit the arguments."""
        if self.terse:  # the caller knows what to do, and every microsecond counts
            raise WrongKind
        self._check(args)

    def _check(self, args: tuple[Any, ...]) -> None:
        names = self._compiler.pysig.parameters
        for name, given, wanted in zip(names, args, self.signature, strict=True):
            kind = typeof(given, Purpose.argument)
            if self.typingctx.can_convert(kind, wanted) is None:
                if self.terse:
                    raise WrongKind
                raise TypeError(
                    f"{self.py_func.__name__}: {name} is {kind}, not {wanted}; the kernels are "
                    "compiled for one kind of arguments, before the loop begins."
                )
