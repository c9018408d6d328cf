"""One module an entry: what is emitted and kept, what calls what, and the fallback."""

from __future__ import annotations

import os
import pickle
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numba
import numpy as np
import pytest
from numba import config, njit

import standoff as so
from shares import only
from standoff.kernels.body import features, trimming
from standoff.kernels.compiler import modules
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.compiler.entry import Entry
from standoff.kernels.entries import queries
from standoff.kernels.entries.preparing import every_entry

pytestmark = pytest.mark.skipif(
    bool(config.DISABLE_JIT) or not modules.AVAILABLE,
    reason="modules are made by the compiler, of the Numba version that they were written for",
)

JETS = """
import sys
import numba
numba.__version__ = {version!r}
import numpy as np
from standoff.kernels.entries import queries
from standoff.kernels.compiler import modules
data = np.arange(1.0, 40.0)
data.flags.writeable = False
jets = [queries.curve_jet(data, 0, 0, 0.3)]
if {surfaces}:
    jets.append(queries.surface_jet(data, 1, 0, 0.3, 0.2))
print(modules.AVAILABLE, *jets)
"""


def jets(
    cache: Path, version: str = numba.__version__, stock: str = "0", surfaces: bool = True
) -> tuple[str, str]:
    """(were modules made, two jets) of a process that keeps its code in a folder.

    Without surfaces the first jet alone: stock compilation of the other takes ten seconds.
    """
    cache.chmod(0o700)
    settings = {"NUMBA_CACHE_DIR": str(cache), "STANDOFF_STOCK_COMPILER": stock}
    run = subprocess.run(
        [sys.executable, "-c", JETS.format(version=version, surfaces=surfaces)],
        capture_output=True,
        text=True,
        env={**os.environ, **settings},
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    made, values = run.stdout.split(" ", 1)
    return made, values


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A folder with what a first process compiled, and its two jets."""
    cache = tmp_path_factory.mktemp("usual")
    made, values = jets(cache)
    assert made == "True"
    return cache, values


@pytest.fixture
def copied(compiled: tuple[Path, str], tmp_path: Path) -> Path:
    """A copy of the folder that a test may add to or spoil."""
    return Path(shutil.copytree(compiled[0], tmp_path / "copied"))


@pytest.mark.parametrize("surfaces", only([False], [False, True]))
def test_stock_compilation_gives_the_same_bits_and_keeps_apart_in_one_cache(
    surfaces: bool, compiled: tuple[Path, str], copied: Path
) -> None:
    values = compiled[1]
    before = set(copied.rglob("*.nbc"))
    made, own = jets(copied, stock="1", surfaces=surfaces)
    assert made == "False"
    assert own.strip()
    assert own == values if surfaces else values.startswith(own.strip())
    assert set(copied.rglob("*.nbc")) > before
    made, first = jets(copied, version="0.69.0", surfaces=False)
    assert made == "False"
    assert first.strip()
    assert values.startswith(first.strip())
    assert jets(copied) == ("True", values)


BEGUN = """
import gc
import numpy as np
from standoff.kernels.compiler.modules import Part
from standoff.kernels.entries import queries
kernels = [each for each in gc.get_objects() if isinstance(each, Part)]
data = np.arange(1.0, 40.0)
data.flags.writeable = False
queries.curve_jet(data, 0, 0, 0.3)
print(len(kernels), sum(kernel._begun for kernel in kernels))
"""


def test_no_kernel_is_begun_where_its_entry_is_on_disk(compiled: tuple[Path, str]) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(compiled[0])}
    run = subprocess.run(
        [sys.executable, "-c", BEGUN], capture_output=True, text=True, env=environment, check=True
    )
    made, begun = map(int, run.stdout.split())
    assert made > 100
    assert begun == 0


def test_only_entries_and_shared_kernels_are_emitted_and_kept(compiled: tuple[Path, str]) -> None:
    kept = {file.name.split("-")[0] for file in compiled[0].rglob("*.nbi")}
    assert kept == {"queries.curve_jet", "queries.surface_jet"}


def test_every_entry_has_one_signature() -> None:
    for entry in every_entry():
        assert len(entry.signature) == len(entry._compiler.pysig.parameters), entry
        assert set(entry.overloads) <= {entry.signature}


def test_a_symbol_that_no_module_defines_is_told() -> None:
    library = modules.ModuleLibrary(queries.curve_jet.targetctx.codegen(), "lonely")
    code = modules.llvm.parse_assembly(
        "declare void @_ZN8standoff7missing()\ndefine void @caller() {\n"
        "call void @_ZN8standoff7missing()\nret void }"
    )
    library.add_llvm_module(code)
    with pytest.raises(AssertionError, match="no module defines _ZN8standoff7missing"):
        library.finalize()


def test_a_stock_function_calls_kernels_and_modules() -> None:
    # internal functions were once found by the dynamic linker under the kernels' own names, though
    # LLVM had changed how they take their arguments
    @njit(error_model="numpy")
    def both(ints, reals, u, v):
        a, b = pointer(ints, 0), pointer(reals, 0)
        jet = features.chart_jet(a, b, 0, u, v)
        return trimming.walk_face(a, b, 0, u, v, 3.0, 0.1), jet[0]

    body = so.shapes.box(2.0, 2.0, 2.0)
    walked, point = both(body.ints, body.reals, 0.1, 0.2)
    assert point == queries.feature_jet(body.ints, body.reals, 0, 0, 0.1, 0.2)[0]
    edge = np.array([0.1, 0.2]) + walked[0] * np.array([3.0, 0.1])
    assert queries.on_face(body.ints, body.reals, 0, *edge)
    assert not queries.on_face(body.ints, body.reals, 0, edge[0] + 1e-6, edge[1])


def test_a_kernel_called_from_python_answers_as_in_a_module() -> None:
    body = so.shapes.cylinder(0.7, 1.3)
    a, b = body.ints, body.reals
    assert features.dimension(a, 0) == 2
    for u in (-0.3, 0.2):
        jet = features.feature_jet(a, b, 0, 0, u, 0.1)
        assert jet == queries.feature_jet(a, b, 0, 0, u, 0.1)


def test_a_damaged_file_of_the_cache_is_told_and_compiled_anew(
    compiled: tuple[Path, str], copied: Path
) -> None:
    for file in copied.rglob("queries.curve_jet*.nbc"):
        file.write_bytes(file.read_bytes()[:100])
    for file in copied.rglob("queries.pcurve_jet*.nbi"):
        file.write_bytes(b"nothing of use")
    assert jets(copied) == ("True", compiled[1])


def test_an_index_of_other_sources_is_passed_over(compiled: tuple[Path, str], copied: Path) -> None:
    """It may name a class that those sources had: unpickling it would end the first call."""
    for file in copied.rglob("queries.curve_jet*.nbi"):
        with file.open("rb") as index:
            version = pickle.load(index)
        gone = b"cstandoff.kernels.entries.queries\nGone\n."
        older = version.rsplit(" ", 1)[0] + " another digest"
        file.write_bytes(pickle.dumps(older, protocol=-1) + gone)
    assert jets(copied) == ("True", compiled[1])


def test_threads_that_call_first_and_at_once_compile_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """As those of ``so.distances(..., workers=2)`` in a process that has compiled nothing yet."""
    known = queries.curve_jet
    fresh = Entry(known.py_func, dict(known.targetoptions), known.signature, known.work)
    compiled = []

    def slow(signature: object) -> object:
        compiled.append(signature)
        time.sleep(0.05)  # so that the others come meanwhile
        return compile_it(signature)

    compile_it = fresh.compile
    monkeypatch.setattr(fresh, "compile", slow)
    data = np.arange(1.0, 40.0)
    data.flags.writeable = False
    with ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(lambda t: fresh(data, 0, 0, t), [0.3] * 4))
    assert answers == [known(data, 0, 0, 0.3)] * 4
    assert len(compiled) == 1
