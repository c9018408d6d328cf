"""Arrays on the GPU, and a pair of bodies there."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.gpu.compiler import cuda


def sent(array: NDArray[Any]) -> Any:
    """A copy of an array on the GPU."""
    return cuda.to_device(np.ascontiguousarray(array))


def empty(shape: tuple[int, ...], kind: Any = np.float64) -> Any:
    """An array on the GPU, its numbers not yet set."""
    return cuda.device_array(shape, kind)


def finish() -> None:
    """Wait until all threads are done."""
    cuda.synchronize()


def pair_and_options(arrays: tuple[NDArray[Any], ...]) -> tuple[Any, Any]:
    """What an `AddressTable` leads to, on the GPU: the pair's four arrays, and the options."""
    *bodies, options = arrays
    return tuple(sent(each) for each in bodies), sent(options)
