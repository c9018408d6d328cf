"""What machine code depends on: sources, versions, options and the processor."""

from __future__ import annotations

import hashlib
import os
import platform
import sys
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

import llvmlite
import numba
from llvmlite import binding as llvm
from numba.core import config

# fmt: off
X86_64_V3 = [
    "avx", "avx2", "bmi", "bmi2", "cx16", "f16c", "fma", "lzcnt", "movbe", "popcnt", "sahf",
    "sse3", "sse4.1", "sse4.2", "ssse3", "xsave",
]
"""What the level x86-64-v3 of the x86-64 psABI has above the first level, in LLVM's names."""

HAVE_V3 = frozenset({
    "x86-64-v3", "x86-64-v4", "core-avx2", "haswell", "broadwell", "skylake",
    "skylake-avx512", "skx", "cascadelake", "cooperlake", "cannonlake", "icelake-client",
    "icelake-server", "rocketlake", "tigerlake", "sapphirerapids", "emeraldrapids",
    "graniterapids", "graniterapids-d", "alderlake", "raptorlake", "meteorlake",
    "arrowlake", "arrowlake-s", "lunarlake", "pantherlake", "gracemont", "sierraforest",
    "grandridge", "clearwaterforest", "znver1", "znver2", "znver3", "znver4", "znver5",
})
# fmt: on
"""LLVM's names of processors with all of `X86_64_V3`: llvmlite only knows the features of the host,
so of a processor that NUMBA_CPU_NAME names only the name is known."""


KERNELS = Path(__file__).parents[1]
"""The folder of all kernels."""


@lru_cache(maxsize=1)
def source_digest() -> str:
    """Of all kernels' files, and of the versions that make machine code of them."""
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.__version__}".encode())
    for source in sorted(KERNELS.rglob("*.py")):
        name = source.relative_to(KERNELS).as_posix()
        digest.update(name.encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()


def bounds_checked() -> bool:
    return os.environ.get("STANDOFF_BOUNDS_CHECK", "0") not in ("", "0")


def system() -> str:
    """Operating system and architecture, without the versions that the triple of macOS has."""
    return f"{sys.platform} {platform.machine().lower()}"


def lacking(features: Iterable[str]) -> str | None:
    """Which of the features this processor lacks, in words, or None.

    The host must have them, and so must the processor that NUMBA_CPU_NAME or NUMBA_CPU_FEATURES
    name in its place.
    """
    features = list(features)
    if not features:
        return None
    here = llvm.get_host_cpu_features()
    missing = [each for each in features if not here.get(each)]
    if missing:
        return f"this processor lacks {', '.join(missing)}"
    if config.CPU_NAME is not None and config.CPU_NAME not in HAVE_V3:
        return f"NUMBA_CPU_NAME={config.CPU_NAME} is not known to have {', '.join(features)}"
    if not config.ENABLE_AVX:
        return "NUMBA_ENABLE_AVX is 0"
    if config.CPU_FEATURES:
        # as LLVM reads the list, the last word on a feature counts
        named = {each[1:]: each[0] == "+" for each in config.CPU_FEATURES.split(",") if each}
        missing = [each for each in features if not named.get(each)]
        if missing:
            return f"NUMBA_CPU_FEATURES lacks {', '.join('+' + each for each in missing)}"
    return None
