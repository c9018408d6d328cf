"""The library, built once for its sources, and programs that link with it."""

import hashlib
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import llvmlite
import numba
import pytest
from llvmlite import binding as llvm

from standoff.c_interface import build_library
from standoff.c_interface.library import FLAGS, SOURCE
from standoff.kernels.compiler import modules
from standoff.kernels.compiler.decorators import BOUNDS_CHECK

HERE = Path(__file__).parent
STRICT = ("-O2", "-Wall", "-Wextra", "-Werror", "-pedantic")
STANDARDS = {"cc": "-std=c11", "c++": "-std=c++11"}


# The files of all modules that the two processes of a build may load before they compile.
LOADED = """
import sys
import standoff.c_interface.library, standoff.c_interface.objects
names = [name for name in sys.modules if name.partition(".")[0] == "standoff"]
print("\\n".join(sorted(filter(None, (sys.modules[name].__file__ for name in names)))))
"""


def fingerprint() -> str:
    """Of all that a build depends on: sources, compilers, and the processor it is for."""
    told = subprocess.run(
        [sys.executable, "-c", LOADED], capture_output=True, text=True, check=True
    )
    kernels = SOURCE.parents[1] / "kernels"
    files = {*map(Path, told.stdout.splitlines()), *kernels.rglob("*.py"), *SOURCE.iterdir()}
    assert len(files) > 150
    compiler = subprocess.run(["cc", "--version"], capture_output=True, text=True, check=True)
    features = sorted(llvm.get_host_cpu_features().items())
    versions = sys.version, numba.__version__, llvmlite.__version__, platform.platform()
    given = versions, llvm.get_host_cpu_name(), features, compiler.stdout, FLAGS
    digest = hashlib.sha256(repr(given).encode())
    for file in sorted(files):
        content = file.read_bytes()
        digest.update(f"{file.relative_to(SOURCE.parents[1])} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:32]


def built(kept: Path) -> None:
    """Build the library into a folder, which is there whole or not at all."""
    folder = kept.with_name(f"{kept.name}.part")
    shutil.rmtree(kept.parent)
    folder.mkdir(parents=True)
    with (folder / "progress").open("w") as told:
        build_library(folder, progress=lambda done, total: print(done, total, file=told))
    folder.rename(kept)


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory, pytestconfig: pytest.Config) -> Path:
    """The folder of the shared library and its header; ``progress`` has what was told meanwhile.

    As kernels are, it is kept for the next run, in pytest's cache, as long as what it is made of
    stays the same: a build takes more than a minute. ``--cache-clear`` builds it anew.
    """
    if shutil.which("cc") is None:
        pytest.skip("there is no C compiler: install gcc to test the C interface")
    if not modules.AVAILABLE or BOUNDS_CHECK:
        pytest.skip("the C library is made of kernels as this version of Numba compiles them")
    assert pytestconfig.cache is not None
    kept = pytestconfig.cache.mkdir("c library") / fingerprint()
    if not kept.is_dir():
        built(kept)
    folder = tmp_path_factory.mktemp("c library")
    return Path(shutil.copytree(kept, folder, dirs_exist_ok=True))


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
