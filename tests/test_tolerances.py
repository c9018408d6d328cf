"""One tolerance, one place: its package's `tolerances.py`. Each has a unit and its own name."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections import defaultdict
from pathlib import Path

import pytest

import standoff as so

SOURCE = Path(so.__file__).parent
MODULES = {file.relative_to(SOURCE).as_posix(): file for file in sorted(SOURCE.rglob("*.py"))}
PLACES = [name for name in MODULES if name.endswith("tolerances.py")]

# Small numbers outside of these files that are no tolerances.
NO_TOLERANCE = {
    ("checks/numbers.py", "1e-50"): "the least length that a user may give",
    ("control/gain.py", "1e-3"): "an option's default, the tracker's time",
    ("recording/plot.py", "1e-16"): "where an axis without values begins",
    ("scene/settings.py", "1e-3"): "an option's default, a time",
    ("simulation/simulated_device.py", "1e-4"): "an option's default, an inertia",
    ("simulation/simulated_device.py", "1e-3"): "an option's default, a damping",
    ("tracking/law_options.py", "1e-10"): "an option's default: `tolerance` itself",
}

UNITS = re.compile(
    r"""\b(lengths? | radians? | rad | chord | cosines? | sine | s\] | relative | dimensionless
    | no\ unit | ratio | parts? | fraction | share | sizes? | scales? | spans? | eps | roundings?
    | times | bytes | gnomonic | parameter\ units?
    | steps? | evaluations | points | minima | directions | frames | rays | restarts | releases
    | bisections | samples | halvings | iterations | so\ many | passes)\b | 1\ /\ size""",
    re.VERBOSE | re.IGNORECASE,
)
"""Of tolerances, then of counts."""


def small_numbers(source: str) -> list[tuple[int, str]]:
    """(line, text) of numbers below 1e-2 in scientific notation that are no default argument."""
    defaults = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.arguments):
            for value in (*node.defaults, *node.kw_defaults):
                if isinstance(value, ast.Constant):
                    defaults.add((value.lineno, value.col_offset))
    return [
        (token.start[0], token.string)
        for token in tokenize.generate_tokens(io.StringIO(source).readline)
        if token.type == tokenize.NUMBER
        and re.search(r"e-\d", token.string, re.IGNORECASE)
        and float(token.string) < 1e-2
        and token.start not in defaults
    ]


def described(source: str) -> dict[str, tuple[str, str]]:
    """Value and description of every number of a file: the comment above it, or above the numbers
    right before it, or the docstring below."""
    lines, body = source.splitlines(), ast.parse(source).body
    found = {}
    last_end, last_text = 0, ""
    for k, node in enumerate(body):
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        target = node.targets[0] if isinstance(node, ast.Assign) else node.target
        assert isinstance(target, ast.Name)
        above = node.lineno - 1
        while lines[above - 1].startswith("#"):
            above -= 1
        text = " ".join(line.lstrip("#: ") for line in lines[above : node.lineno - 1])
        below = body[k + 1] if k + 1 < len(body) else None
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant):
            text = str(below.value.value)
        if not text and last_end == node.lineno - 1:
            text = last_text
        found[target.id] = (ast.unparse(node.value), text)
        last_end, last_text = node.end_lineno or 0, text
    return found


EVERY = [
    (place, name, value, text)
    for place in PLACES
    for name, (value, text) in described(MODULES[place].read_text(encoding="utf-8")).items()
    if (place, name) != ("kernels/tolerances.py", "EPS")  # the unit of the others
]


def stray(module: str, source: str) -> list[str]:
    """Small numbers of a module that belong into its package's `tolerances.py`."""
    if module in PLACES:
        return []
    return [
        f"{module}:{line}: {text} belongs into the tolerances.py of its package"
        for line, text in small_numbers(source)
        if (module, text) not in NO_TOLERANCE
    ]


def repeated(every: list[tuple[str, str, str, str]]) -> dict[str, set[str]]:
    """The places of each name that stands for two values."""
    values, places = defaultdict(set), defaultdict(set)
    for place, name, value, _ in every:
        values[name].add(value)
        places[name].add(place)
    return {name: places[name] for name in values if len(values[name]) > 1}


def test_small_numbers_stand_among_the_tolerances() -> None:
    for name, file in MODULES.items():
        assert stray(name, file.read_text(encoding="utf-8")) == []


def test_what_is_excused_is_there() -> None:
    for module, text in NO_TOLERANCE:
        numbers = small_numbers(MODULES[module].read_text(encoding="utf-8"))
        assert text in [number for _, number in numbers], (module, text)


@pytest.mark.parametrize("place", PLACES)
def test_every_tolerance_has_a_unit_and_a_reason(place: str) -> None:
    own = [(name, text) for home, name, _, text in EVERY if home == place]
    assert own
    assert [(name, text) for name, text in own if len(text.split()) < 6] == []
    assert [
        (name, text) for name, text in own if not UNITS.search(name.replace("_", " ") + " " + text)
    ] == []


def test_no_name_stands_for_two_tolerances() -> None:
    assert repeated(EVERY) == {}


def test_no_module_gives_a_tolerance_s_name_to_another_number() -> None:
    names = {name for _, name, _, _ in EVERY}
    found = []
    for module, file in MODULES.items():
        if module in PLACES:
            continue
        for node in ast.parse(file.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                name = node.targets[0].id
                if name in names:
                    found.append(f"{module}: {name}")
    assert found == []


def test_what_is_out_of_place_is_seen() -> None:
    """The checks above, on lines that each of them is there to catch."""
    assert stray("bodies/body.py", "if x < 1e-9 * size:\n    pass\n")
    assert stray("bodies/body.py", "NEAR = 1E-9\n")
    assert not stray("bodies/body.py", "def f(x, near=1e-9, *, far=2e-9): ...\n")
    assert not stray("bodies/body.py", "FAR = 1e9\nHALF = 0.5\n")
    assert not UNITS.search(described('NEAR = 1e-9\n"""How near is near."""\n')["NEAR"][1])
    assert described("# Of the size.\nA = 1\nB = 2\n\nC = 3\n") == {
        "A": ("1", "Of the size."),
        "B": ("2", "Of the size."),
        "C": ("3", ""),
    }
    assert repeated([("a", "NEAR", "1e-9", ""), ("b", "NEAR", "1e-8", "")]) == {"NEAR": {"a", "b"}}
