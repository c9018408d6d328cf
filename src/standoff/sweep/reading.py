"""From a job's file to the job, with the errors of scenes."""

from __future__ import annotations

import os

from standoff.scene import SceneError
from standoff.scene.files import existing_file, text_of, toml_tables
from standoff.scene.reader import Table, shown
from standoff.sweep.job import Job
from standoff.sweep.keep import Bins, Keep
from standoff.sweep.parameter_tables import read_parameters
from standoff.sweep.parameters import Parameter
from standoff.sweep.proof.effort import effort_of
from standoff.sweep.sample_file import SampleFile
from standoff.sweep.samplers import (
    GridSampler,
    LatinHypercubeSampler,
    RandomSampler,
    Sampler,
    SobolSampler,
)
from standoff.sweep.shape_tables import with_shapes
from standoff.sweep.subject_tables import SUBJECT_KEYS, read_subject
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


def _sampler_table(top: Table) -> tuple[str, Table]:
    table = top.table("sampler")
    kind = table.choice("kind", KINDS)
    keys = {"grid": ("kind",), "file": ("kind", "file", "rows")}
    table.expect(*keys.get(kind, ("kind", "rows", "seed")))
    return kind, table


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
