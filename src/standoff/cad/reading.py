"""Reading STEP, BREP and IGES files, and shapes of other libraries on OpenCASCADE."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from hashlib import file_digest
from pathlib import Path
from threading import Timer
from time import perf_counter
from typing import Any, NamedTuple

from standoff.cad import store
from standoff.cad.assembly import Assembly, Part, PartReport
from standoff.cad.files import ENDINGS, check_lines, check_step, existing, stated_accuracy
from standoff.cad.finished import Finished, stored
from standoff.cad.finishing import Watch, finished_solids
from standoff.checks.numbers import magnitude, whole_number
from standoff.checks.real_numbers import shown
from standoff.checks.units import METRES, known_unit
from standoff.errors import CadError, StandoffError, StandoffTypeError
from standoff.kernels.compiler.notices import alive, say
from standoff.wording import counted

MOST_NAMED = 5
FIRST_LINE = 2.0
"""Seconds after which a line says that a file is being read."""


store.code_digest()  # now: later it may be that of sources which this process does not run


class ReadingOptions(NamedTuple):
    """What is asked of reading, checked."""

    unit: str
    heal: bool
    keep: str
    tolerance: float | None
    workers: int
    accuracy: float = 0.0
    """That the file states, length."""

    @property
    def making(self) -> tuple[Any, ...]:
        """What a part follows from beside its shape and its name."""
        return (self.heal, self.accuracy, self.tolerance)


class FileSolids(NamedTuple):
    """What a file holds: its unit; of each instance name, pose, colour and which solid it is; the
    solids; and whether all of it was in the store."""

    file_unit: str
    placed: list[tuple[str, Any, Any, int]]
    solids: list[Finished]
    stored: bool


def read_step(
    path: Any,
    *,
    unit: str = "mm",
    heal: bool = False,
    keep: str = "all",
    tolerance: float | None = None,
    workers: int = 1,
) -> Assembly:
    """The parts of a STEP file, with names, colours and places.

    Parameters
    ----------
    path : str or Path
    unit : "mm", "cm", "m" or "inch"
        Of the lengths that are returned; the file's are converted, which the report tells.
    heal : bool
        Let OpenCASCADE repair shapes that are refused as they are; ``report.healed`` tells what it
        changed.
    keep : "all" or "readable"
        With "all", a part that is refused is an error, and nothing is returned; with "readable" it
        is left out and told in ``refusals``.
    tolerance : float, optional
        By how much faces, edges and vertices may miss each other, in `unit`; by default what the
        file claims: the accuracy that it states, or four times the tolerances of its parts. What
        they miss each other by is measured, told in the report, and subtracted from every lower
        bound.
    workers : int
        Processes that share the making of parts, the same ones in the same order; a program that
        asks for more than one begins with ``if __name__ == "__main__":``.

    Returns
    -------
    Assembly
        Of each part the shape is a `Body` where it is proven convex, else a `Boundary`.

    Raises
    ------
    CadError
        A file that is empty, cut off, damaged, or has more than ``MOST_ENTITIES`` entities; a part
        that is refused: an open shell, faces without area, that cross themselves or each other, or
        have no exact form.
    FileNotFoundError
    ModuleNotFoundError
        If OpenCASCADE is not installed; the message names the extra.
    StandoffError, TypeError
        An unknown unit or option; not a path.
    """
    return _read(existing(path), "step", _checked(unit, heal, keep, tolerance, workers))


def read_iges(
    path: Any,
    *,
    unit: str = "mm",
    heal: bool = False,
    keep: str = "all",
    tolerance: float | None = None,
    workers: int = 1,
) -> Assembly:
    """The solids of an IGES file; its loose faces are sewn only with ``heal=True``.

    Raises CadError, FileNotFoundError, ModuleNotFoundError, StandoffError, TypeError as for
    `read_step`.

    Parameters
    ----------
    path, unit, heal, keep, tolerance, workers : as for `read_step`.

    Returns
    -------
    Assembly
    """
    return _read(existing(path), "iges", _checked(unit, heal, keep, tolerance, workers))


def read_brep(
    path: Any,
    *,
    heal: bool = False,
    keep: str = "all",
    tolerance: float | None = None,
    workers: int = 1,
) -> Assembly:
    """The solids of a BREP file, OpenCASCADE's own, whose lengths have no unit.

    Raises CadError, FileNotFoundError, ModuleNotFoundError, StandoffError, TypeError as for
    `read_step`.

    Parameters
    ----------
    path, heal, keep, tolerance, workers : as for `read_step`.

    Returns
    -------
    Assembly
        Its unit is empty: lengths are as in the file.
    """
    return _read(existing(path), "brep", _checked("", heal, keep, tolerance, workers))


def read_cad(
    path: Any,
    *,
    unit: str = "mm",
    heal: bool = False,
    keep: str = "all",
    tolerance: float | None = None,
    workers: int = 1,
) -> Assembly:
    """A file of any of these kinds, by its ending.

    Raises CadError, FileNotFoundError, ModuleNotFoundError, StandoffError, TypeError as for
    `read_step`, and for another ending.

    Parameters
    ----------
    path, unit, heal, keep, tolerance, workers : as for `read_step`; a BREP file's lengths stay as
        they are.

    Returns
    -------
    Assembly
    """
    file = existing(path)
    kind = ENDINGS.get(file.suffix.lower())
    if kind is None:
        raise CadError(f"{file}: give a file that ends in {', '.join(ENDINGS)}.", "path", path)
    lengths = "" if kind == "brep" else unit
    return _read(file, kind, _checked(lengths, heal, keep, tolerance, workers))


def from_shape(
    shape: Any,
    *,
    name: str = "part",
    heal: bool = False,
    keep: str = "all",
    tolerance: float | None = None,
    workers: int = 1,
) -> Assembly:
    """The solids of a shape of OpenCASCADE, or of an object that wraps one.

    Raises CadError, ModuleNotFoundError, StandoffError, TypeError as for `read_step`; not such an
    object.

    Parameters
    ----------
    shape : TopoDS_Shape, or an object of build123d or CadQuery
        Its attribute ``wrapped`` is taken; of a CadQuery workplane, ``val()``.
    name : str
    heal, keep, tolerance, workers : as for `read_step`.

    Returns
    -------
    Assembly
        Lengths are as in the shape; those libraries think in millimetres.
    """
    options = _checked("", heal, keep, tolerance, workers)
    from standoff.cad.instances import shape_instances

    given = shape.val() if hasattr(shape, "val") and not hasattr(shape, "wrapped") else shape
    given = getattr(given, "wrapped", given)
    if not hasattr(given, "ShapeType"):
        raise StandoffTypeError(
            f"shape = {shown(shape)}: give a TopoDS_Shape, or an object with one as .wrapped.",
            "shape",
            shape,
        )
    with _watched(name) as watch:
        instances = _numbered(shape_instances(given, name))
        return _assembly(_made(instances, "", options, watch), options, watch)


def _checked(
    unit: str, heal: bool, keep: str, tolerance: float | None, workers: int
) -> ReadingOptions:
    if unit:
        known_unit(unit)
    if not isinstance(heal, bool):
        raise StandoffTypeError(f"heal = {shown(heal)}: give True or False.", "heal", heal)
    if keep not in ("all", "readable"):
        raise StandoffError(f"keep = {shown(keep)}: give 'all' or 'readable'.", "keep", keep)
    allowed = None if tolerance is None else magnitude(tolerance, "tolerance")
    return ReadingOptions(unit, heal, keep, allowed, whole_number(workers, "workers"))


def _numbered(instances: Sequence[Any]) -> list[Any]:
    """The same, each of several of a name but the first with its number."""
    times: Counter[str] = Counter()
    taken = {instance.name for instance in instances}
    found = []
    for instance in instances:
        times[instance.name] += 1
        name = instance.name
        while times[instance.name] > 1 and name in taken:
            name = f"{instance.name} ({times[instance.name]})"
            times[instance.name] += name in taken
        taken.add(name)
        found.append(replace(instance, name=name))
    return found


@contextmanager
def _watched(source: str) -> Iterator[Watch]:
    watch = Watch(source, perf_counter())
    first = Timer(FIRST_LINE, lambda: say(watch.line()))
    first.daemon = True
    with alive(watch.line):
        first.start()
        try:
            yield watch
        finally:
            first.cancel()


def _read(file: Path, kind: str, options: ReadingOptions) -> Assembly:
    with _watched(file.name) as watch:
        return _assembly(_solids_of(file, kind, options, watch), options, watch)


def _solids_of(file: Path, kind: str, options: ReadingOptions, watch: Watch) -> FileSolids:
    """What the store has of a file of these bytes, or else what is made of it."""
    key = _key(file, kind, options)
    found = _stored(key)
    if found is not None:
        return found
    instances, file_unit = _instances(file, kind, options.unit)
    if _key(file, kind, options) != key:
        raise CadError(f"{file} changed while it was read: read it again.")
    if kind == "step":
        options = options._replace(accuracy=stated_accuracy(file) / METRES[options.unit])
    return _made(_numbered(instances), file_unit, options, watch, key)


def _key(file: Path, kind: str, options: ReadingOptions) -> str:
    named = file.stem if kind == "brep" else ""  # its part has the file's name
    with file.open("rb") as stream:
        content = file_digest(stream, "sha256").digest()
    return store.key_of(content, kind, named, options.unit, options.making)


def _stored(key: str) -> FileSolids | None:
    content = store.taken(key)
    if content is None:
        return None
    file_unit, placed, keys = pickle.loads(content)
    solids = [one for key in keys if (one := stored(key)) is not None]
    return FileSolids(file_unit, placed, solids, True) if len(solids) == len(keys) else None


def _instances(file: Path, kind: str, unit: str) -> tuple[list[Any], str]:
    """The instances of a file, and its unit."""
    if kind == "step":
        check_step(file)
        from standoff.cad.instances import step_instances

        return step_instances(file, unit)
    check_lines(file, kind.upper(), b"CASCADE Topology" if kind == "brep" else None)
    from standoff.cad.instances import brep_instances, iges_instances

    return iges_instances(file, unit) if kind == "iges" else (brep_instances(file), "")


def _made(
    instances: Sequence[Any], file_unit: str, options: ReadingOptions, watch: Watch, key: str = ""
) -> FileSolids:
    """Make each solid once; `key` is the file's in the store."""
    solids, keys, numbers = finished_solids(instances, options.making, options.workers, watch)
    placed = [(i.name, i.pose, i.colour, k) for i, k in zip(instances, numbers, strict=True)]
    if key and solids:
        store.put(key, pickle.dumps((file_unit, placed, keys)))
    store.trim()
    return FileSolids(file_unit, placed, solids, False)


def _assembly(read: FileSolids, options: ReadingOptions, watch: Watch) -> Assembly:
    """Raise if a part is refused, unless only the readable ones are wanted."""
    source = watch.source
    if not read.placed:
        raise CadError(f"{source} has no solid.")
    parts, refusals, empty = [], [], []
    for name, pose, colour, number in read.placed:
        made = read.solids[number]
        if not made.report.faces:
            empty.append(f"{name}: left out, it has no face")
        elif made.refused:
            refusals.append(f"{name}: {made.report.refused}")
        else:
            parts.append(Part(name, pose, colour, made.report, made))
    if not parts and not refusals:
        raise CadError(f"{source} has no solid with faces.")
    if refusals and (options.keep == "all" or not parts):
        more = f"; and {len(refusals) - MOST_NAMED} more" if len(refusals) > MOST_NAMED else ""
        raise CadError(
            f"{source}: {len(refusals)} of {counted(len(read.placed), 'part')} refused. "
            + "; ".join(refusals[:MOST_NAMED])
            + more,
            refusals=tuple(refusals),
        )
    left_out, spent = (*refusals, *empty), perf_counter() - watch.began
    units = options.unit, read.file_unit
    return Assembly(tuple(parts), *units, source, left_out, spent, read.stored)


def common_volumes(
    path: Any, pairs: Sequence[tuple[str, str]], *, unit: str = "mm"
) -> dict[tuple[str, str], float | None]:
    """The volumes that parts of a file have in common where they are, by OpenCASCADE's boolean
    operations on the file's own shapes: nothing is proven of them.

    Raises CadError, FileNotFoundError, ModuleNotFoundError as for `read_cad`; a name that no part
    has.

    Parameters
    ----------
    path, unit : as for `read_cad`.
    pairs : sequence of (str, str)
        Names of parts.

    Returns
    -------
    dict of (str, str) to float or None
        [length³]; None where the operation fails.
    """
    file = existing(path)
    if not pairs:
        return {}
    from standoff.cad.instances import at_place
    from standoff.cad.measures import common_volume

    instances, _ = _instances(file, ENDINGS[file.suffix.lower()], unit)
    named = {each.name: each for each in _numbered(instances)}
    for name in {name for pair in pairs for name in pair} - set(named):
        raise CadError(f"{file} has no part {shown(name)}.", "pairs", name)
    return {(a, b): common_volume(at_place(named[a]), at_place(named[b])) for a, b in pairs}


def reports_of(
    path: Any, *, heal: bool = False, tolerance: float | None = None
) -> tuple[PartReport, ...]:
    """What is found about every different solid of a file, refused ones included.

    Raises CadError, FileNotFoundError, ModuleNotFoundError, TypeError as for `read_step`, but for
    parts that are refused.

    Parameters
    ----------
    path : str or Path
    heal : bool
    tolerance : float, optional
        As for `read_step`.

    Returns
    -------
    tuple of PartReport
    """
    file = existing(path)
    kind = ENDINGS.get(file.suffix.lower(), "brep")
    options = _checked("" if kind == "brep" else "mm", heal, "all", tolerance, 1)
    with _watched(file.name) as watch:
        return tuple(one.report for one in _solids_of(file, kind, options, watch).solids)
