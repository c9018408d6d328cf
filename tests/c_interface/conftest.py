"""The library, built once, and programs that link with it."""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from c_interface.building import put_library
from standoff.kernels.compiler import modules
from standoff.kernels.compiler.decorators import BOUNDS_CHECK

HERE = Path(__file__).parent
STRICT = ("-O2", "-Wall", "-Wextra", "-Werror", "-pedantic")
STANDARDS = {"cc": "-std=c11", "c++": "-std=c++11"}


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the shared library and its header; ``progress`` has what was told meanwhile."""
    if shutil.which("cc") is None:
        pytest.skip("there is no C compiler: install gcc to test the C interface")
    if not modules.AVAILABLE or BOUNDS_CHECK:
        pytest.skip("the C library is made of kernels as this version of Numba compiles them")
    folder = tmp_path_factory.mktemp("c library")
    put_library(folder)
    return folder


@pytest.fixture(scope="session")
def program(library: Path) -> Callable[..., Path]:
    """Compile a source file with all warnings, as errors, and link it with the library."""

    def made(source: Path, compiler: str = "cc") -> Path:
        if shutil.which(compiler) is None:
            pytest.skip(f"there is no {compiler}")
        target = library / source.stem
        command = [compiler, STANDARDS[compiler], *STRICT, "-D_POSIX_C_SOURCE=199309L"]
        command += [f"-I{library}", "-o", str(target), str(source), f"-L{library}", "-lstandoff"]
        command += ["-lm", "-Wl,-rpath,$ORIGIN"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return target

    return made
