"""Machine code that a wheel carries, and cache folders that strangers can write to.

Two entries are shipped into a folder of the test's own. What depends on the processor, and what
must be compiled in its place, runs in new processes.
"""

from __future__ import annotations

import ast
import json
import os
import pickle
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from numba.core import config

from shares import only
from standoff.kernels.compiler import machine, modules, notices, shipped, trust
from standoff.kernels.compiler.trust import others_can_write
from standoff.kernels.entries import queries, shipping

ROOT = Path(__file__).resolve().parents[2]

WRITE = """
import sys
from pathlib import Path
from standoff.kernels.entries import queries
from standoff.kernels.entries import shipping
shipping.write(Path(sys.argv[1]), [queries.pcurve_jet, queries.edge_jet])
"""

# The line (u, v) = (1 + 2 t, 3 - t) at t = 0.5, its data after the two ends of its range.
USE = """
import json, sys
from pathlib import Path
from numba.core import event
from standoff.kernels.entries import queries
from standoff.kernels.compiler import shipped
import numpy as np

class Count(event.Listener):
    compiled = 0
    def on_start(self, _):
        Count.compiled += 1
    def on_end(self, _):
        pass

event.register("numba:compile", Count())
shipped.FOLDER = Path(sys.argv[1])
line = np.array([0.0, 1.0, 2.0, 0.0, 1.0, -1.0, 0.0, 3.0, 0.0, 0.0, 1.0])
answer = queries.pcurve_jet(line, 0, 2, 0.5)
for name in sys.argv[2:]:
    getattr(queries, name).prepare()
print(json.dumps({"answer": answer, "compiled": Count.compiled}))
"""
IMPORTED = "from standoff.kernels.compiler import shipped\n"
NO_FOLDER = """
from standoff.kernels.compiler import cache, shipped
cache._Modules._locator_classes = (cache._Nowhere,)
"""
ANSWER = [[2.0, 2.5, 1.0], [2.0, -1.0, 0.0], [0.0, 0.0, 0.0]]

pytestmark = pytest.mark.skipif(
    not modules.AVAILABLE, reason="another version of Numba makes no machine code for wheels"
)
posix = pytest.mark.skipif(os.name != "posix", reason="rights of folders are those of POSIX")
with_v3 = pytest.mark.skipif(
    platform.machine().lower() not in shipping.INTEL or machine.lacking(machine.X86_64_V3),
    reason="needs a processor of the level x86-64-v3",
)


def run(script: str, *arguments: str, **settings: str) -> tuple[dict[str, Any], str]:
    """What a script printed, read as JSON, and what it said on stderr."""
    environment = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("NUMBA_", "STANDOFF_"))
    }
    environment["PYTHONPATH"] = str(ROOT / "src")
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments],
        env=environment | settings,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout or "{}"), done.stderr


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("shipped") / "compiled"
    run(
        WRITE,
        str(folder),
        NUMBA_CACHE_DIR=str(tmp_path_factory.mktemp("empty")),
        NUMBA_CPU_NAME=shipping.target()[0],
        NUMBA_CPU_FEATURES="",
    )
    return folder


@pytest.fixture
def folder(built: Path, tmp_path: Path) -> Path:
    """A copy that a test may spoil."""
    return Path(shutil.copytree(built, tmp_path / "compiled"))


@pytest.fixture
def use(folder: Path, tmp_path: Path) -> Callable[..., tuple[dict[str, Any], str]]:
    """Run with the folder, an empty cache and some settings."""
    (tmp_path / "cache").mkdir()

    def run_with(*entries: str, **settings: str) -> tuple[dict[str, Any], str]:
        settings = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), **settings}
        return run(USE, str(folder), *entries, **settings)

    return run_with


def is_refused(done: tuple[dict[str, Any], str], why: str) -> None:
    """The reason was said once, the kernel compiled, and the answer is right."""
    told, said = done
    is_said_once(said, why)
    assert told["compiled"] > 0
    assert told["answer"] == ANSWER


@pytest.fixture
def ask(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Iterator[Callable[[], str]]:
    """Look for a module twice in this process, which must find none; what is said of it."""
    monkeypatch.setattr(shipped, "FOLDER", folder)
    monkeypatch.delenv(notices.QUIET, raising=False)
    shipped._carried.cache_clear()

    def said() -> str:
        for _ in range(2):
            found = shipped.load(queries.pcurve_jet.py_func, queries.pcurve_jet.signature)
            assert found is None
        return capsys.readouterr().err

    yield said
    shipped._carried.cache_clear()


def is_said_once(said: str, why: str) -> None:
    assert said.count("not using the machine code of the wheel") == 1, said
    assert why in said
    assert "The kernels are compiled instead." in said


class Harm:
    """Makes a folder when it is unpickled."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __reduce__(self) -> Any:
        return os.mkdir, (str(self.folder),)


def change(folder: Path, **values: object) -> None:
    path = folder / "manifest.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | values))


def test_a_shipped_module_is_used_and_nothing_is_compiled_said_or_written(use, tmp_path):
    told, said = use("edge_jet")
    assert (told["compiled"], said) == (0, "")
    assert told["answer"] == ANSWER
    assert list((tmp_path / "cache").iterdir()) == []


def test_an_entry_that_is_not_shipped_is_compiled(use):
    told, said = use("chart_normal")
    assert told["compiled"] > 0
    assert "not using" not in said


def test_without_a_folder_nothing_is_said_of_it(use, folder):
    shutil.rmtree(folder)
    told, said = use()
    assert told["compiled"] > 0
    assert "not using" not in said


@pytest.mark.parametrize(
    ("what", "value"),
    [
        ("Numba", "0.1.2"),
        ("llvmlite", "0.1.2"),
        ("Python", "cpython-27"),
        ("system", "plan9 vax"),
        ("NUMBA_OPT", "max"),
    ],
)
def test_code_for_another_version_or_system_is_refused(ask, folder, what, value):
    change(folder, **{what: value})
    is_said_once(ask(), f"it is for {what} {value}, and this is ")


def test_code_of_other_sources_is_refused(use, folder):
    change(folder, sources="0" * 64)
    is_refused(use(), "it was compiled from other sources of the kernels")


def test_code_that_needs_what_the_processor_lacks_is_refused(ask, folder):
    change(folder, features=["avx", "teleportation"])
    is_said_once(ask(), "this processor lacks teleportation")


@with_v3
@pytest.mark.parametrize("name", only(["znver4"], ["skylake-avx512", "znver4"]))
def test_a_processor_that_has_all_that_is_needed_uses_the_code(use, name):
    told, said = use(NUMBA_CPU_NAME=name)
    assert (told["compiled"], said) == (0, "")


@with_v3
@pytest.mark.parametrize("name", only(["ivybridge"], ["nehalem", "ivybridge"]))
def test_a_processor_that_lacks_something_compiles(use, name):
    why = f"x86-64-v3, and NUMBA_CPU_NAME={name} is not known to have avx"
    is_refused(use(NUMBA_CPU_NAME=name, NUMBA_CPU_FEATURES=""), why)


@with_v3
def test_named_features_must_hold_all_that_is_needed(use):
    named = ",".join(f"+{each}" for each in machine.X86_64_V3)
    told, said = use(NUMBA_CPU_FEATURES=named)
    assert (told["compiled"], said) == (0, "")


@with_v3
def test_named_features_without_one_that_is_needed_compile(ask, monkeypatch):
    named = ",".join(f"+{each}" for each in machine.X86_64_V3)
    monkeypatch.setattr(config, "CPU_FEATURES", f"{named},-fma")
    is_said_once(ask(), "NUMBA_CPU_FEATURES lacks +fma")


@with_v3
def test_avx_that_is_switched_off_is_not_used(ask, monkeypatch):
    monkeypatch.setattr(config, "ENABLE_AVX", False)
    is_said_once(ask(), "NUMBA_ENABLE_AVX is 0")


def test_kernels_whose_indices_shall_be_checked_are_compiled(ask, monkeypatch):
    monkeypatch.setenv("STANDOFF_BOUNDS_CHECK", "1")
    is_said_once(ask(), "STANDOFF_BOUNDS_CHECK is set")


def test_kernels_that_stock_numba_shall_compile_are(ask, monkeypatch):
    monkeypatch.setattr(modules, "AVAILABLE", False)  # as read from STANDOFF_STOCK_COMPILER
    is_said_once(ask(), "STANDOFF_STOCK_COMPILER is set")


def test_a_truncated_file_is_refused_and_the_kernel_compiled(use, folder):
    (file,) = folder.glob("queries.pcurve_jet.*")
    file.write_bytes(file.read_bytes()[:-100])
    is_refused(use(), f"{file} is damaged")


def test_a_file_that_was_changed_is_not_unpickled(ask, folder):
    (file,) = folder.glob("queries.pcurve_jet.*")
    file.write_bytes(pickle.dumps("something else"))
    is_said_once(ask(), f"{file} is damaged (not what was written)")


def test_a_missing_file_is_refused(ask, folder):
    (file,) = folder.glob("queries.pcurve_jet.*")
    file.unlink()
    is_said_once(ask(), f"{file} is damaged")


@pytest.mark.parametrize("text", ["", "{", "[1]", '{"Numba": "0.1"}'])
def test_a_damaged_manifest_is_refused(ask, folder, text):
    (folder / "manifest.json").write_text(text)
    is_said_once(ask(), f"{folder / 'manifest.json'} is damaged")


def test_a_folder_without_manifest_is_refused(ask, folder):
    (folder / "manifest.json").unlink()
    is_said_once(ask(), f"{folder} has no manifest.json")


@posix
def test_a_shipped_folder_that_others_can_write_to_is_refused(use, folder):
    folder.chmod(0o757)
    is_refused(use(), f"other users can write to {folder}")


@posix
def test_nothing_is_read_from_or_written_to_a_cache_that_others_can_write_to(folder, tmp_path):
    shutil.rmtree(folder)
    cache = tmp_path / "cache"
    cache.mkdir(mode=0o700)
    first, _ = run(USE, str(folder), NUMBA_CACHE_DIR=str(cache))
    again, _ = run(USE, str(folder), NUMBA_CACHE_DIR=str(cache))
    assert first["compiled"] > 0
    assert again["compiled"] == 0, "a safe cache is used"

    cache.chmod(0o777)
    # what a stranger would put there: to be read is enough
    marker = tmp_path / "read"
    for file in cache.rglob("*.nb[ci]"):
        file.write_bytes(pickle.dumps(Harm(marker)))
    there = {file: file.read_bytes() for file in cache.rglob("*.*")}
    told, said = run(USE, str(folder), NUMBA_CACHE_DIR=str(cache))
    assert not marker.exists(), "a file of the refused folder was unpickled"
    assert f"not using the cache folder {cache}" in said
    assert f"other users can write to {cache}" in said
    assert {file: file.read_bytes() for file in cache.rglob("*.*")} == there
    assert told["answer"] == ANSWER


@posix
def test_without_any_cache_folder_each_process_compiles_and_says_so(folder):
    shutil.rmtree(folder)
    nowhere = USE.replace(IMPORTED, NO_FOLDER)
    assert nowhere != USE
    told, said = run(nowhere, str(folder))
    assert told["answer"] == ANSWER
    assert told["compiled"] > 0
    assert "the compiled kernels could not be kept (no cache folder)" in said


@posix
def test_a_folder_of_a_group_of_others_is_not_safe(tmp_path):
    own = os.getgid()
    others = [gid for gid in ([1, 2] if os.getuid() == 0 else os.getgroups()) if gid != own]
    if not others:
        pytest.skip("this user is in no other group")
    folder = tmp_path / "shared"
    folder.mkdir()
    os.chown(folder, -1, others[0])
    folder.chmod(0o750)
    assert others_can_write(folder) is None
    folder.chmod(0o770)
    assert others_can_write(folder) == f"other users can write to {folder}"
    below = folder / "own"
    below.mkdir(mode=0o700)
    assert others_can_write(below) == f"other users can write to {folder}"


@posix
def test_a_folder_of_ones_own_group_and_one_below_a_sticky_one_are_safe(tmp_path):
    folder = tmp_path / "sticky"
    folder.mkdir()
    folder.chmod(0o1777)
    assert others_can_write(folder) == f"other users can write to {folder}"
    below = folder / "own"
    below.mkdir(mode=0o700)
    assert others_can_write(below) is None


def test_where_posix_rights_are_unknown_nothing_of_posix_is_called(tmp_path, monkeypatch):
    tmp_path.chmod(0o777)
    monkeypatch.setattr(trust, "os", SimpleNamespace(name="nt"))
    assert others_can_write(tmp_path) is None


LACKING_ON_WINDOWS = {
    *("fcntl", "grp", "posix", "pty", "pwd", "resource", "syslog", "termios", "tty"),
    *("chown", "fchmod", "fchown", "fork", "getegid", "geteuid", "getgid", "getgrouplist"),
    *("getgroups", "getpgid", "getuid", "killpg", "mkfifo", "nice", "sched_getaffinity"),
    *("setsid", "statvfs", "uname", "wait4"),
    *("SIGALRM", "SIGHUP", "SIGKILL", "SIGUSR1", "SIGUSR2", "alarm", "pause", "setitimer"),
}


def test_only_the_rights_and_the_locks_of_folders_need_posix():
    found = set()
    for file in (*(ROOT / "src").rglob("*.py"), *(ROOT / "studies").rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = []
            if isinstance(node, ast.Import):
                names = [each.name for each in node.names]
            elif isinstance(node, ast.ImportFrom):
                names = [str(node.module), *(each.name for each in node.names)]
            elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                names = [node.attr] if node.value.id in ("os", "signal") else []
            found |= {(file.name, name) for name in names if name in LACKING_ON_WINDOWS}
    # a sweep's lock of its folder says so where there is none; the study that kills sweeps is for
    # Linux, as it says
    assert found == {
        ("trust.py", "getuid"), ("trust.py", "grp"), ("trust.py", "pwd"), ("folder.py", "fcntl"),
        ("killed_sweeps.py", "SIGKILL"), ("killed_sweeps.py", "killpg"),
    }  # fmt: skip
