"""What the library may grow to, counted from its files: ``python tests/budgets.py`` prints it.

The budgets stand in ``[tool.standoff.budgets]`` of pyproject.toml. A change that needs more of one
changes its line there, and says why; one that needs less lowers it.
"""

from __future__ import annotations

import ast
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
LIBRARY = ROOT / "src" / "standoff"
SHORT = 100
"""Lines of a file that its only importer might hold as well."""

KINDS = frozenset({"Body", "Solid", "PlanarSolid", "Compound", "World", "Robot"})
"""Classes of what has a distance: code that asks for one of them is written for each again."""

Sources = Mapping[str, str]
"""The text of each module by its name."""


def sources(library: Path = LIBRARY) -> dict[str, str]:
    """The library's own files by the names of their modules."""
    texts = {}
    for file in sorted([*library.rglob("*.py"), *library.rglob("*.pyi")]):
        parts = file.relative_to(library.parent).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        texts[name + (".pyi" if file.suffix == ".pyi" else "")] = file.read_text("utf-8")
    return texts


def lines(texts: Sources) -> dict[str, int]:
    """Lines of each package, of the modules beside them (``.``), and of all (``total``)."""
    counts: Counter[str] = Counter()
    packages = {name.split(".")[1] for name in texts if name.count(".") > 1}
    for name, text in texts.items():
        first = name.removesuffix(".pyi").split(".")[1:2]
        package = first[0] if first and first[0] in packages else "."
        counts[package] += text.count("\n")
    return {**dict(sorted(counts.items())), "total": counts.total()}


@cache
def tree(text: str) -> ast.Module:
    return ast.parse(text)


def public_names(texts: Sources) -> list[str]:
    """The names that modules declare in ``__all__``, with their modules: an import path each."""
    paths = []
    for name, text in texts.items():
        for node in tree(text).body:
            if isinstance(node, ast.Assign) and _targets(node) == ["__all__"]:
                listed = [
                    str(each.value)
                    for each in ast.walk(node.value)
                    if isinstance(each, ast.Constant)
                ]
                paths += [f"{name.removesuffix('.pyi')}.{each}" for each in listed]
    return sorted(set(paths))


def _targets(node: ast.Assign) -> list[str]:
    return [each.id for each in node.targets if isinstance(each, ast.Name)]


def repeated_classes(texts: Sources) -> list[str]:
    """Names that more than one class has, at the top of modules of the library."""
    named = Counter(
        node.name
        for name, text in texts.items()
        if not name.endswith(".pyi")
        for node in tree(text).body
        if isinstance(node, ast.ClassDef)
    )
    return sorted(name for name, count in named.items() if count > 1)


def imports(texts: Sources) -> Iterator[tuple[str, str]]:
    """Pairs of an importing module and the imported one, wherever the statement stands."""
    for name, text in texts.items():
        for node in ast.walk(tree(text)):
            if isinstance(node, ast.Import):
                yield from ((name, each.name) for each in node.names if each.name in texts)
            elif isinstance(node, ast.ImportFrom) and node.module:
                for each in node.names:
                    inner = f"{node.module}.{each.name}"
                    module = inner if inner in texts else node.module
                    if module in texts:
                        yield name, module


def short_for_one(texts: Sources) -> list[str]:
    """Modules of fewer lines than `SHORT` that a single other one imports."""
    importers: dict[str, set[str]] = {}
    packages = {name.rpartition(".")[0] for name in texts}
    for importer, module in imports(texts):
        importers.setdefault(module, set()).add(importer)
    return sorted(
        module
        for module, those in importers.items()
        if len(those) == 1 and module not in packages and texts[module].count("\n") < SHORT
    )


def asks_for_kind(texts: Sources) -> dict[str, int]:
    """By module, how often it asks of which kind a shape is, or whether it has an attribute."""
    counts: Counter[str] = Counter()
    for name, text in texts.items():
        for node in ast.walk(tree(text)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                counts[name] += _asks(node, node.func.id)
    return {name: count for name, count in sorted(counts.items()) if count}


def _asks(node: ast.Call, called: str) -> bool:
    if called == "isinstance" and len(node.args) == 2:
        return not KINDS.isdisjoint(_names(node.args[1]))
    return called in ("is_solid", "hasattr") or (called == "getattr" and len(node.args) == 3)


def _names(node: ast.expr) -> Iterable[str]:
    return (
        each.id if isinstance(each, ast.Name) else each.attr
        for each in ast.walk(node)
        if isinstance(each, ast.Name | ast.Attribute)
    )


def counted(texts: Sources) -> dict[str, int]:
    """All that has a budget of its own beside lines."""
    return {
        "modules": len(texts),
        "public-names": len(public_names(texts)),
        "repeated-classes": len(repeated_classes(texts)),
        "short-for-one": len(short_for_one(texts)),
        "asks-for-kind": sum(asks_for_kind(texts).values()),
    }


def budgets() -> dict[str, dict[str, int]]:
    """What pyproject.toml allows: ``lines`` by package, and ``counts``."""
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    return declared["tool"]["standoff"]["budgets"]


def main() -> None:
    texts = sources()
    for heading, counts in (("lines", lines(texts)), ("counts", counted(texts))):
        print(f"[tool.standoff.budgets.{heading}]")
        for name, count in counts.items():
            print(f'"{name}" = {count}' if name == "." else f"{name} = {count}")
        print()


if __name__ == "__main__":
    main()
