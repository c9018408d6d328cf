"""What `import standoff`, its help and one query load, and that every name is there when asked for.

Each is seen from a fresh interpreter. A package that imports on demand (`standoff.on_demand`) names
what is public twice: for type checkers, and in `__all__`.
"""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import standoff as so
from shares import only
from standoff import bodies, recording

SOURCE = Path(so.__file__).parent
ROOT = {"standoff", "standoff.on_demand", "standoff.version"}
# The flags of the laws' options are made from their declarations.
LAWS = {
    *("standoff.errors", "standoff.wording"),
    *(f"standoff.tracking{part}" for part in ("", ".laws", ".law_options")),
}
COMMANDS = (
    *("track", "distance", "impact", "clearance", "check", "automaton", "sweep"),
    *("paper", "soak", "accuracy", "warmup"),
)
STUDIES = ("paper", "soak", "accuracy")

# What draws, writes, reads formulas, or serves the command line alone.
EXTRAS = {
    *("PIL", "flint", "jinja2", "matplotlib", "pyarrow", "rich", "sympy", "tyro"),
    *("casadi", "jax", "numba_cuda", "torch"),
}
# Parts of the library that a query of two ready-made shapes has no use for.
UNUSED = (
    "bodies.voronoi",
    "cli",
    "control",
    "scene",
    "automaton",
    "frameworks",
    "gpu",
    "impact",
    "points",
    "recording",
    "simulation",
    "devices",
    "servo",
    "tracking.contact",
    "tracking.pair_system",
)
# Numba imports scipy.linalg when it first runs a compiled function.
NUMBA_NEEDS = {"scipy.linalg"}

QUERY = """
import numpy as np
import standoff as so
lens, ellipsoid = so.shapes.lens(2.0, 1.0), so.shapes.ellipsoid(1.0, 0.7, 0.5)
box, capsule = so.shapes.box(1.0, 2.0, 3.0, rounding=0.1), so.shapes.capsule(0.3, 1.0)
so.shapes.cylinder(0.3, 1.0), so.shapes.sphere(0.3)
home, there = so.Pose.identity(), so.Pose(np.eye(3), [4.0, 0.3, 0.2])
assert so.distance(lens, ellipsoid, home, there).certified
assert so.distance(box, capsule, home, there).certified
"""

TRACKED = (
    QUERY
    + """
import sys
twist = so.Twist([1.0, 0.0, 0.0], [0.0, 0.0, 0.1])
tracker = so.Tracker(lens, ellipsoid, dt=1e-3)
before = set(sys.modules)
state = tracker.start(home, there, twist, twist)
state, found = tracker.step(state, home, there, twist, twist)
assert found.certified
state, found = tracker.step(state, home, home, twist, twist)
assert found.distance < 0.0
assert set(sys.modules) == before, set(sys.modules) - before
"""
)


def fresh(code: str) -> str:
    """Run code in an interpreter of its own; returns its standard output."""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def loaded(code: str) -> set[str]:
    """The modules, none of the standard library's, that code imports in a fresh interpreter."""
    listing = f"""
import sys
present = set(sys.modules)
{code}
import json
standard = sys.stdlib_module_names
new = [name for name in sys.modules if name.partition('.')[0] not in standard]
print('\\n' + json.dumps([name for name in new if name not in present]))
"""
    return set(json.loads(fresh(listing).splitlines()[-1]))


FORGET = """
import sys
from importlib import import_module
import numba, scipy
def forget():
    for module in list(sys.modules):
        if module.startswith('standoff') and not module.startswith('standoff.kernels'):
            del sys.modules[module]
"""
"""As in a fresh interpreter: the kernels stay, which import nothing above them, and take long."""


def packages(modules: set[str]) -> set[str]:
    """The packages that modules belong to."""
    return {name.partition(".")[0] for name in modules}


def declared(file: Path) -> set[tuple[str, str]]:
    """What the file of a package says that it hands out: (module, name)."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    (guard,) = (node for node in tree.body if isinstance(node, ast.If))
    assert isinstance(guard.test, ast.Name)
    assert guard.test.id == "TYPE_CHECKING"
    imports = [node for node in guard.body if isinstance(node, ast.ImportFrom)]
    assert len(imports) == len(guard.body)
    return {(str(node.module), alias.name) for node in imports for alias in node.names}


FILES = {
    ".".join(("standoff", *file.relative_to(SOURCE).parent.parts)): file
    for file in sorted(SOURCE.rglob("__init__.py"))
    if "= on_demand(" in file.read_text(encoding="utf-8")
}


def test_import_loads_three_modules_and_no_other_package() -> None:
    assert loaded("import standoff") == ROOT


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_loads_only_what_reads_the_arguments(command: str) -> None:
    given = [*command.split(), "--help"]
    modules = loaded(f"from standoff.cli import main\nmain({given})")
    parts = ("", ".added", ".arguments", ".entry", ".errors", ".option_groups")
    more = (".sweep_arguments", ".terminal")
    command_line = {f"standoff.cli{part}" for part in (*parts, *more)} | LAWS
    assert {name for name in modules if packages({name}) == {"standoff"}} == ROOT | command_line
    shown = STUDIES if not command else [name for name in STUDIES if name == command]
    options = {
        f"standoff_studies.{study}{part}"
        for study in shown
        for part in ("", ".arguments", ".options")
    }
    assert {name for name in modules if packages({name}) == {"standoff_studies"}} == (
        {"standoff_studies"} | options if shown else set()
    )
    assert not packages(modules) & {"numpy", "scipy", "numba", "llvmlite", *EXTRAS} - {
        "tyro",
        "rich",
    }


def test_a_query_loads_neither_scipy_nor_what_it_has_no_use_for() -> None:
    modules = loaded(QUERY)
    assert not packages(modules) & {"standoff_studies", *EXTRAS}
    scipy = {name for name in modules if name.count(".") == 1 and name.startswith("scipy.")}
    assert {name for name in scipy if not name.startswith("scipy._")} <= {
        "scipy.version",
        *NUMBA_NEEDS,
    }
    unused = tuple(f"standoff.{part}" for part in UNUSED)
    assert [name for name in sorted(modules) if f"{name}.".startswith(unused)] == []


def test_a_tracker_imports_before_its_loop_what_frames_need() -> None:
    modules = loaded(TRACKED)
    assert not packages(modules) & {"standoff_studies", *EXTRAS}
    unused = tuple(f"standoff.{part}" for part in UNUSED)
    assert [name for name in sorted(modules) if f"{name}.".startswith(unused)] == []


def test_every_package_that_should_imports_on_demand() -> None:
    names = (
        *("standoff", "bodies", "bodies.shapes", "geometry", "motion", "tracking"),
        *("automaton", "impact", "points", "recording", "simulation", "voronoi"),
        *("devices", "servo", "view", "world", "robots", "solids", "cad", "scene", "sweep"),
        "clearance",
    )
    assert set(FILES) == {name if name == "standoff" else f"standoff.{name}" for name in names}


@pytest.mark.parametrize("package", FILES)
def test_a_package_hands_out_what_type_checkers_read(package: str) -> None:
    public = import_module(package).__all__
    assert sorted(name for _, name in declared(FILES[package])) == sorted(public)


@pytest.mark.parametrize("package", FILES)
def test_a_package_lists_and_has_every_public_name(package: str) -> None:
    module = import_module(package)
    assert set(module.__all__) <= set(dir(module))
    for home, name in declared(FILES[package]):
        assert getattr(module, name) is getattr(import_module(home), name)


@pytest.mark.parametrize("quarter", only([0], range(4)))
def test_every_module_of_public_names_can_be_the_first_to_be_imported(quarter: int) -> None:
    """tests/test_layers.py finds the circles of imports that would keep one from it."""
    homes = {home for file in FILES.values() for home, _ in declared(file)}
    fresh(f"""
{FORGET}
for home in {sorted(homes - set(FILES))[quarter::4]}:
    forget()
    try:
        import_module(home)
    except Exception as error:
        sys.exit(f'{{home}}: {{error!r}}')
""")


def test_all_names_come_by_a_star_and_with_help() -> None:
    out = fresh("from standoff import *; print(shapes.box(1, 1, 1).name, Tracker.__name__)")
    assert out.split() == ["box", "Tracker"]
    out = fresh("import pydoc, standoff; print(pydoc.plain(pydoc.render_doc(standoff)))")
    assert "class Tracker(" in out
    assert "time_of_impact(" in out


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'standoff' has no attribute 'distanse'"):
        so.distanse  # noqa: B018
    with pytest.raises(AttributeError, match=r"module .* has no attribute '_Body'"):
        bodies._Body  # noqa: B018
    with pytest.raises(ImportError, match="cannot import name 'distanse' from 'standoff'"):
        exec("from standoff import distanse")
    assert not hasattr(so, "a.b")


def test_modules_of_the_library_are_attributes_without_an_import() -> None:
    # Lower layers first: a higher one imports them.
    fresh("""
import standoff
for name in ("version", "kernels", "geometry", "motion", "bodies", "tracking", "control"):
    assert getattr(standoff, name).__name__ == f"standoff.{name}"
assert standoff.feedback is standoff.tracking.feedback
assert standoff.feedback.Linear
""")


def test_a_module_never_takes_the_place_of_a_public_name() -> None:
    """Importing `recording.track` would bind it in its package, where it is a function."""
    same = {
        package: [name for home, name in declared(file) if home == f"{package}.{name}"]
        for package, file in FILES.items()
    }
    several = ("geometry", "recording", "simulation", "tracking")
    expected = {"standoff", *(f"standoff.{name}" for name in several)}
    assert {package for package, names in same.items() if names} == expected
    fresh(f"""
{FORGET}
same = {same}
for first in ('name', 'module'):
    for package, names in same.items():
        forget()
        package = import_module(package)
        for name in names:
            if first == 'name':
                getattr(package, name)
            module = import_module(f'{{package.__name__}}.{{name}}')
            assert module is sys.modules[f'{{package.__name__}}.{{name}}']
            assert getattr(package, name) is getattr(module, name), (first, name)
""")


def test_a_name_put_in_its_place_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    stand_in: Any = object()
    monkeypatch.setattr(recording, "track", stand_in)
    assert recording.track is stand_in
    monkeypatch.undo()
    assert recording.track is so.track


def test_threads_may_ask_for_names_at_once() -> None:
    fresh("""
import sys, threading
import standoff
sys.setswitchinterval(1e-6)
threads, errors = 8, []
barrier = threading.Barrier(threads)
names = list(standoff.__all__)
def ask(first):
    barrier.wait()
    try:
        for name in names[first:] + names[:first]:
            getattr(standoff, name)
    except BaseException as error:
        errors.append(error)
running = [threading.Thread(target=ask, args=(6 * k,)) for k in range(threads)]
for thread in running:
    thread.start()
for thread in running:
    thread.join()
assert not errors, errors
""")


def test_the_front_is_small() -> None:
    """What is asked for every day; the rest is in modules, which tab completion shows too."""
    assert len(so.__all__) <= 38
    shown = {name for name in dir(so) if not name.startswith("__")}
    modules = (
        *("automaton", "bodies", "cad", "clearance", "control", "devices", "geometry", "impact"),
        *("motion", "points", "recording", "robots", "scene", "servo", "simulation"),
        *("solids", "tracking", "voronoi", "world"),
    )
    assert shown == {*so.__all__, *modules}
    assert {name for name in dir(so.shapes) if not name.startswith("__")} == set(so.shapes.__all__)


def test_what_never_was_is_no_attribute() -> None:
    for module in (so, so.points, so.shapes):
        assert not hasattr(module, "no_such_name")


BOX = so.shapes.box(1.0, 1.0, 1.0)
LOOP = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])


@pytest.mark.parametrize(
    ("made", "shown"),
    [
        (
            so.Tracker(BOX, BOX),
            "a b buffer dt law resolved_law run specialise start start_from start_many step "
            "step_into step_many",
        ),
        (so.PointTracker(LOOP), "body dt law start start_from step"),
        (
            so.PredictorCorrector(),
            "deadline depth facts name predictor resolved restarts tolerance within",
        ),
    ],
    ids=lambda value: type(value).__name__,
)
def test_tab_completion_shows_no_internals_of_an_object(made: object, shown: str) -> None:
    assert [name for name in sorted(dir(made)) if not name.startswith("_")] == shown.split()


def test_what_is_hidden_is_there() -> None:
    tracker = so.Tracker(BOX, BOX)
    assert tracker.table.arrays[0] is BOX.ints
    assert "table" not in dir(tracker)
    assert so.PredictorCorrector().only_one is not None
