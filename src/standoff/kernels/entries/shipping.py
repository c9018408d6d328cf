"""Writes the machine code of a wheel: ``python -m standoff.kernels.entries.shipping FOLDER``.

All entries and the kernels that they share are compiled in a process of their own, with an empty
cache: for the level x86-64-v3 on x86-64, for LLVM's `generic` processor on other architectures.
`make wheel` does this and packs the folder (``hatch_build.py``). What is compiled is not run here,
so a builder of the right architecture need not have the level itself.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from functools import partial
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

import numba
from numba.core import config
from numba.core.serialize import dumps

from standoff.kernels.compiler import machine, modules, shipped
from standoff.kernels.compiler.cache import stored_of
from standoff.whole_files import Writer, write_whole

INTEL = ("x86_64", "amd64")
# Set by `build` in the process that it starts: the processor is named before Numba is imported.
TARGETED = "STANDOFF_SHIPPING"


def target() -> tuple[str, list[str]]:
    """(processor, features that it has above the least one) that the machine code is for."""
    if machine.system().split()[1] in INTEL:
        return "x86-64-v3", machine.X86_64_V3
    return "generic", []


def build(folder: Path) -> None:
    """Compile everything into a new folder, in a new process."""
    with tempfile.TemporaryDirectory() as empty:
        environment = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("NUMBA_", "STANDOFF_"))
        }
        environment |= {
            TARGETED: "1",
            "NUMBA_CACHE_DIR": empty,
            "NUMBA_CPU_NAME": target()[0],
            "NUMBA_CPU_FEATURES": "",
        }
        command = [sys.executable, "-m", "standoff.kernels.entries.shipping", str(folder)]
        subprocess.run(command, env=environment, check=True)


def write(folder: Path, entries: Iterable[Any]) -> None:
    """Compile entries for the processor that NUMBA_CPU_NAME names, and write them with a manifest.

    Parameters
    ----------
    folder : Path
        New or empty.
    entries : Iterable[Any]
        Of `Entry`.
    """
    if not modules.AVAILABLE:
        raise RuntimeError(
            f"Numba {numba.__version__} compiles each kernel by itself; use a version that begins "
            f"with {modules.WRITTEN_FOR}, and leave {modules.FORCE_STOCK} unset"
        )
    processor, features = target()
    if processor != config.CPU_NAME or config.CPU_FEATURES != "":
        raise RuntimeError(
            f"set NUMBA_CPU_NAME={processor} and an empty NUMBA_CPU_FEATURES, not "
            f"{config.CPU_NAME} and {config.CPU_FEATURES}"
        )
    folder.mkdir(parents=True, exist_ok=True)
    written: dict[str, tuple[str, str]] = {}
    files: dict[Path, Writer] = {}
    for function, result in compiled(entries):
        key = shipped.key_of(function, tuple(result.signature.args))
        if key not in written:
            data = dumps(stored_of(result))
            name = (
                f"{function.__module__.rpartition('.')[2]}.{function.__name__}.{len(written)}.bin"
            )
            files[folder / name] = partial(_put, data)
            written[key] = (name, sha256(data).hexdigest())
    manifest = {
        **shipped.made_by(),
        "processor": processor,
        "features": features,
        "sources": machine.source_digest(),
        "modules": written,
    }
    files[folder / shipped.MANIFEST] = partial(
        _put, (json.dumps(manifest, indent=1) + "\n").encode()
    )
    write_whole(files)


def _put(data: bytes, file: BinaryIO) -> None:
    file.write(data)


def compiled(entries: Iterable[Any]) -> Iterator[tuple[Any, Any]]:
    """(function, compiled module) of entries, and of the shared kernels that they call."""
    for entry in entries:
        entry.prepare()
        yield from _with_called(entry.py_func, entry.overloads[entry.signature])


def _with_called(function: Any, result: Any) -> Iterator[tuple[Any, Any]]:
    yield function, result
    for module in result.library.modules:
        name, attribute, arguments = module.origin
        kernel = getattr(import_module(name), attribute)
        yield from _with_called(kernel.py_func, kernel.overloads[arguments])


if __name__ == "__main__":
    if os.environ.get(TARGETED):
        from standoff.kernels.entries.preparing import every_entry

        write(Path(sys.argv[1]), every_entry())
    else:
        build(Path(sys.argv[1]))
