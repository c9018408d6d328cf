"""What the docstrings of public names must say, as far as a machine can tell.

Every parameter is described, functions say what they return, and whatever is raised at a wrong
argument, tried out, is named under Raises, or in a paragraph that begins with it.
"""

from __future__ import annotations

import enum
import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import standoff as so
from fuzz.test_hostile_arguments import FEW, HOSTILE
from public_calls import MODULES, NOT_CALLED, Call, calls, pair_calls

HEADING = re.compile(r"^(\w[\w ]*)\n-{3,}$", re.MULTILINE)
SENTENCE = re.compile(r"^Raises [^\n].*?(?=\n\n|\Z)", re.MULTILINE | re.DOTALL)


def sections(thing: Any) -> dict[str, str]:
    """Return the sections of a NumPy docstring by their headings."""
    text = inspect.getdoc(thing) or ""
    found = list(HEADING.finditer(text))
    ends = [heading.start() for heading in found[1:]] + [len(text)]
    return {
        heading[1]: text[heading.end() : end] for heading, end in zip(found, ends, strict=False)
    }


def public() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Yield the public functions and classes: no modules, aliases of types, enums, exceptions."""
    for module_name, module in MODULES.items():
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isfunction(thing):
                yield f"{module_name}.{name}", thing
            elif inspect.isclass(thing) and not issubclass(thing, enum.Enum | Exception):
                if getattr(thing, "_is_protocol", False):
                    continue
                yield f"{module_name}.{name}", thing


PUBLIC = dict(public())
CHEAP = {call.name for call in calls()}


@pytest.mark.parametrize("name", PUBLIC)
def test_every_parameter_is_described(name: str) -> None:
    """For results, which the library makes itself, the attributes are, some perhaps by a base."""
    thing = PUBLIC[name]
    bases = thing.__mro__ if inspect.isclass(thing) else (thing,)
    attributes = [sections(base).get("Attributes", "") for base in bases]
    described = sections(thing).get("Parameters", "\n".join(attributes).strip())
    names = re.findall(r"^([\w*][\w, *]*?)(?: :|$)", described, re.MULTILINE)
    known = {one.strip(" *") for line in names for one in line.split(",")}
    assert described or not inspect.signature(thing).parameters
    if thing is so.Proximity:  # made from one array of the kernels'
        return
    parameters = inspect.signature(thing).parameters
    assert set(parameters) <= known, f"{name}: {set(parameters) - known} not described"


@pytest.mark.parametrize("name", [n for n, thing in PUBLIC.items() if inspect.isfunction(thing)])
def test_functions_say_what_they_return(name: str) -> None:
    returns = inspect.signature(PUBLIC[name]).return_annotation
    assert returns in (None, "None") or "Returns" in sections(PUBLIC[name])


def raised(call: Call, arguments: dict[str, Any]) -> Exception | None:
    """Return what a call raises."""
    try:
        call.public(**arguments)
    except Exception as error:
        return error
    return None


@pytest.mark.parametrize("call", [*calls(), *pair_calls()], ids=lambda call: call.name)
def test_what_is_raised_is_named(call: Call) -> None:
    """By its own name, or that of a class it inherits from."""
    sentences = SENTENCE.findall(inspect.getdoc(call.public) or "")
    told = "\n".join([sections(call.public).get("Raises", ""), *sentences])
    kinds = HOSTILE if call.name in CHEAP else FEW
    for key in call.arguments:
        for kind in kinds:
            error = raised(call, {**call.arguments, key: HOSTILE[kind]})
            if error is not None:
                names = [c.__name__ for c in type(error).__mro__ if issubclass(c, Exception)]
                named = any(re.search(rf"\b{name}\b", told) for name in names[:-1])
                assert named, f"{key} = {kind} raises {names[0]}: {error}"


def test_every_constructor_is_tried() -> None:
    """What checks its arguments stands in the table of calls, or beside it with a reason."""
    tried = {call.name.split(".")[1] for call in (*calls(), *pair_calls())}
    for name, thing in PUBLIC.items():
        made_here = hasattr(thing, "_fields") or "Parameters" not in sections(thing)
        if inspect.signature(thing).parameters and not made_here:
            short = name.split(".")[-1]
            assert short in tried or short in NOT_CALLED, f"{name} is in no table of public_calls"
