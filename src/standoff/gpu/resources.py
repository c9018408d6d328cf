"""What a kernel takes of a GPU: registers, local memory, operations. All of it without one."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
import time
from collections import Counter
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.gpu.compiler import Target, ptx_of
from standoff.gpu.threads import KERNELS
from standoff.whole_files import write_whole

DOUBLE = re.compile(r"^\s*(?:@!?%p\d+\s+)?(add|sub|mul|fma|div|rcp|sqrt)\S*\.f64\s", re.MULTILINE)
FUNCTION = re.compile(r"^\s*(?:\.visible |\.weak )?\.func", re.MULTILINE)
FACTS = {
    "registers": r"Used (\d+) registers",
    "stack": r"(\d+) bytes stack frame",
    "spilt": r"(\d+) bytes spill stores",
    "shared": r"(\d+) bytes smem",
}


class Resources(NamedTuple):
    """Of a kernel, as compiled for a compute capability.

    Attributes
    ----------
    kernel : str
    target : pair of int
    seconds : float
        Of compilation, to PTX and to machine code.
    registers : int
        Of a thread; at most 255.
    stack : int
        Bytes of local memory of a thread, in all.
    spilt : int
        Bytes of it that hold registers.
    shared : int
        Bytes of shared memory of a block.
    doubles : mapping of str to int
        Operations in double precision that stand in the PTX, by kind; loops count once.
    calls : int
        Functions that were not inlined.
    """

    kernel: str
    target: Target
    seconds: float
    registers: int
    stack: int
    spilt: int
    shared: int
    doubles: dict[str, int]
    calls: int


def resources_of(kernel: str, target: Target = (9, 0)) -> Resources:
    """Compile a kernel for a GPU that need not be there, and read what it takes.

    Raises ValueError: no such kernel, or a target that the compiler does not know.

    Parameters
    ----------
    kernel : str
        A name in ``standoff.gpu.threads.KERNELS``.
    target : pair of int
        Compute capability: (8, 0) of an A100, (9, 0) of an H100 or H200.

    Returns
    -------
    Resources
    """
    ptx, seconds = compiled(kernel, target)
    begun = time.perf_counter()
    told = assembled(ptx, target)
    counts = Counter(DOUBLE.findall(ptx))
    return Resources(
        kernel,
        target,
        seconds + time.perf_counter() - begun,
        **{name: _most(said, told) for name, said in FACTS.items()},
        doubles=dict(sorted(counts.items())),
        calls=len(FUNCTION.findall(ptx)),
    )


@lru_cache(maxsize=64)
def compiled(kernel: str, target: Target) -> tuple[str, float]:
    """(the PTX of a kernel, seconds that it took).

    Raises ValueError: no such kernel, or a target that the compiler does not know.
    """
    if kernel not in KERNELS:
        raise StandoffError(
            f"kernel = {shown(kernel)}: give one of {', '.join(KERNELS)}.", "kernel", kernel
        )
    begun = time.perf_counter()
    ptx = ptx_of(*KERNELS[kernel], target)
    return ptx, time.perf_counter() - begun


def _most(said: str, told: str) -> int:
    """The greatest number said, of the kernel and of functions that it calls."""
    return max((int(each) for each in re.findall(said, told)), default=0)


def assembler() -> str:
    """Where ptxas is.

    Raises ModuleNotFoundError: it is neither installed with the extra nor on the path.
    """
    found = find_spec("nvidia.cuda_nvcc")
    for folder in (found.submodule_search_locations or ()) if found else ():
        if (Path(folder) / "bin" / "ptxas").exists():
            return str(Path(folder) / "bin" / "ptxas")
    path = shutil.which("ptxas")
    if path is None:
        raise ModuleNotFoundError("ptxas was not found: pip install 'standoff[gpu]'")
    return path


def assembled(ptx: str, target: Target) -> str:
    """What ptxas tells of a kernel when it makes machine code of it."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "kernel.ptx"
        write_whole({source: lambda file: file.write(ptx.encode("utf-8"))})
        command = [assembler(), "-v", f"-arch=sm_{target[0]}{target[1]}", str(source)]
        command += ["-o", str(Path(folder) / "kernel.cubin")]
        done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise StandoffError(f"ptxas refuses the kernel: {done.stderr.strip()}")
    return done.stderr
