"""The square root as one instruction."""

import math
from typing import Any

from numba import config, types
from numba.extending import intrinsic

from standoff.kernels.compiler.decorators import small

if config.DISABLE_JIT:

    def _root(x: float) -> float:
        return math.sqrt(x) if x >= 0.0 else math.nan

else:

    @intrinsic
    def _root(typingctx: Any, x: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            root = builder.module.declare_intrinsic("llvm.sqrt", [args[0].type])
            return builder.call(root, args)

        return types.float64(types.float64), codegen


@small
def sqrt(x):  # type: ignore[no-untyped-def]
    """The square root; NaN of a negative number, without the branch to an error that `math.sqrt`
    compiles to, which keeps what stands around it from being vectorised."""
    return _root(x)
