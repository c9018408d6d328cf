"""Every item of the paper: equations, figures, claims and applications, and what we have of it."""

from __future__ import annotations

from typing import NamedTuple


class Item(NamedTuple):
    """An item of the paper.

    Attributes
    ----------
    name : str
    state : str
        "done", "partial" or "absent".
    told : str
        A remark.
    pages : str
        Where it is in the pages, as Markdown.
    figures : tuple of str
        Keys of the figures that show it.
    """

    name: str
    state: str
    told: str
    pages: str
    figures: tuple[str, ...]


# A few lines per item.
# fmt: off
ITEMS: tuple[Item, ...] = (
    Item("Figs. 1, 2: patches, tangents, ΔR", "done", "",
         "[patches](patches.md)", ("1", "2")),
    Item("Eqs. (1)–(4), Ψ", "done", "",
         "[the pair system](../pair-system.md)", ()),
    Item("Eqs. (5)–(11), M and b", "done", "b includes the translation",
         "[the pair system](../pair-system.md)", ()),
    Item("Eqs. (12)–(14), the law; integrators", "done", "",
         "[laws](../laws.md)", ("7", "gains")),
    Item("M is positive definite",
         "partial", "H = S M is near the minimum; away from it that depends on (u, v)",
         "[where M is definite](definite.md)", ("basin",)),
    Item("Figs. 3, 4: both block diagrams", "done", "",
         "[realisations](realisations.md)", ("3", "4")),
    Item("Fig. 5: dynamics, virtual coupler, device and tracker in one integration",
         "done", "with a simulated device",
         "[in the loop](in-the-loop.md)", ("5",)),
    Item("other feedbacks, lower gain online", "done", "",
         "[control](control.md), [variants](variants.md)", ("lower", "feedback", "variants")),
    Item("saturation by zeroing", "done", "Figs. 8–20 use it",
         "[variants](variants.md)", ("variants",)),
    Item("Eqs. (15)–(17): modes, guards, resets", "done", "as printed, `so.PaperLaw.as_printed`",
         "[the automaton](../automaton.md), [variants](variants.md)", ("9", "13", "17")),
    Item("Voronoi regions computed before the run",
         "done", "inside simulation B's body the automaton reads them",
         "[Voronoi regions](voronoi.md)", ("voronoi", "8", "12")),
    Item("simulation A, Figs. 6, 7",
         "done", "drawn as fractions of the first errors, and counted as cosines too",
         "[simulation A](simulation-a.md)", ("6", "7")),
    Item("simulation B, Figs. 8–11", "done", "by the printed system",
         "[simulation B](simulation-b.md)", ("8", "9", "10", "11")),
    Item("simulation C, Figs. 12–15", "done", "by the printed system",
         "[simulation C](simulation-c.md)", ("12", "13", "14", "15")),
    Item("simulation D, Figs. 16–18", "done", "by the printed system",
         "[simulation D](simulation-d.md)", ("16", "17", "18")),
    Item("simulation E, Figs. 19, 20", "done", "by the printed system",
         "[simulation E](simulation-e.md)", ("19", "20")),
    Item("switching times of body and point do not depend on the state",
         "done", "outside and, by the medial axis, inside",
         "[simulation D](simulation-d.md), [simulation B](simulation-b.md)", ("9", "17")),
    Item("the switching tests of one body do not depend on its own witness point", "done", "",
         "[simulation E](simulation-e.md)", ("20",)),
    Item("the distance between features never grows at a switch",
         "done", "by construction of the closest points; measured at the printed resets",
         "[simulation D](simulation-d.md), [simulation E](simulation-e.md)",
         ("9", "13", "17", "20")),
    Item("a start anywhere on tiled convex bodies converges",
         "done",
         "in the plane yes; in space not with M as printed, where it depends on the patches",
         "[which starts arrive](convergence.md), [where M is definite](definite.md)",
         ("arrivals",)),
    Item("gains from 0.5 to 1500 at 1 kHz; upper limit",
         "done", "stable inside, and beyond both ends too: from 0.25 to 1990",
         "[simulation A](simulation-a.md), [control](control.md)", ("7", "stability")),
    Item("each update takes one time step", "done", "two evaluations with the paper's integrator",
         "[verdict](verdict.md)", ("cost",)),
    Item("comparison with Newton, quasi-Newton and gradient descent", "done", "",
         "[verdict](verdict.md)", ("cost", "verdict")),
    Item("Newton's basin is not connected", "done", "",
         "[control](control.md)", ("basin",)),
    Item("the equations of ref. [28]", "done", "",
         "[the normals' set](normals.md)", ("normals",)),
    Item("interpenetration (future work)", "done", "beyond the paper",
         "[penetration](../penetration.md)", ("furthest",)),
    Item("haptic device and rendering (application)", "partial", "a simulated device",
         "[the virtual coupler](../coupler.md)", ("5",)),
    Item("bodies that are not convex, broad phase (future work)", "partial",
         "a frame of such bodies in contact takes milliseconds",
         "[solids](../solids.md), [worlds](../worlds.md)", ("nonconvex",)),
)
# fmt: on


def markdown() -> str:
    """Return the items as the table of the pages."""
    rows = [
        f"| {item.name} | {item.state}{': ' if item.told else ''}{item.told} | {item.pages} |"
        for item in ITEMS
    ]
    return "\n".join(["| item of the paper | here | where |", "|---|---|---|", *rows])
