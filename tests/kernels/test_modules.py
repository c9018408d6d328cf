"""One module an entry: what is emitted and kept, what calls what, and the fallback."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from numba import config, njit

import standoff as so
from standoff.kernels import entries, features, modules, trimming
from standoff.kernels.compiling import pointer
from standoff.kernels.preparing import every_entry

pytestmark = pytest.mark.skipif(
    bool(config.DISABLE_JIT) or not modules.AVAILABLE,
    reason="modules are made by the compiler, of the Numba version that they were written for",
)

JETS = """
import sys
import numba
numba.__version__ = {version!r}
import numpy as np
from standoff.kernels import entries, modules
data = np.arange(1.0, 40.0)
data.flags.writeable = False
jets = entries.curve_jet(data, 0, 0, 0.3), entries.surface_jet(data, 1, 0, 0.3, 0.2)
print(modules.AVAILABLE, *jets)
"""


def jets(tmp_path, version: str, stock: str) -> tuple[str, str]:
    """(were modules made, two jets) of a process with an empty cache."""
    tmp_path.chmod(0o700)
    settings = {"NUMBA_CACHE_DIR": str(tmp_path), "STANDOFF_STOCK_COMPILER": stock}
    run = subprocess.run(
        [sys.executable, "-c", JETS.format(version=version)],
        capture_output=True,
        text=True,
        env={**os.environ, **settings},
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    made, values = run.stdout.split(" ", 1)
    return made, values


def test_stock_compilation_gives_the_same_bits(tmp_path) -> None:
    import numba

    usual, forced, other = (tmp_path / name for name in ("usual", "forced", "other"))
    for folder in (usual, forced, other):
        folder.mkdir()
    made, values = jets(usual, numba.__version__, "0")
    assert made == "True"
    assert jets(forced, numba.__version__, "1") == ("False", values)
    assert jets(other, "0.69.0", "0") == ("False", values)


def test_both_kinds_of_code_keep_apart_in_one_cache(tmp_path) -> None:
    import numba

    tmp_path.chmod(0o700)
    _, values = jets(tmp_path, numba.__version__, "0")
    assert jets(tmp_path, numba.__version__, "1") == ("False", values)
    assert jets(tmp_path, numba.__version__, "0") == ("True", values)


def test_only_entries_and_shared_kernels_are_emitted_and_kept(tmp_path) -> None:
    jets(tmp_path, __import__("numba").__version__, "0")
    kept = {file.name.split("-")[0] for file in tmp_path.rglob("*.nbi")}
    assert kept == {"entries.curve_jet", "entries.surface_jet"}


def test_every_entry_has_one_signature() -> None:
    for entry in every_entry():
        assert len(entry.signature) == len(entry._compiler.pysig.parameters), entry
        assert set(entry.overloads) <= {entry.signature}


def test_a_symbol_that_no_module_defines_is_told() -> None:
    library = modules.ModuleLibrary(entries.curve_jet.targetctx.codegen(), "lonely")
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
    assert point == entries.feature_jet(body.ints, body.reals, 0, 0, 0.1, 0.2)[0]
    edge = np.array([0.1, 0.2]) + walked[0] * np.array([3.0, 0.1])
    assert entries.on_face(body.ints, body.reals, 0, *edge)
    assert not entries.on_face(body.ints, body.reals, 0, edge[0] + 1e-6, edge[1])


def test_a_kernel_called_from_python_answers_as_in_a_module() -> None:
    body = so.shapes.cylinder(0.7, 1.3)
    a, b = body.ints, body.reals
    assert features.dimension(a, 0) == 2
    for u in (-0.3, 0.2):
        jet = features.feature_jet(a, b, 0, 0, u, 0.1)
        assert jet == entries.feature_jet(a, b, 0, 0, u, 0.1)


def test_a_damaged_file_of_the_cache_is_told_and_compiled_anew(tmp_path) -> None:
    version = __import__("numba").__version__
    made, values = jets(tmp_path, version, "0")
    for file in tmp_path.rglob("entries.curve_jet*.nbc"):
        file.write_bytes(file.read_bytes()[:100])
    for file in tmp_path.rglob("entries.surface_jet*.nbi"):
        file.write_bytes(b"nothing of use")
    assert jets(tmp_path, version, "0") == (made, values)
