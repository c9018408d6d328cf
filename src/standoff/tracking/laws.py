"""The laws that a tracker follows, as values, with all their options.

An option is one field here; see `standoff.tracking.law_options` for what is made of it. Its name
is also that of its slot among the kernels' options (``standoff.tracking.options``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from standoff.errors import StandoffError, StandoffTypeError
from standoff.tracking.law_options import (
    Choice,
    Law,
    OfFeedback,
    Option,
    Positive,
    YesNo,
    documented,
    option,
    options_of,
    told_by_name,
)


class OptionsConflict(StandoffError):
    """Options of a law that do not go together.

    Attributes
    ----------
    options : tuple of str
        Their names; `argument` is the first.
    """

    def __init__(self, message: str, options: tuple[str, ...]) -> None:
        super().__init__(message, options[0])
        self.options = options


@told_by_name
@documented
@dataclass(frozen=True, kw_only=True, repr=False)
class PredictorCorrector(Law):
    """Predict with the feedforward and correct with one Newton step: the default (docs/laws.md)."""

    name: ClassVar[str] = "predictor-corrector"

    predictor: str = option(
        "feedforward-2",
        Choice(("none", "secant", "feedforward", "feedforward-2")),
        "Predict by the blend of the last two feedforwards, by the last one, by the secant of the "
        "last two frames (it also serves where no twists are given), or not at all.",
    )


@told_by_name
@documented
@dataclass(frozen=True, kw_only=True, repr=False)
class PaperLaw(Law):
    """The paper's law: integrate w = -M⁻¹(K Psi + b), Eq. (12), from one frame to the next."""

    name: ClassVar[str] = "paper"
    only_one: ClassVar[tuple[tuple[str, ...], ...]] = (("gain", "feedback"),)

    integrator: str = option(
        "heun",
        Choice(("euler", "heun", "midpoint", "rk4")),
        "Method of one stage a frame, two (heun, midpoint), or four.",
    )
    gain: float | None = option(
        None,
        Positive(),
        "K, 1/s, below so.max_gain(integrator, dt); one over the frame time if not given.",
        metavar="K",
        unit="1/s",
    )
    feedback: Any = option(
        None,
        OfFeedback(),
        "Another feedback in place of the gain; linear with the gain if not given.",
        metavar="TABLE",
    )
    feedforward: bool = option(
        True,
        YesNo(),
        "Feed b forward, or leave it out.",
        metavar="true|false",
    )
    realisation: str = option(
        "evaluated",
        Choice(("evaluated", "integrated")),
        "The paper's block diagrams: the errors Psi evaluated from Eqs. (1)-(4) at the parameters "
        "(Fig. 4), or integrated beside them from Psi' = M w + b (Fig. 3).",
    )
    saturation: str | None = option(
        None,
        Choice(("hold", "zero")),
        "At a boundary enter the edge, or, as printed, zero the components of the solved step that "
        "lead out; hold with the switching by multipliers, else zero, if not given.",
    )
    switching: str = option(
        "multipliers",
        Choice(("multipliers", "voronoi", "none")),
        "By the slopes at a stationary point, or, as printed, by Voronoi tests on the opposing "
        "witness point alone, or not at all: the witness points stay on their features.",
    )
    solve: str = option(
        "ranked",
        Choice(("ranked", "plain", "covariant")),
        "By H where it is definite, else by the part of it that does not depend on the "
        "parametrisation, which is semidefinite anywhere; or by H as it is, without a safeguard: "
        "the raw law; or by the covariant part everywhere.",
    )
    reset: str = option(
        "foot",
        Choice(("foot", "nearest")),
        "Where the Voronoi tests enter an edge: at its point closest to the opposing witness "
        "point, or, as printed, at the pcurve's parameter nearest in (u, v) to the face's own.",
    )
    far_side: str = option(
        "left",
        Choice(("left", "kept")),
        "A face whose tangent plane the opposing witness point is behind is left by the Voronoi "
        "tests, as Lin and Canny and V-Clip do, or kept: the face's region is then on both sides.",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gain is not None and self.feedback is not None:
            raise OptionsConflict(
                f"gain = {self.gain} and feedback = {self.feedback} both name the gain: give one "
                "of them.",
                ("gain", "feedback"),
            )
        if self.saturation == "zero" and self.switching == "multipliers":
            raise OptionsConflict(
                "saturation='zero' keeps a witness point on its face at the boundary, where "
                "switching='multipliers' never looks: take switching='voronoi' or 'none'.",
                ("saturation", "switching"),
            )
        if self.saturation == "hold" and self.switching == "none":
            raise OptionsConflict(
                "saturation='hold' enters the edge it meets, which switching='none' never leaves: "
                "take saturation='zero'.",
                ("saturation", "switching"),
            )

        if self.reset == "nearest" and self.switching != "voronoi":
            raise OptionsConflict(
                f"reset='nearest' belongs to the Voronoi tests, and switching={self.switching!r} "
                "makes none: take switching='voronoi'.",
                ("reset", "switching"),
            )

    @classmethod
    def as_printed(
        cls, *, gain: float, integrator: str = "heun", far_side: str = "kept"
    ) -> PaperLaw:
        """Return the system that the paper prints, without any safeguard of the library's.

        Errors are evaluated from Eqs. (1)-(4) (Fig. 4), M is solved as it is, Eq. (12), components
        that lead out of a patch are zeroed, Voronoi tests on the opposing witness point switch, and
        a switch onto an edge takes the pcurve's parameter nearest to the face's own. There is no
        restart and no search: ``answer.counts`` shows that none was made, and how many foot points
        the Voronoi tests have searched for.

        Parameters
        ----------
        gain : float
            K, 1/s. In its simulations the paper uses "a very low controller gain"; 25 to 100 work
            at 1 kHz.
        integrator : str, default "heun"
        far_side : {"kept", "left"}
            The paper's regions can be read both ways: that of a face is on both sides of it, or, as
            in Lin and Canny's algorithm, only in front.

        Notes
        -----
        M of two bodies may be indefinite far from the minimum, in one parametrisation and not in
        another. Such a start stays for ever in a corner of the right faces: docs/paper has the
        fractions. With ``solve="covariant"`` M is semidefinite anywhere.
        """
        return cls(
            integrator=integrator,
            gain=gain,
            realisation="evaluated",
            saturation="zero",
            switching="voronoi",
            solve="plain",
            reset="nearest",
            far_side=far_side,
            restarts=False,
        )

    def resolved(self, dt: float) -> PaperLaw:
        saturation = self.saturation or ("hold" if self.switching == "multipliers" else "zero")
        if self.feedback is None:
            found = replace(self, saturation=saturation, gain=self.gain or 1.0 / dt)
        else:
            feedback = self.feedback.resolved(self.integrator, dt)
            found = replace(self, saturation=saturation, feedback=feedback)
        found.check_step(dt)
        return found

    def check_step(self, dt: float) -> None:
        from standoff.tracking.feedback import Linear, check_stable

        loop = Linear(self.gain or 1.0 / dt) if self.feedback is None else self.feedback
        check_stable(loop, self.integrator, dt)


DEFAULT_LAW = PredictorCorrector()

LAWS: Mapping[str, type[Law]] = {law.name: law for law in (PredictorCorrector, PaperLaw)}
"""By the name that scenes and recordings give them."""

PYTHON = {law: f"so.{law.__name__}" for law in LAWS.values()}


def every_option() -> Mapping[str, Option]:
    """Return the options of all laws by name; those with the same name are one option."""
    return {name: each for law in LAWS.values() for name, each in options_of(law).items()}


def laws_with(name: str) -> tuple[type[Law], ...]:
    """Return the laws that have an option."""
    return tuple(law for law in LAWS.values() if name in options_of(law))


def checked_law(law: Any) -> Law:
    """Return a law, or raise TypeError that says how to make one."""
    if type(law) in LAWS.values():
        return law  # type: ignore[no-any-return]
    from standoff.checks.real_numbers import shown

    if isinstance(law, type) and law in LAWS.values():
        name = PYTHON[law]
        raise StandoffTypeError(
            f"law = {name} is a class: make a law of it, law={name}().", "law", law
        )
    known = " or ".join(f"{name}(...)" for name in PYTHON.values())
    raise StandoffTypeError(f"law = {shown(law)} is not a law: give {known}.", "law", law)


def law_of_facts(facts: Mapping[str, Any]) -> Law:
    """Return the law of plain data that `Law.facts` made.

    Raises ValueError: what is not such data, for instance a feedback that a program made itself.
    """
    options = dict(facts)
    name = options.pop("law", None)
    if not isinstance(name, str) or name not in LAWS:
        raise StandoffError(f"law = {name!r} is not one of {list(LAWS)}.", "law", name)
    known = options_of(LAWS[name])
    for unknown in options.keys() - known.keys():
        raise StandoffError(
            f"{unknown} is not an option of the law '{name}': it has {list(known)}.", unknown
        )
    return LAWS[name](**{option: known[option].of_plain(x) for option, x in options.items()})
