"""Key "nonconvex": is it only necessary to modify the switching, for bodies that are not convex?"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from standoff.motion import Pose
from standoff.typing import Array
from standoff_studies.paper import style
from standoff_studies.paper.drawing import show_plane
from standoff_studies.paper.figure import Artwork, Statement, measured_by, own_statement
from standoff_studies.paper.keys import key_below, key_line
from standoff_studies.paper.law_words import law_words
from standoff_studies.paper.nonconvex_bore import InBore, in_bore
from standoff_studies.paper.nonconvex_runs import (
    READINGS,
    Run,
    at_seams,
    jumps,
    library,
    run,
)
from standoff_studies.paper.nonconvex_scene import BALLS, PAIRS, RADIUS, Truth, X, middles, truth

SENTENCE = "bodies that are not convex need only another switching"
"""The paper's sentence at the end of Section IV."""
WRONG = 1e-4
"""A distance that is off by more is wrong [length]: the law lags by less."""
EXACT = 1e-9
"""By how much a proven distance may be off, or one of samples [length]."""
PICTURES = 3
JUMP = 0.1
"""A witness point that moves by more in a frame has jumped [length]: no motion moves it so far."""


def nonconvex() -> Artwork:
    """Make the figure."""
    runs = [run(reading) for reading in READINGS]
    return Artwork(
        caption=(
            "Above: a chain of two balls goes around one of three, in the plane; all local minima "
            "of their distance at three instants, the nearest in red; those that the branches of "
            "the start still follow have a ring. Middle: distance, true and as told by the printed "
            "law from all minima of the start, and from all pairs of balls; and how many minima "
            "there are, with the branches that follow those of the start. Below: an elliptic pin "
            "goes to and fro in a bore, one pair of smooth patches: its two minima (grey; where "
            "one line ends the minimum is gone), and the two branches of the printed law."
        ),
        text=(
            "Three pictures of two chains of circles with lines between them; two diagrams over "
            "time in which the told distance leaves the true one, and one in which two branches "
            "leave the minima they followed."
        ),
        draw=_draw,
        tables={"readings": _table(runs), "distances": _distances(runs), "bore": _bore(in_bore())},
        statements=measured_by(law_words(*runs[2].trackers), _statements()),
        shown=("readings",),
    )


def wrong(one: Run) -> NDArray[np.bool_]:
    """Return in which frames the distance is wrong."""
    return np.asarray(np.abs(one.distance - truth().distance) > WRONG)


def _table(runs: list[Run]) -> dict[str, list[str]]:
    """Each reading, and the library: branches beside minima, frames with a wrong distance."""
    known, own = truth(), library()
    count = known.alive.sum(axis=1)
    off = np.abs(own.distance - known.distance[own.frames])
    rows = [
        (name, one.branches, count, int(wrong(one).sum()), np.abs(one.distance - known.distance))
        for name, one in zip(READINGS, runs, strict=True)
    ]
    rows.append(
        ("library, as solids", own.branches, count[own.frames], int((off > WRONG).sum()), off)
    )
    return {
        "branches": [name for name, *_ in rows],
        "median that run": [f"{np.median(ran):.0f}" for _, ran, *_ in rows],
        "most": [f"{ran.max()}" for _, ran, *_ in rows],
        "median that exist": [f"{np.median(there):.0f}" for _, _, there, *_ in rows],
        "most of these": [f"{there.max()}" for _, _, there, *_ in rows],
        "frames with a wrong distance": [f"{bad} of {len(ran)}" for _, ran, _, bad, _ in rows],
        "off by at most [length]": [f"{error.max():.1e}" for *_, error in rows],
    }


def _distances(runs: list[Run]) -> dict[str, Any]:
    known = truth()
    table: dict[str, Any] = {"time_s": known.time, "true_length": known.distance}
    for k, one in enumerate(runs):
        table[f"reading_{k}_length"] = one.distance
        table[f"reading_{k}_branches"] = one.branches
    return table | {"minima": known.alive.sum(axis=1)}


def _bore(one: InBore) -> dict[str, Any]:
    table: dict[str, Any] = {"time_s": one.time, "minima": [len(each) for each in one.minima]}
    for k in range(2):
        table[f"branch_{k}_length"] = one.branches[:, k]
        table[f"branch_{k}_least_eigenvalue_length2"] = one.least[:, k]
    return table


def _statements() -> tuple[Statement, ...]:
    return (*_by_switching(), *_in_bore(), *_by_library())


def _by_switching() -> tuple[Statement, ...]:
    """Of the chains, by the printed law."""
    known = truth()
    _, start, every, fresh = (run(reading) for reading in READINGS)
    off = float(np.abs(every.distance - known.distance).max())
    unseen, births, near = at_seams(start)
    leaps, switches = jumps(every, JUMP)
    return (
        Statement(
            "Section IV",
            f"{SENTENCE}: a branch for every pair of convex parts, the least answers",
            f"{len(PAIRS)} branches of the printed system in parallel, for "
            f"{BALLS[0]} x {BALLS[1]} balls: off by at most {off:.0e} length in "
            f"{len(known.time)} frames",
            off < WRONG,
            "a union of convex parts is as far as its nearest parts, and each pair of these has "
            "one minimum, so nothing has to be found",
        ),
        Statement(
            "Section VI",
            "when it switches, the closest points do not have to be on neighbouring features",
            f"at {leaps} of {switches} switches between branches a witness point jumps by more "
            f"than {JUMP:g} length",
            leaps > 0,
        ),
        Statement(
            "Section VI",
            f"{SENTENCE}: the fewest branches, one for each minimum of the start, going on across "
            "reflex edges from the nearest points there",
            f"wrong in {int(wrong(start).sum())} of {len(known.time)} frames, by up to "
            f"{np.abs(start.distance - known.distance).max():.2g} length; {start.handed} handed "
            f"over, {start.merged} ended as the parts beyond had a branch. {births} minima are "
            f"born, all within {near:.0e} length of a reflex edge, and at {unseen} of these no "
            f"branch changes its feature. Told of each birth in the frame, the same branches, a "
            f"median of {np.median(fresh.branches):.0f}, are wrong in {int(wrong(fresh).sum())}",
            not wrong(start).any(),
            "a minimum comes out of a reflex edge without any followed point crossing a boundary: "
            "it has to be looked for",
        ),
    )


def _in_bore() -> tuple[Statement, ...]:
    """Of the pin in its bore."""
    bore = in_bore()
    gone, worst = bore.wrong > WRONG, int(bore.wrong.argmax())
    return (
        Statement(
            "Section IV",
            f"{SENTENCE}: one pair of smooth convex patches of which one faces inwards",
            f"both minima of a pin in a bore are followed from the start; the least is wrong in "
            f"{int(gone.sum())} of {len(gone)} frames, by up to {bore.wrong[worst]:.2f} length, "
            f"with |Ψ| of {bore.errors[worst].max():.0e} there, and H has the eigenvalue "
            f"{bore.least[worst].min():.3f}: a saddle",
            not gone.any(),
            "a minimum ends in the middle of both patches, where M is singular and no boundary is "
            "near, and the law, which drives Ψ to 0, goes on to what is no minimum",
            law_words(bore.tracker),
        ),
        own_statement(
            "Section IV",
            f"a pin in a bore: so.distance of the plate and the pin, from nothing, off by at most "
            f"{np.abs(bore.proven - bore.distance).max():.0e} length at "
            f"{len(bore.time)} places",
            by="so.distance: no law",
        ),
    )


def _by_library() -> tuple[Statement, ...]:
    """Of the chains, by the library's tracker of solids."""
    known, own = truth(), library()
    same = int((own.branches == known.alive.sum(axis=1)[own.frames]).sum())
    return (
        Statement(
            "Section VI",
            "a minimum number of narrow phase algorithms in parallel",
            f"the library's tracker of the two solids follows as many branches as there are "
            f"minima in {same} of {len(own.frames)} frames, and proves the distance in "
            f"{own.certified}, off by at most "
            f"{np.abs(own.distance - known.distance[own.frames]).max():.0e} length",
            same == own.certified == len(own.frames),
            by=own.by,
        ),
        own_statement(
            "Section VI",
            f"births are found by the proof of the distance, which looks at all pairs of pieces "
            f"whose bounds let it: {own.born} after the start, {own.evaluations:.0f} evaluations a "
            f"frame (median) beside 2 for each of the printed law's {len(PAIRS)} branches",
            by=own.by,
        ),
    )


class Shown(NamedTuple):
    """An instant that is drawn."""

    frame: int
    letter: str


def shown(known: Truth, one: Run) -> list[Shown]:
    """Return the start, the middle of the first wrong stretch, and the worst frame of those in
    which the branch with the least distance is at a minimum."""
    bad = np.flatnonzero(wrong(one))
    if not len(bad):
        bad = np.array([len(known.time) // 2])
    first = bad[: int(np.argmax(np.diff(bad, append=bad[-1] + 2) > 1)) + 1]
    lives = known.alive[np.arange(len(known.time)), one.active]
    worst = int(np.argmax(np.where(lives, one.distance - known.distance, 0.0)))
    frames = 0, int(np.median(first)), worst
    return [Shown(frame, letter) for frame, letter in zip(frames, "abc", strict=True)]


def _draw() -> Figure:
    figure = style.new_figure(height=10.0)
    known, start, every = truth(), run(READINGS[1]), run(READINGS[2])
    halves: Any = figure.subfigures(2, 1, height_ratios=(1.0, 2.4))
    pictures, graphs = halves
    instants = shown(known, start)
    for axes, instant in zip(pictures.subplots(1, PICTURES), instants, strict=True):
        _draw_chains(axes, instant, start)
    above, middle, below = graphs.subplots(3, 1, height_ratios=(3, 2, 3))
    above.plot(known.time, known.distance, color=style.QUIET, linewidth=5.0, label="true")
    above.plot(known.time, every.distance, **style.line(0), label="from all pairs of balls")
    above.plot(known.time, start.distance, **style.line(1), label="from the minima of the start")
    above.set_ylabel("distance [length]")
    middle.step(known.time, known.alive.sum(axis=1), color=style.QUIET, linewidth=3.0)
    middle.step(known.time, start.branches, **style.line(1))
    middle.set(ylabel="minima, and\nbranches", xlabel="time [s]", ylim=(0.0, 6.5))
    for axes in (above, middle):
        for _, (frame, letter) in enumerate(instants):
            axes.axvline(known.time[frame], color=style.BLACK, linewidth=0.8, linestyle=":")
            if axes is above:
                axes.annotate(
                    letter, (known.time[frame], 1.0), xycoords=("data", "axes fraction"), va="top"
                )
    above.legend(frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.02))
    _draw_bore(below)
    looks = (("one branch", 0), ("the other", 1))
    lines = [key_line(name, style.COLOURS[k], dashes=style.DASHES[k]) for name, k in looks]
    key_below(graphs, [key_line("minima of pin and bore", style.QUIET, 5.0), *lines], 3)
    return figure


def _draw_chains(axes: Axes, instant: Shown, one: Run) -> None:
    """Both chains in the plane z = 0, and all minima of their distance."""
    known, k = truth(), instant.frame
    pose = known.poses[k]
    on = (_balls(0, Pose.identity()), _balls(1, pose))
    for places, colour in zip(on, (style.BLUE, style.ORANGE), strict=True):
        _outline(axes, places, colour)
    nearest = int(known.apart[k].argmin())
    for pair in np.flatnonzero(known.alive[k]).tolist():
        i, j = PAIRS[pair]
        way = on[1][j] - on[0][i]
        way = RADIUS * way / np.linalg.norm(way)
        ends = np.array([on[0][i] + way, on[1][j] - way])
        colour = style.RED if pair == nearest else style.BLACK
        axes.plot(*ends.T, color=colour, linewidth=1.6 if pair == nearest else 1.0, zorder=4)
        if one.runs[k] >> pair & 1:
            axes.plot(*ends.mean(axis=0), "o", markersize=6.0, mfc="none", color=style.BLACK)
    show_plane(axes, 6.5)
    axes.set_aspect("equal")
    axes.set(ylabel="y [length]" if instant.letter == "a" else "", xticks=(-5.0, 0.0, 5.0))
    axes.set_title(f"{instant.letter}: {known.time[k]:.2f} s", loc="left")


def _balls(side: int, pose: Pose) -> Array:
    """The middles of a chain's balls, x and y [length]."""
    along = middles(BALLS[side])[:, None] * X
    return np.asarray((along @ pose.rotation.T + pose.translation)[:, :2])


def _outline(axes: Axes, places: Array, colour: str) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = RADIUS * np.array([np.cos(angle), np.sin(angle)]).T
    for k, place in enumerate(places):
        around = place + circle
        others = np.delete(places, k, axis=0)
        hidden = (np.linalg.norm(around[:, None] - others, axis=2) < RADIUS).any(axis=1)
        axes.fill(*around.T, color=colour, alpha=0.12, linewidth=0.0)
        axes.plot(*np.where(hidden[:, None], np.nan, around).T, color=colour)


def _draw_bore(axes: Axes) -> None:
    one = in_bore()
    paths = np.full((len(one.time), 2), np.nan)
    for k, (apart, sides) in enumerate(zip(one.minima, one.sides, strict=True)):
        for value, side in zip(apart, sides, strict=True):
            paths[k, int(side)] = value
    axes.plot(one.time, paths, color=style.QUIET, linewidth=5.0)
    for k in range(2):
        axes.plot(one.time, one.branches[:, k], **style.line(k))
    axes.set(
        xlabel="time [s]",
        ylabel="distance of\npin and bore [length]",
    )
