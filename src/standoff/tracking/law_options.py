"""How an option of a law is declared: its values, their check, and their number for the kernels.

An option is defined in one place, as a field of its law in ``standoff.tracking.laws``. The check,
the kernels' array, a recording's record, a scene's keys, the command line's flags and the docstring
are made from that. Nothing heavy is imported here: the command line's help needs it.
"""

from __future__ import annotations

import dataclasses
import functools
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

METADATA = "option"
WIDTH = 100
"""Of a docstring's lines, in characters."""

Class = TypeVar("Class", bound=type)


@dataclass(frozen=True)
class Choice:
    """One of some names, in the order of the kernels' numbers for them."""

    names: tuple[str, ...]

    def checked(self, value: Any, name: str) -> str:
        from standoff.checks.names import choice

        return choice(value, name, self.names)

    def number(self, value: str) -> float:
        return float(self.names.index(value))

    def words(self) -> str:
        return " or ".join([", ".join(self.names[:-1]), self.names[-1]])

    def annotation(self) -> str:
        quoted = [f'"{name}"' for name in self.names]
        return " or ".join([", ".join(quoted[:-1]), quoted[-1]])


@dataclass(frozen=True)
class Positive:
    """A number above zero."""

    infinite: bool = False

    def checked(self, value: Any, name: str) -> float:
        from standoff.checks.numbers import positive

        return positive(value, name, infinite=self.infinite)

    def number(self, value: float) -> float:
        return value

    def words(self) -> str:
        return "a number above zero" + (", or inf" if self.infinite else "")

    def annotation(self) -> str:
        return "float"


@dataclass(frozen=True)
class Whole:
    """A whole number above zero."""

    def checked(self, value: Any, name: str) -> int:
        from standoff.checks.numbers import whole_number

        return whole_number(value, name)

    def number(self, value: int) -> float:
        return float(value)

    def words(self) -> str:
        return "a whole number above zero"

    def annotation(self) -> str:
        return "int"


@dataclass(frozen=True)
class YesNo:
    """True or False."""

    def checked(self, value: Any, name: str) -> bool:
        from standoff.checks.numbers import yes_or_no

        return yes_or_no(value, name)

    def number(self, value: bool) -> float:
        return float(value)

    def words(self) -> str:
        return "true or false"

    def annotation(self) -> str:
        return "bool"


@dataclass(frozen=True)
class OfFeedback:
    """One of ``so.feedback``; as plain data its kind and its numbers."""

    def checked(self, value: Any, name: str) -> Any:
        from standoff.tracking.feedback import checked_feedback

        return checked_feedback(value)

    def words(self) -> str:
        return "an inline table such as '{ kind = \"pi\", gain = 400.0, integral = 4e4 }'"

    def annotation(self) -> str:
        return "of so.feedback"


Kind = Choice | Positive | Whole | YesNo | OfFeedback


@dataclass(frozen=True)
class Option:
    """One option of a law, under one name in Python, in scenes and on the command line.

    Attributes
    ----------
    name : str
    default : object
        None where it is not a value itself: `help` then says what holds.
    kind : Choice, Positive, Whole, YesNo or OfFeedback
    help : str
        One sentence.
    metavar : str
        What the command line's help calls the value, if not by the option's name.
    unit : str
    """

    name: str
    default: Any
    kind: Kind
    help: str
    metavar: str
    unit: str

    def checked(self, value: Any) -> Any:
        """Return the value as it is kept, or raise an error that says why it is not one."""
        if value is None and self.default is None:
            return None
        return self.kind.checked(value, self.name)

    def plain(self, value: Any) -> Any:
        """Return the value as data that JSON and TOML can hold."""
        if value is None or not isinstance(self.kind, OfFeedback):
            return value
        from standoff.tracking.feedback_facts import feedback_facts

        return feedback_facts(value)

    def of_plain(self, value: Any) -> Any:
        """Return the value that `plain` made data of."""
        if value is None or not isinstance(self.kind, OfFeedback):
            return value
        from standoff.tracking.feedback_facts import feedback_of_facts

        return feedback_of_facts(value)


def option(default: Any, kind: Kind, help: str, metavar: str = "", unit: str = "") -> Any:
    """Declare an option: a field of a law's dataclass."""
    return dataclasses.field(default=default, metadata={METADATA: (kind, help, metavar, unit)})


def options_of(law: Any) -> Mapping[str, Option]:
    """Return the options of a law, or of its class, by name."""
    found = {}
    for field in dataclasses.fields(law):
        found[field.name] = Option(field.name, field.default, *field.metadata[METADATA])
    return found


def documented(law: Class) -> Class:
    """Write the options of a law into its docstring, as its parameters."""
    lines = ["", "", "    Parameters", "    ----------"]
    for each in options_of(law).values():
        optional = ", optional" if each.default is None else f", default {each.default!r}"
        lines += [f"    {each.name} : {each.kind.annotation()}{optional}"]
        lines += textwrap.wrap(each.help, WIDTH, initial_indent=" " * 8, subsequent_indent=" " * 8)
    lines += ["", "    Raises", "    ------", "    TypeError", "        No such option."]
    lines += ["    ValueError", "        Values that an option does not take.", "    "]
    law.__doc__ = str(law.__doc__).rstrip() + "\n".join(lines)
    return law


def told_by_name(law: Class) -> Class:
    """Make a law name options that it does not have, which its dataclass would only refuse."""
    made = law.__dict__["__init__"]

    @functools.wraps(made)
    def checked(self: Any, *args: Any, **given: Any) -> None:
        known = options_of(law)
        if not args and given.keys() <= known.keys():
            made(self, **given)
            return
        from standoff.checks.names import did_you_mean
        from standoff.checks.real_numbers import shown
        from standoff.errors import StandoffTypeError

        listed = f"so.{law.__name__} has the options {', '.join(known)}."
        if args:
            raise StandoffTypeError(
                f"so.{law.__name__}({shown(args[0])}): options are given by name. {listed}", "law"
            )
        name = min(given.keys() - known.keys())
        raise StandoffTypeError(
            f"so.{law.__name__} has no option {name!r}.{did_you_mean(name, known)} {listed}",
            name,
            given[name],
        )

    setattr(law, "__init__", checked)  # noqa: B010 - mypy takes no assignment to a method
    return law


@dataclass(frozen=True, kw_only=True, repr=False)
class Law:
    """What both laws have; `standoff.tracking.laws` has the laws themselves."""

    name: ClassVar[str]
    """In scenes, on the command line and in recordings."""
    only_one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Options of which one at most may be given."""

    tolerance: float = option(
        1e-10,
        Positive(infinite=True),
        "Gap between distance and lower bound, less the bodies' own slack, in sizes of the pair, "
        "up to which a frame counts as certified.",
        metavar="GAP",
    )
    depth: str = option(
        "global",
        Choice(("global", "local")),
        "In penetration, prove in every frame that no direction has a smaller depth, or follow "
        "one local minimum, which costs less.",
    )
    deadline: int | None = option(
        None,
        Whole(),
        "Greatest number of second-order evaluations that a step may take before it ends with "
        "the best certified answer so far; no limit if not given.",
        metavar="N",
    )
    restarts: bool = option(
        True,
        YesNo(),
        "Search globally where a frame is not certified, and go to a lesser depth where there is "
        "one; or only follow the local minimum from frame to frame, with the status NOT_RESTARTED "
        "where it is lost or may not be the least. With the paper's law false is as printed: "
        "nothing but the law moves the witness points.",
        metavar="true|false",
    )
    within: float | None = option(
        None,
        Positive(),
        "Horizon, in length: of bodies farther apart only that is proven, with the status FAR, "
        "which costs less; none if not given.",
        metavar="LENGTH",
    )

    def __post_init__(self) -> None:
        for each in options_of(self).values():
            value = getattr(self, each.name)
            if value is not each.default:  # known to be one, and the check needs NumPy
                object.__setattr__(self, each.name, each.checked(value))

    def __repr__(self) -> str:
        given = [
            f"{each.name}={getattr(self, each.name)!r}"
            for each in options_of(self).values()
            if getattr(self, each.name) != each.default
        ]
        return f"{type(self).__name__}({', '.join(given)})"

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if name not in ("check_step", "only_one")]

    def resolved(self, dt: float) -> Law:
        """Return the law with the defaults that depend on the frame time [s], or on each other,
        filled in.

        Raises ValueError: a feedback that is not stable at that frame time.
        """
        return self

    def check_step(self, dt: float) -> None:
        """Raise ValueError if a frame is too long, in s, for the resolved law to be stable."""

    def facts(self) -> dict[str, Any]:
        """Return the law's name and all its options as plain data, with a scene's keys."""
        told = {n: each.plain(getattr(self, n)) for n, each in options_of(self).items()}
        return {"law": self.name} | told
