"""From a job's file to the job, with the errors of scenes."""

from __future__ import annotations

import os
from typing import Any

from standoff.scene import Scene, SceneError, load_scene
from standoff.scene.degrees import ENDING, with_degrees
from standoff.scene.files import existing_file, text_of, toml_tables
from standoff.scene.reader import Table, shown, unknown_name
from standoff.sweep.job import Bins, Job, Keep
from standoff.sweep.parameters import SHIFTS, TURNS, UNIFORM, Parameter
from standoff.sweep.proof.effort import effort_of
from standoff.sweep.sample_file import SampleFile
from standoff.sweep.samplers import (
    GridSampler,
    LatinHypercubeSampler,
    RandomSampler,
    Sampler,
    SobolSampler,
)
from standoff.sweep.subjects.pair import ConvexPair
from standoff.tracking.inputs import check_pair
from standoff.whole_files import file_name
from standoff.wording import counted, printable

VERSION = 1
"""The version of the format that this library reads."""

KEYS = (
    *("version", "title", "scene", "pair", "within"),
    *("parameters", "sampler", "keep", "shards", "prove"),
)
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

    Parameters
    ----------
    file : str or path
        A TOML file; the files that it names are relative to its folder.

    Returns
    -------
    Job

    Raises
    ------
    TypeError
        If `file` is neither a string nor a path.
    SceneError
        If the file or its scene is missing or is not TOML, or anything in them is unknown,
        missing, of the wrong type, not finite, or does not go together. The message names the
        file, the key and the fix.
    """
    path = file_name(os.fspath(file) if isinstance(file, os.PathLike) else file)
    try:
        top = Table(toml_tables(text_of(path)), file=path)
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
    top.expect(*KEYS)
    scene = _scene(top)
    kind, table = _sampler_table(top)
    parameters = _parameters(top, scene, kind)
    source, rows, seed = _source(table, kind, parameters)
    within = top.positive("within") if "within" in top else None
    return Job(
        file=path,
        title=top.text("title", scene.title),
        subject=ConvexPair(scene, scene.pair_bodies, _homes(scene), within),
        parameters=parameters,
        kind=kind,
        seed=seed,
        source=source,
        rows=rows,
        keep=_keep(top, within),
        shard_rows=_shard_rows(top),
        effort=effort_of(top),
    )


def _scene(top: Table) -> Scene:
    scene = _seen(top, load_scene(existing_file(top, "scene", 'scene = "scene.toml"')))
    top.build(lambda: check_pair(*scene.pair_bodies), "scene")
    return scene


def _seen(top: Table, scene: Scene) -> Scene:
    """The scene through the pair that is named, or its only one."""
    if "pair" in top:
        name = top.choice("pair", [pair.name for pair in scene.pairs])
        return scene.select(name)
    if len(scene.pairs) > 1:
        raise top.error(
            f"the scene has {len(scene.pairs)} pairs: add a line such as: "
            f'pair = "{scene.pairs[0].name}"',
            "pair",
        )
    return scene


def _homes(scene: Scene) -> Any:
    start = scene.instant()
    return tuple(motion.path.pose(start) for motion in scene.pair_motions)


def _sampler_table(top: Table) -> tuple[str, Table]:
    table = top.table("sampler")
    kind = table.choice("kind", KINDS)
    keys = {"grid": ("kind",), "file": ("kind", "file", "rows")}
    table.expect(*keys.get(kind, ("kind", "rows", "seed")))
    return kind, table


def _parameters(top: Table, scene: Scene, kind: str) -> tuple[Parameter, ...]:
    tables = top.table("parameters", "[parameters.x]")
    if not tables.names():
        raise top.error("no parameters; add a table such as [parameters.x]", "parameters")
    planar = any(body.dimension == 2 for body in scene.pair_bodies)
    found: list[Parameter] = []
    for name in tables.names():
        table = tables.table(name)
        if not all(letter.isalnum() or letter in "-_" for letter in name) or not name:
            raise table.error("names columns: give a name of letters, digits, - and _")
        parameter = _parameter(name, table, scene, kind)
        if planar and parameter.what not in ("x", "y", "turn_z"):
            key = "rotation" if parameter.what == UNIFORM else "what"
            raise table.error("a planar body has 'x', 'y' and 'turn_z' alone", key)
        _check_beside(table, parameter, found)
        found.append(parameter)
    return tuple(found)


def _parameter(name: str, table: Table, scene: Scene, kind: str) -> Parameter:
    ends = () if kind == "file" else with_degrees(("from", "to"))
    steps = ("steps",) if kind == "grid" else ()
    rotation = () if kind in ("file", "grid") else ("rotation",)
    if "rotation" in table and not rotation:
        raise table.error(
            f"a uniform rotation does not go with a sampler of kind '{kind}': give "
            "'turn_x', 'turn_y' and 'turn_z'",
            "rotation",
        )
    degrees = ("degrees",) if kind == "file" else ()
    table.expect("moves", "what", *rotation, *ends, *steps, *degrees)
    moves = table.text("moves", example=f'moves = "{scene.pair[1]}"')
    if moves not in scene.pair:
        raise table.error(unknown_name(moves, scene.pair, "body of the pair"), "moves")
    if "rotation" in table:
        table.expect("moves", "rotation")
        table.choice("rotation", (UNIFORM,))
        return Parameter(name, moves, UNIFORM)
    what = table.choice("what", (*SHIFTS, *TURNS))
    in_degrees = _in_degrees(table, what)
    if kind == "file":
        return Parameter(name, moves, what, degrees=in_degrees)
    ending = ENDING if in_degrees else ""
    low, high = (table.number(f"{key}{ending}") for key in ("from", "to"))
    if not low < high:
        raise table.error(f"must be above 'from{ending}', {low:g}, got {high:g}", f"to{ending}")
    count = table.count("steps", 0) if kind == "grid" else 0
    if kind == "grid" and count < 2:
        raise table.error("must be 2 or more: both ends are among the values, got 1", "steps")
    return Parameter(name, moves, what, low, high, in_degrees, count)


def _in_degrees(table: Table, what: str) -> bool:
    """Are its numbers degrees? Refuses degrees of lengths, and both units at once."""
    if "degrees" in table:
        given = table.true_or_false("degrees")
        if given and what in SHIFTS:
            raise table.error(f"'{what}' is a length; leave it out", "degrees")
        return given
    found = [key for key in with_degrees(("from", "to")) if key in table and ENDING in key]
    if found and what in SHIFTS:
        plain = found[0].removesuffix(ENDING)
        raise table.error(f"'{what}' is a length; write '{plain}'", found[0])
    for key in ("from", "to"):
        table.only_one((key, key + ENDING))
    return bool(found)


def _check_beside(table: Table, new: Parameter, before: list[Parameter]) -> None:
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


def _source(
    table: Table, kind: str, parameters: tuple[Parameter, ...]
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


def _keep(top: Table, within: float | None) -> Keep:
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


def _bins(table: Table) -> Bins:
    table.expect("from", "to", "bins")
    low, high = table.number("from"), table.number("to")
    if not low < high:
        raise table.error(f"must be above 'from', {low:g}, got {high:g}", "to")
    table.required("bins", "bins = 100")
    return Bins(low, high, _most(table, "bins", 1, MOST_BINS))


def _shard_rows(top: Table) -> int:
    if "shards" not in top:
        return DEFAULT_SHARD
    table = top.table("shards")
    table.expect("rows")
    return _most(table, "rows", DEFAULT_SHARD, MOST_ROWS)


def _most(table: Table, key: str, default: int, most: int) -> int:
    """A whole number above zero that is not too large."""
    value = table.count(key, default)
    if value > most:
        raise table.error(f"must be {most} or less, got {shown(value)}", key)
    return value
