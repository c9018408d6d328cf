"""Packages that import their public names when these are first asked for (PEP 562).

Importing all of the library takes several times as long as importing Numba, and a program needs
little of it. Type checkers read the imports that such a package has under TYPE_CHECKING.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dis import get_instructions
from importlib import import_module
from importlib.util import find_spec
from types import CodeType, ModuleType
from typing import Any


class _Package(ModuleType):
    """A package one of whose names may also be that of the module it comes from.

    Importing such a module would bind it in the package, in place of what is public by the name.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if isinstance(value, ModuleType) and value.__name__ == self._homes.get(name):
            value = getattr(value, name)
        super().__setattr__(name, value)


def _imports(code: CodeType) -> Iterator[tuple[str, str]]:
    """The names that a module's code imports, each with the module it comes from: also those under
    TYPE_CHECKING, which are compiled though they never run."""
    module = ""
    for step in get_instructions(code):
        if step.opname == "IMPORT_NAME":
            module = step.argval
        elif step.opname == "IMPORT_FROM":
            yield step.argval, module


def on_demand(
    package: str, *, modules: Sequence[str] = ()
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return a package's ``__getattr__`` and ``__dir__``, as its own file calls it: it hands out
    what its file imports under TYPE_CHECKING.

    Parameters
    ----------
    package : the package's ``__name__``.
    modules : those of its own modules that are public: what `dir` lists besides ``__all__``.
    """
    homes = {name: home for name, home in _imports(sys._getframe(1).f_code) if home != package}
    this = sys.modules[package]
    vars(this)["_homes"] = homes
    this.__class__ = _Package

    def __getattr__(name: str) -> Any:
        if name in homes:
            value = getattr(import_module(homes[name]), name)
            setattr(this, name, value)
            return value
        module = f"{package}.{name}"
        # An import binds a module in its package itself.
        if name.isidentifier() and not name.startswith("_") and find_spec(module) is not None:
            return import_module(module)
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        public = {*modules, *vars(this).get("__all__", ())}
        return sorted({*public, *(name for name in vars(this) if name.startswith("__"))})

    return __getattr__, __dir__
