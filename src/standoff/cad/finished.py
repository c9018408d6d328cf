"""Solids of a file, each made once, by this process or others, or taken from the store."""

from __future__ import annotations

import io
import pickle
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from standoff.cad import store
from standoff.worker_processes import result_of, worker_processes

if TYPE_CHECKING:
    from standoff.bodies.body import Body
    from standoff.bodies.boundary import Boundary
    from standoff.cad.assembly import PartReport
    from standoff.cad.instances import Instance
    from standoff.cad.making import Made
    from standoff.solids import Solid


class Finished:
    """A solid of a file, as its instances share it; of one of the store the shape is unpickled
    when it is first asked for.

    Attributes
    ----------
    report : PartReport
    refused : bool
        Is there no shape?
    """

    def __init__(self, report: PartReport, refused: bool, stored: bytes) -> None:
        self.report, self.refused = report, refused
        self._stored = stored

    @staticmethod
    def of(made: Made) -> Finished:
        """What was made in this process."""
        found = Finished(made.report, made.shape is None, b"")
        found.__dict__["_made"] = made.shape, made.solid
        return found

    @staticmethod
    def unpacked(content: bytes) -> Finished:
        """What `packed` wrote."""
        return Finished(*pickle.loads(content))

    @cached_property
    def _made(self) -> tuple[Boundary | Body | None, Solid | None]:
        made: tuple[Boundary | Body | None, Solid | None] = pickle.loads(self._stored)
        self._stored = b""
        return made

    @property
    def shape(self) -> Boundary | Body:
        """Of one that is not refused."""
        shape = self._made[0]
        assert shape is not None
        return shape

    @cached_property
    def solid(self) -> Solid:
        """The shape as a `Solid`."""
        from standoff.solids import Solid

        return Solid(self.shape) if self._made[1] is None else self._made[1]


def packed(made: Made) -> bytes:
    """What the store keeps: the report can be read without the shape."""
    shapes = pickle.dumps((made.shape, made.solid))
    return pickle.dumps((made.report, made.shape is None, shapes))


@dataclass
class Watch:
    """How far reading has come, for whoever waits."""

    source: str
    began: float
    parts: int = 0
    done: int = 0
    share: float = 0.0
    making: float = 0.0

    def line(self) -> str:
        """What is being done."""
        now = time.perf_counter()
        told = f"reading {self.source}: "
        if self.parts:
            told += f"{self.done} of {self.parts} parts made, "
        told += f"{now - self.began:.0f} s so far"
        if 0.0 < self.share < 1.0:
            told += f", about {(now - self.making) * (1.0 / self.share - 1.0):.0f} s left"
        return f"{told} ..."


class _Solid(NamedTuple):
    """A solid in OpenCASCADE's own bytes, which are the same for all of its instances."""

    written: bytes
    name: str
    shape: Any


def finished_solids(
    instances: Sequence[Instance], given: tuple[Any, ...], workers: int, watch: Watch
) -> tuple[list[Finished], list[str], list[int]]:
    """Of the different solids of some instances what was made, and their names in the store; and of
    each instance which solid it is. `given` is what `made_part` is given beside shape and name."""
    solids, numbers = _different(instances)
    keys = [store.key_of(one.written, "solid", one.name, given) for one in solids]
    kept = [store.taken(key) for key in keys]
    found = [None if content is None else Finished.unpacked(content) for content in kept]
    missing = [k for k, one in enumerate(found) if one is None]
    sizes = {k: len(solids[k].written) for k in missing}
    watch.parts, watch.making, spent = len(missing), time.perf_counter(), 0
    for k, content, made in _made([(k, solids[k]) for k in missing], given, workers):
        found[k] = made
        store.put(keys[k], content)
        spent += sizes[k]
        watch.done, watch.share = watch.done + 1, spent / sum(sizes.values())
    return [one for one in found if one is not None], keys, numbers


def _different(instances: Sequence[Instance]) -> tuple[list[_Solid], list[int]]:
    from OCP.BinTools import BinTools, BinTools_FormatVersion_CURRENT

    solids: list[_Solid] = []
    known: dict[bytes, int] = {}
    numbers: list[int] = []
    seen: list[tuple[Any, int]] = []
    for one in instances:
        number = next((k for shape, k in seen if shape.IsPartner(one.shape)), None)
        if number is None:
            stream = io.BytesIO()
            BinTools.Write_s(one.shape, stream, False, False, BinTools_FormatVersion_CURRENT)
            written = stream.getvalue()
            number = known.setdefault(written, len(solids))
            if number == len(solids):
                solids.append(_Solid(written, one.name, one.shape))
            seen.append((one.shape, number))
        numbers.append(number)
    return solids, numbers


def _made(
    missing: Sequence[tuple[int, _Solid]], given: tuple[Any, ...], workers: int
) -> Iterator[tuple[int, bytes, Finished]]:
    """Number, bytes for the store, and what was made, in any order."""
    from standoff.cad.making import made_part

    # the first one here, so that one process compiles what is not compiled yet
    here = missing if workers == 1 else missing[:1]
    for k, solid in here:
        made = made_part(solid.shape, solid.name, *given)
        yield k, packed(made), Finished.of(made)
    there = missing[len(here) :]
    if not there:
        return
    with worker_processes(min(workers, len(there))) as pool:
        running = {pool.submit(_work, one.written, one.name, given): k for k, one in there}
        while running:
            for each in wait(running, return_when=FIRST_COMPLETED).done:
                content = result_of(each)
                yield running.pop(each), content, Finished.unpacked(content)


def _work(written: bytes, name: str, given: tuple[Any, ...]) -> bytes:
    """Make a solid in another process."""
    from OCP.BinTools import BinTools
    from OCP.TopoDS import TopoDS_Shape

    from standoff.cad.instances import as_its_kind
    from standoff.cad.making import made_part

    shape = TopoDS_Shape()
    BinTools.Read_s(shape, io.BytesIO(written))
    return packed(made_part(as_its_kind(shape), name, *given))
