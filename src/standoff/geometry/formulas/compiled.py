"""Compiled jets of formulas: C functions that the kernels call by their address."""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.geometry.formulas.programs import ProgramText, jet_expressions
from standoff.typing import Array

# Names that the compiled text may use.
MATH = {
    "sin": math.sin, "cos": math.cos, "tan": math.tan,
    "asin": math.asin, "acos": math.acos, "atan": math.atan, "atan2": math.atan2,
    "sinh": math.sinh, "cosh": math.cosh, "tanh": math.tanh,
    "exp": math.exp, "log": math.log, "sqrt": math.sqrt, "power": math.pow,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Formula:
    """Three coordinates as exact expressions, and their compiled jet.

    key : the canonical text of x, y, z; equal keys share one Formula in a process
    expressions : SymPy, in plain symbols u, v or t
    jet : SymPy, the coordinates and their first and second partial derivatives
    function : Numba's C function `void jet(double u, double v, double *out18)`, or
        `void jet(double t, double *out9)`
    """

    key: tuple[str, ...]
    variables: tuple[str, ...]
    expressions: tuple[Any, ...]
    jet: tuple[Any, ...]
    function: Any

    @property
    def address(self) -> float:
        """The function's address: below 2^53, so exact in float64."""
        return float(self.function.address)

    def values(self, *at: float) -> Array:
        """(6, 3) or (3, 3): the jet's rows."""
        out = np.empty(len(self.jet))
        self.function.ctypes(*at, out.ctypes.data_as(self.function.ctypes.argtypes[-1]))
        return out.reshape(-1, 3)


# A kernel reads an address from a packed body, and a packed array keeps nothing alive: so compiled
# formulas are kept until the process ends (about 0.1 MB each).
_compiled: dict[tuple[str, ...], Formula] = {}
_lock = threading.Lock()


def compiled(expressions: tuple[Any, ...], variables: tuple[str, ...]) -> Formula:
    """The formula's compiled jet, compiled at most once per process."""
    key = (*variables, *(str(e) for e in expressions))
    with _lock:
        if key not in _compiled:
            _compiled[key] = _compile(key, expressions, variables)
        return _compiled[key]


def _compile(key: tuple[str, ...], expressions: tuple[Any, ...], variables: tuple[str, ...]) -> Any:
    from numba import cfunc, types

    jet = jet_expressions(expressions, variables)
    shared, outputs = ProgramText().body(jet)
    lines = [f"def jet({', '.join(variables)}, out):", *shared]
    lines += [f"out[{k}] = {text}" for k, text in enumerate(outputs)]
    namespace: dict[str, Any] = dict(MATH)
    exec("\n    ".join(lines), namespace)
    doubles = [types.float64] * len(variables)
    signature = types.void(*doubles, types.CPointer(types.float64))
    # a division by zero gives inf instead of an exception, which a C function cannot pass on
    function = cfunc(signature, error_model="numpy")(namespace["jet"])
    return Formula(key, variables, expressions, tuple(jet), function)
