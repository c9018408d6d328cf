"""The solids of a file, each made once, by this process or by others."""

from __future__ import annotations

import io
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass
from typing import Any, NamedTuple

from standoff.cad import store
from standoff.cad.finished import Finished, FinishedArrays, keep, packed, stored
from standoff.wording import counted
from standoff.worker_processes import result_of, worker_processes

Both = tuple[Any, Any]
"""A shape, and the solid of one that is not convex."""


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
            told += f"{self.done} of {counted(self.parts, 'part')} made, "
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
    instances: Sequence[Any], given: tuple[Any, ...], workers: int, watch: Watch
) -> tuple[list[Finished], list[str], list[int]]:
    """Of the different solids of some instances what was made, and their names in the store; and of
    each instance which solid it is. `given` is what `made_part` is given beside shape and name."""
    solids, numbers = _different(instances)
    keys = [store.key_of(one.written, "solid", one.name, given) for one in solids]
    found = [stored(key) for key in keys]
    missing = [k for k, one in enumerate(found) if one is None]
    sizes = {k: len(solids[k].written) for k in missing}
    watch.parts, watch.making, spent = len(missing), time.perf_counter(), 0
    for k, each, made in _made([(k, solids[k]) for k in missing], given, workers):
        found[k] = Finished(each, keys[k], made)
        keep(each, keys[k])
        spent += sizes[k]
        watch.done, watch.share = watch.done + 1, spent / sum(sizes.values())
    return [one for one in found if one is not None], keys, numbers


def _different(instances: Sequence[Any]) -> tuple[list[_Solid], list[int]]:
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
) -> Iterator[tuple[int, FinishedArrays, Both | None]]:
    """Number, what was made packed, and itself where this process made it, in any order."""
    from standoff.cad.making import made_part

    # the first one here, so that one process compiles what is not compiled yet
    here = missing if workers == 1 else missing[:1]
    for k, solid in here:
        made = made_part(solid.shape, solid.name, *given)
        yield k, packed(made.report, made.shape, made.solid), (made.shape, made.solid)
    there = missing[len(here) :]
    if not there:
        return
    with worker_processes(min(workers, len(there))) as pool:
        running = {pool.submit(_work, one.written, one.name, given): k for k, one in there}
        while running:
            for each in wait(running, return_when=FIRST_COMPLETED).done:
                yield running.pop(each), result_of(each), None


def _work(written: bytes, name: str, given: tuple[Any, ...]) -> FinishedArrays:
    """Make a solid in another process."""
    from OCP.BinTools import BinTools
    from OCP.TopoDS import TopoDS_Shape

    from standoff.cad.instances import as_its_kind
    from standoff.cad.making import made_part

    shape = TopoDS_Shape()
    BinTools.Read_s(shape, io.BytesIO(written))
    made = made_part(as_its_kind(shape), name, *given)
    return packed(made.report, made.shape, made.solid)
