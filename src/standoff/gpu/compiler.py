"""How kernels are compiled for a GPU: the one place that knows numba-cuda.

numba-cuda compiles what a thread calls from the Python source of the kernels, so there is no second
mathematics. It is in maintenance, and its successor takes no functions of Numba: the extra ``gpu``
holds it within the versions that this file was written for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from types import SimpleNamespace
from typing import Any

from standoff.errors import StandoffError, not_installed
from standoff.kernels.compiler import modules
from standoff.kernels.compiler.entry import uncollected

WRITTEN_FOR = "0.30."

if find_spec("numba_cuda") is None:
    raise ModuleNotFoundError(not_installed("numba-cuda", "gpu"), name="numba_cuda")
if not version("numba-cuda").startswith(WRITTEN_FOR):
    raise ImportError(
        f"numba-cuda {version('numba-cuda')} is not one of {WRITTEN_FOR}*, which standoff.gpu was "
        "written for: pip install 'standoff[gpu]'",
        name="numba_cuda",
    )

cuda: Any = import_module("numba.cuda")
dispatcher: Any = import_module("numba.cuda.dispatcher")

SIMULATED = bool(cuda.config.ENABLE_CUDASIM)
"""Does Python take the GPU's place (NUMBA_ENABLE_CUDASIM=1)? For tests of a few rows."""

Target = tuple[int, int]
"""A compute capability: (9, 0) of an H200."""


def _for_a_device(part: Any) -> Any:
    """What numba-cuda calls in place of a kernel: compiled from the same source.

    It would ask for all `small` kernels to be inlined at once, before any is simplified, which
    takes three times as long and gives the same code.
    """
    if part not in _FOR_A_DEVICE:
        options = {k: v for k, v in part.targetoptions.items() if k != "forceinline"}
        options |= {"device": True, "debug": False, "opt": True}
        _FOR_A_DEVICE[part] = dispatcher.CUDADispatcher(part.py_func, options)
    return _FOR_A_DEVICE[part]


_FOR_A_DEVICE: dict[Any, Any] = {}


def _each_once(library: Any) -> list[str]:
    """The modules that a kernel is linked of. numba-cuda names one again for every way on which a
    call leads to it, some ten times, and all of them would be read and thrown away."""
    if library._llvm_strs is None:
        library._llvm_strs = [str(module) for module in dict.fromkeys(library.modules)]
    found: list[str] = library._llvm_strs
    return found


if not SIMULATED:
    codegen: Any = import_module("numba.cuda.codegen")
    codegen.CUDACodeLibrary.llvm_strs = property(_each_once)
    # where numba-cuda itself would keep what it makes of another compiler's function
    modules.Part._CUDATypingContext__dispatcher = property(_for_a_device)  # type: ignore[attr-defined]


@contextmanager
def _as_if_on(target: Target) -> Iterator[None]:
    """Let functions below a kernel be compiled where there is no GPU: numba-cuda asks for one."""
    asked = dispatcher.get_current_device
    dispatcher.get_current_device = lambda: SimpleNamespace(compute_capability=target)
    try:
        yield
    finally:
        dispatcher.get_current_device = asked


def ptx_of(function: Callable[..., None], signature: tuple[Any, ...], target: Target) -> str:
    """The PTX of what a thread does; it needs no GPU."""
    with _as_if_on(target), uncollected():
        ptx, _ = cuda.compile_ptx(function, signature, cc=target, device=False)
    return str(ptx)


def launched(function: Callable[..., None]) -> Any:
    """What starts threads that do this."""
    return cuda.jit(function)


def check_there() -> None:
    """Raise if there is no GPU that can be used.

    Raises StandoffError: there is none, or no driver for it.
    """
    if not cuda.is_available():
        raise StandoffError(
            "standoff.gpu: no NVIDIA GPU with a driver was found. so.distances and so.Tracker "
            "answer the same on the processor; `python -m benchmarks.gpu --compile-only` needs "
            "no GPU."
        )
