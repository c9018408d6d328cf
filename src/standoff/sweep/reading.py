"""From a job's file to the job, with the errors of scenes."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from functools import partial

import numpy as np

from standoff.robots.joints import SLIDES, JointKind
from standoff.robots.limits import check_limits
from standoff.scene import SceneError
from standoff.scene.degrees import ENDING, with_degrees
from standoff.scene.files import existing_file, text_of, toml_tables
from standoff.scene.reader import SceneTable, shown, unknown_name
from standoff.sweep.job import Job
from standoff.sweep.keep import Bins, Keep
from standoff.sweep.parameters import ANGLE, SHIFTS, SLIDE, TURNS, UNIFORM, Parameter
from standoff.sweep.proof.effort import effort_of
from standoff.sweep.sample_file import SampleFile
from standoff.sweep.samplers import (
    GridSampler,
    LatinHypercubeSampler,
    RandomSampler,
    Sampler,
    SobolSampler,
)
from standoff.sweep.shape_tables import shape_parameter, with_shapes
from standoff.sweep.subject_tables import SUBJECT_KEYS, read_subject
from standoff.sweep.subjects.robot import ONE_NUMBER, RobotSubject
from standoff.sweep.subjects.subject import Subject
from standoff.sweep.subjects.world import SceneWorld
from standoff.whole_files import file_name
from standoff.wording import counted, printable

VERSION = 1
"""The version of the format that this library reads."""

KEYS = ("version", "title", "parameters", "sampler", "keep", "shards", "prove")
KINDS = ("random", "sobol", "latin-hypercube", "grid", "file")
SEEDED = {
    "random": RandomSampler,
    "sobol": SobolSampler,
    "latin-hypercube": LatinHypercubeSampler,
}
DEFAULT_SHARD = 1_000_000
"""Rows of a shard: seconds to minutes of work, which is what a stop can lose."""

MOST_ROWS = 1 << 50
"""Beyond all that is ever computed; row numbers are exact in a double."""

MOST_KEPT = 10_000_000
"""Rows that one list may hold: they are in memory at once."""

MOST_BINS = 1_000_000


def load_job(file: str | os.PathLike[str]) -> Job:
    """Read, check and build a job.

    Raises TypeError if `file` is neither a string nor a path. Raises SceneError if the file or what
    it names is missing or is not TOML, or anything in them is unknown, missing, of the wrong type,
    not finite, or does not go together. The message names the file, the key and the fix.

    Parameters
    ----------
    file : str or path
        A TOML file; the files that it names are relative to its folder.

    Returns
    -------
    Job
    """
    path = file_name(os.fspath(file) if isinstance(file, os.PathLike) else file)
    try:
        top = SceneTable(toml_tables(text_of(path)), file=path)
    except SceneError as error:
        raise error.found_in(path) from error
    version = top.required("version", f"version = {VERSION}")
    if type(version) is not int or version != VERSION:
        raise top.error(f"is {shown(version)}, but this Standoff reads version 1", "version")
    if "bodies" in top:
        raise top.error(
            "this is a scene, and a sweep's job names one: write a job with a line such as: "
            f'scene = "{printable(path.name)}"',
            "bodies",
        )
    top.expect(*KEYS, *SUBJECT_KEYS)
    subject, title = read_subject(top)
    kind, table = _sampler_table(top)
    parameters = read_parameters(top, subject, kind)
    subject = with_shapes(top, subject, parameters, kind)
    source, rows, seed = _source(table, kind, parameters)
    return Job(
        file=path,
        title=top.text("title", title),
        subject=subject,
        parameters=parameters,
        kind=kind,
        seed=seed,
        source=source,
        rows=rows,
        keep=_keep(top, subject.within),
        shard_rows=_shard_rows(top),
        effort=effort_of(top),
    )


def _sampler_table(top: SceneTable) -> tuple[str, SceneTable]:
    table = top.table("sampler")
    kind = table.choice("kind", KINDS)
    keys = {"grid": ("kind",), "file": ("kind", "file", "rows")}
    table.expect(*keys.get(kind, ("kind", "rows", "seed")))
    return kind, table


def _source(
    table: SceneTable, kind: str, parameters: tuple[Parameter, ...]
) -> tuple[Sampler | SampleFile, int, int]:
    if kind == "file":
        file = existing_file(table, "file", 'file = "rows.parquet"')
        columns = [name for p in parameters for name in p.columns]
        read = table.build(lambda: SampleFile(file, columns), "file")
        rows = table.count("rows", read.rows)
        if rows > read.rows:
            raise table.error(f"is {rows}, but the file has {counted(read.rows, 'row')}", "rows")
        return read, rows, 0
    if kind == "grid":
        grid = GridSampler(tuple(p.steps for p in parameters))
        if grid.rows > MOST_ROWS:
            raise table.error(f"the grid has {grid.rows} rows, more than {MOST_ROWS}", "kind")
        return grid, grid.rows, 0
    table.required("rows", "rows = 1_000_000")
    rows = _most(table, "rows", 1, MOST_ROWS)
    seed = table.required("seed", "seed = 1") if "seed" in table else 0
    if type(seed) is not int or not 0 <= seed < 1 << 63:
        raise table.error(f"must be a whole number from 0 on, got {shown(seed)}", "seed")
    width = sum(p.width for p in parameters)
    return table.build(lambda: SEEDED[kind](rows, width, seed), "kind"), rows, seed


def _keep(top: SceneTable, within: float | None) -> Keep:
    if "keep" not in top:
        return Keep()
    table = top.table("keep")
    table.expect("worst", "below", "most_below", "histogram")
    usual = Keep()
    below = table.number("below") if "below" in table else None
    if below is not None and within is not None and below > within:
        raise table.error(f"must not be beyond the horizon 'within', {within:g}", "below")
    if "most_below" in table and below is None:
        raise table.error("goes with 'below', the length; add it, or leave this out", "most_below")
    return Keep(
        worst=_most(table, "worst", usual.worst, MOST_KEPT),
        below=below,
        most_below=_most(table, "most_below", usual.most_below, MOST_KEPT),
        bins=_bins(table.table("histogram")) if "histogram" in table else None,
    )


def _bins(table: SceneTable) -> Bins:
    table.expect("from", "to", "bins")
    low, high = table.number("from"), table.number("to")
    if not low < high:
        raise table.error(f"must be above 'from', {low:g}, got {high:g}", "to")
    table.required("bins", "bins = 100")
    return Bins(low, high, _most(table, "bins", 1, MOST_BINS))


def _shard_rows(top: SceneTable) -> int:
    if "shards" not in top:
        return DEFAULT_SHARD
    table = top.table("shards")
    table.expect("rows")
    return _most(table, "rows", DEFAULT_SHARD, MOST_ROWS)


def _most(table: SceneTable, key: str, default: int, most: int) -> int:
    """A whole number above zero that is not too large."""
    value = table.count(key, default)
    if value > most:
        raise table.error(f"must be {most} or less, got {shown(value)}", key)
    return value


# From ``[parameters.NAME]`` tables to the numbers that change from row to row.


def read_parameters(top: SceneTable, subject: Subject, kind: str) -> tuple[Parameter, ...]:
    """Return a job's parameters.

    Raises SceneError.

    Parameters
    ----------
    top : SceneTable
        The job's, with ``parameters``.
    subject : Subject
    kind : str
        Of the sampler: some have no range, or no rotations.
    """
    tables = top.table("parameters", "[parameters.x]")
    if not tables.names():
        raise top.error("no parameters; add a table such as [parameters.x]", "parameters")
    found: list[Parameter] = []
    for name in tables.names():
        table = tables.table(name)
        if not all(letter.isalnum() or letter in "-_" for letter in name) or not name:
            raise table.error("names columns: give a name of letters, digits, - and _")
        robot = subject if isinstance(subject, RobotSubject) else None
        if "shapes" in table:
            table.expect("shapes", "what", *_range_keys(kind))
            parameter = _ranged(table, shape_parameter(name, table, subject), kind)
        elif robot is None:
            parameter = _of_body(name, table, subject, kind)
        else:
            parameter = _of_joint(name, table, robot, kind)
        if subject.planar and not parameter.shape and parameter.what not in ("x", "y", "turn_z"):
            key = "rotation" if parameter.what == UNIFORM else "what"
            raise table.error("a planar body has 'x', 'y' and 'turn_z' alone", key)
        _check_beside(table, parameter, found)
        found.append(parameter)
    return tuple(found)


def _of_body(name: str, table: SceneTable, subject: Subject, kind: str) -> Parameter:
    rotation = () if kind in ("file", "grid") else ("rotation",)
    if "rotation" in table and not rotation:
        raise table.error(
            f"a uniform rotation does not go with a sampler of kind '{kind}': give "
            "'turn_x', 'turn_y' and 'turn_z'",
            "rotation",
        )
    table.expect("moves", "what", *rotation, *_range_keys(kind))
    moves = table.text("moves", example=f'moves = "{subject.movable[-1]}"')
    if moves not in subject.movable:
        raise table.error(_not_movable(moves, subject), "moves")
    if "rotation" in table:
        table.expect("moves", "rotation")
        table.choice("rotation", (UNIFORM,))
        return Parameter(name, moves, UNIFORM)
    return _ranged(table, Parameter(name, moves, table.choice("what", (*SHIFTS, *TURNS))), kind)


def _not_movable(name: str, subject: Subject) -> str:
    """Why a body cannot be moved."""
    if not isinstance(subject, SceneWorld):
        return unknown_name(name, subject.movable, "body of the pair")
    if name in subject.world.fixed:
        return f"'{name}' is fixed in the scene's [world]: take it out of 'fixed' there"
    return unknown_name(name, subject.movable, "moving body of the world")


def _of_joint(name: str, table: SceneTable, subject: RobotSubject, kind: str) -> Parameter:
    for key in ("moves", "what", "rotation"):
        if key in table:
            raise table.error("is of bodies; a parameter of a robot has 'joint' instead", key)
    table.expect("joint", *_range_keys(kind))
    joint = table.text("joint", example=f'joint = "{subject.movable[0]}"')
    if joint not in subject.movable:
        raise table.error(unknown_name(joint, subject.movable, "joint"), "joint")
    joints, j = subject.robot.joints, subject.movable.index(joint)
    if joints.kinds[j] not in ONE_NUMBER:
        told = JointKind(joints.kinds[j]).name.lower()
        raise table.error(
            f"'{joint}' is a {told} joint: parameters move those that turn about an axis or slide",
            "joint",
        )
    leader = joints.owner(int(joints.q_at[j]))
    if leader != j:
        first = subject.movable[leader]
        raise table.error(f"'{joint}' follows the joint '{first}': move that one", "joint")
    what = SLIDE if joints.kinds[j] in SLIDES else ANGLE
    q = int(joints.q_at[j])
    limits = float(joints.lower[q]), float(joints.upper[q])
    found = _ranged(table, Parameter(name, joint, what), kind, limits)
    if kind != "file":
        for key, end in (("from", found.low), ("to", found.high)):
            table.build(partial(_check_end, subject, found, end), _given(table, key))
    return found


def _check_end(subject: RobotSubject, parameter: Parameter, end: float) -> None:
    q = subject.configurations([parameter], np.array([[end]]))
    check_limits(subject.robot, q, "the end of the range")


def _given(table: SceneTable, key: str) -> str:
    """The key, as the table has it."""
    return f"{key}{ENDING}" if f"{key}{ENDING}" in table else key


def _range_keys(kind: str) -> tuple[str, ...]:
    if kind == "file":
        return ("degrees",)
    return (*with_degrees(("from", "to")), *(("steps",) if kind == "grid" else ()))


def _ranged(
    table: SceneTable,
    parameter: Parameter,
    kind: str,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> Parameter:
    """The parameter with the range that its table gives, or else the limits, rad or length."""
    in_degrees = _in_degrees(table, parameter)
    if kind == "file":
        return replace(parameter, degrees=in_degrees)
    ending = ENDING if in_degrees else ""
    low, high = (
        table.number(f"{key}{ending}", _usual(end, in_degrees))
        for key, end in zip(("from", "to"), limits, strict=True)
    )
    if not low < high:
        raise table.error(f"must be above 'from{ending}', {low:g}, got {high:g}", f"to{ending}")
    count = table.count("steps", 0) if kind == "grid" else 0
    if kind == "grid" and count < 2:
        raise table.error("must be 2 or more: both ends are among the values, got 1", "steps")
    return replace(parameter, low=low, high=high, degrees=in_degrees, steps=count)


def _usual(limit: float, in_degrees: bool) -> float | None:
    """What holds where no end is given: None where there is no limit."""
    if not math.isfinite(limit):
        return None
    return math.degrees(limit) if in_degrees else limit


def _in_degrees(table: SceneTable, parameter: Parameter) -> bool:
    """Are its numbers degrees? Refuses degrees of what is no angle, and both units at once."""
    no_angle = not parameter.unit
    kind = "a length" if parameter.is_length else "a number without a unit"
    told = f"'{parameter.what}' is {kind}"
    if "degrees" in table:
        given = table.true_or_false("degrees")
        if given and no_angle:
            raise table.error(f"{told}; leave it out", "degrees")
        return given
    found = [key for key in with_degrees(("from", "to")) if key in table and ENDING in key]
    if found and no_angle:
        plain = found[0].removesuffix(ENDING)
        raise table.error(f"{told}; write '{plain}'", found[0])
    for key in ("from", "to"):
        table.only_one((key, key + ENDING))
    return bool(found)


def _check_beside(table: SceneTable, new: Parameter, before: list[Parameter]) -> None:
    """Refuse what changes the same as another parameter."""
    for other in before:
        if other.moves != new.moves:
            continue
        if other.what == new.what:
            raise table.error(f"'{other.name}' changes the same of '{new.moves}'; keep one of them")
        turns = {UNIFORM, *TURNS}
        if UNIFORM in (other.what, new.what) and {other.what, new.what} <= turns:
            raise table.error(
                f"'{new.moves}' has a uniform rotation, which no turn changes: keep either "
                f"'{other.name}' or this"
            )
