"""The kernels as object files for a linker: ``python -m standoff.c_interface.objects FOLDER``.

They are compiled as for Python, by the same passes, and so give the same answers to the last bit;
only the addresses in them are relative, as a shared library requires. No kernel calls Python:
whatever else they need is in the C mathematics library.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numba
from llvmlite import binding as llvm
from numba.core import types

from standoff.c_interface.pair_file import SMOOTH_FRAMES
from standoff.errors import StandoffError
from standoff.kernels.compiler import modules
from standoff.kernels.compiler.decorators import BOUNDS_CHECK, CONTRACTED
from standoff.kernels.compiler.entry import uncollected
from standoff.kernels.entries import c_interface as kernels
from standoff.kernels.entries import laws, paper_laws, solid_frame
from standoff.progress import Progress
from standoff.whole_files import write_whole

TABLE_AND_BLOCK = types.int64, types.int64
RECORD_AND_STEP = types.int64, types.float64

SYMBOLS = {
    "standoff_kernel_start": kernels.start_in_block,
    "standoff_kernel_step": kernels.step_in_block,
    "standoff_kernel_solids": solid_frame.frame_of_solids,
}


LAWS = {"standoff_kernel_predicted": laws.predicted, "standoff_kernel_paper": paper_laws.paper}
"""The laws' frames."""


def smooth_symbols() -> list[str]:
    """Names of the smooth frames in the library, in the order of files of pairs."""
    return [f"standoff_kernel_{frame.py_func.__name__}" for frame in SMOOTH_FRAMES]


def compiled_libraries(progress: Progress) -> tuple[dict[str, str], list[Any]]:
    """(kernels' own symbols to those of the library, all modules of machine code), compiled now."""
    renamed: dict[str, str] = {}
    found: dict[int, Any] = {}
    asked: list[tuple[str, Any, Any]] = [
        (symbol, kernel, TABLE_AND_BLOCK) for symbol, kernel in SYMBOLS.items()
    ]
    for symbol, frame in [*zip(smooth_symbols(), SMOOTH_FRAMES, strict=True), *LAWS.items()]:
        # the frame itself, without what lets Python call it
        bare = modules.Part(frame.py_func, CONTRACTED, modules.SharedCompiler)
        asked.append((symbol, bare, RECORD_AND_STEP))
    for done, (symbol, kernel, signature) in enumerate(asked):
        progress(done, len(asked))
        kernel.compile(signature)
        made = kernel.overloads[signature]
        renamed[made.fndesc.llvm_func_name] = symbol
        for library in _reached(made.library):
            found[id(library)] = library  # two may bear one name
    progress(len(asked), len(asked))
    return renamed, list(found.values())


def _reached(library: Any) -> Iterator[Any]:
    yield library
    for module in library.modules:
        yield from _reached(module)


def relocatable_machine(codegen: Any) -> Any:
    """Numba's own target, for code that may lie anywhere."""
    options: dict[str, Any] = {"opt": numba.config.OPT}  # type: ignore[attr-defined]
    codegen._customize_tm_options(options)
    options |= {"reloc": "pic"}
    return llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(**options)


def hidden(code: llvm.ModuleRef, renamed: dict[str, str]) -> llvm.ModuleRef:
    """Give the kernels that C calls their names, and hide all that crosses modules."""
    for function in code.functions:
        if function.name in renamed:
            function.name = renamed[function.name]
        own = function.name.startswith((modules.OWN_SYMBOL, "standoff_kernel_"))
        if own and function.linkage == llvm.Linkage.external:
            function.visibility = "hidden"
    for variable in code.global_variables:
        if variable.name.startswith(modules.ENVIRONMENT):  # unused: no kernel calls Python
            variable.visibility = "hidden"
    return code


def write(folder: Path, progress: Progress = lambda done, total: None) -> None:
    """Compile all that the library calls and write it to a folder, one object file per module."""
    with uncollected():
        renamed, libraries = compiled_libraries(progress)
    machine = relocatable_machine(libraries[0]._codegen)
    files = {}
    for number, library in enumerate(libraries):
        code = hidden(llvm.parse_assembly(library.get_llvm_str()), renamed)
        content = machine.emit_object(code)
        files[folder / f"{number}.o"] = lambda file, content=content: file.write(content)
    write_whole(files)


def build(folder: Path, processor: str | None = None, progress: Progress | None = None) -> None:
    """`write` in a process of its own with an empty cache, which holds no code to link again.

    Parameters
    ----------
    folder : Path
    processor : str, optional
        LLVM's name, such as ``x86-64-v3``; this machine's own if not given.
    progress : callable, optional
        ``progress(done, total)`` is called with the parts compiled so far, and all.
    """
    if not modules.AVAILABLE or numba.config.DISABLE_JIT or BOUNDS_CHECK:  # type: ignore[attr-defined]
        raise StandoffError(
            f"The C library is built by Numba {modules.WRITTEN_FOR}x (this is {numba.__version__}) "
            f"with NUMBA_DISABLE_JIT, STANDOFF_BOUNDS_CHECK and {modules.FORCE_STOCK} unset."
        )
    with tempfile.TemporaryDirectory() as empty:
        environment = os.environ | {"NUMBA_CACHE_DIR": empty}
        if processor is not None:
            environment |= {"NUMBA_CPU_NAME": processor, "NUMBA_CPU_FEATURES": ""}
        command = [sys.executable, "-m", "standoff.c_interface.objects", str(folder)]
        # Errors go to a file: two pipes that are read one after the other may fill up.
        with (
            tempfile.TemporaryFile("w+") as errors,
            subprocess.Popen(
                command, env=environment, stdout=subprocess.PIPE, stderr=errors, text=True
            ) as process,
        ):
            for told in process.stdout or ():
                if progress is not None:
                    done, total = map(int, told.split())
                    progress(done, total)
            code = process.wait()
            errors.seek(0)
            said = errors.read().strip()
    if code != 0:
        raise StandoffError(f"The kernels could not be compiled for C:\n{said}")


def _tell(done: int, total: int) -> None:
    """How far it has come, to the process that started this one."""
    print(done, total, flush=True)


if __name__ == "__main__":
    write(Path(sys.argv[1]), _tell)
