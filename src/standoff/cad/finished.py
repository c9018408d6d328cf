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


class _Writer(pickle.Pickler):
    """Of a solid, without the shape that it is of."""

    def __init__(self, stream: io.BytesIO, shape: Any) -> None:
        super().__init__(stream)
        self.shape = shape

    def persistent_id(self, part: Any) -> str | None:
        """A name in the shape's place."""
        return "shape" if part is self.shape else None


class _Reader(pickle.Unpickler):
    """Of what `_Writer` wrote, for the same shape."""

    def __init__(self, content: bytes, shape: Any) -> None:
        super().__init__(io.BytesIO(content))
        self.shape = shape

    def persistent_load(self, name: str) -> Any:
        """The shape."""
        return self.shape


def _solid_written(solid: Solid) -> bytes:
    stream = io.BytesIO()
    _Writer(stream, solid.given).dump(solid)
    return stream.getvalue()


class Packed(NamedTuple):
    """What was made, as it goes to the store, and from one process to another."""

    report: PartReport
    refused: bool
    shape: bytes
    solid: bytes | None

    @staticmethod
    def of(made: Made) -> Packed:
        """The solid is None where the part is convex, or refused."""
        solid = None if made.solid is None else _solid_written(made.solid)
        return Packed(made.report, made.shape is None, pickle.dumps(made.shape), solid)


class Finished:
    """A solid of a file, as its instances share it; shape and solid are unpickled when they are
    first asked for.

    Attributes
    ----------
    report : PartReport
    refused : bool
        Is there no shape?
    """

    def __init__(self, packed: Packed, key: str, made: Made | None = None) -> None:
        self.report, self.refused, self._shape, self._solid = packed
        self._key = f"{key}-solid"
        if made is not None:  # by this process
            self.__dict__["_both"] = made.shape, made.solid

    @property
    def shape(self) -> Boundary | Body:
        """Of one that is not refused."""
        return self._both[0]

    @cached_property
    def solid(self) -> Solid:
        """The shape as a `Solid`; the store has that of a convex one once it was asked for."""
        return self._both[1] or self._solid_of(self.shape)

    @cached_property
    def _both(self) -> tuple[Boundary | Body, Solid | None]:
        """The shape, and the solid where it is not convex."""
        shape: Boundary | Body = pickle.loads(self._shape)
        return shape, None if self.report.convex else self._solid_of(shape)

    def _solid_of(self, shape: Boundary | Body) -> Solid:
        from standoff.solids.spatial.solid import solid_of

        content = self._solid or store.taken(self._key)
        if content is not None:
            found: Solid = _Reader(content, shape).load()
            return found
        made = solid_of(shape)
        store.put(self._key, _solid_written(made))
        store.trim()
        return made


def stored(key: str) -> Finished | None:
    """What the store has of a solid."""
    content = store.taken(key)
    if content is None:
        return None
    report, refused, shape = pickle.loads(content)
    return Finished(Packed(report, refused, shape, None), key)


def _keep(packed: Packed, key: str) -> None:
    store.put(key, pickle.dumps(packed[:3]))
    if packed.solid is not None:
        store.put(f"{key}-solid", packed.solid)


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
    found = [stored(key) for key in keys]
    missing = [k for k, one in enumerate(found) if one is None]
    sizes = {k: len(solids[k].written) for k in missing}
    watch.parts, watch.making, spent = len(missing), time.perf_counter(), 0
    for k, packed, made in _made([(k, solids[k]) for k in missing], given, workers):
        found[k] = Finished(packed, keys[k], made)
        _keep(packed, keys[k])
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
) -> Iterator[tuple[int, Packed, Made | None]]:
    """Number, what was made packed, and itself where this process made it, in any order."""
    from standoff.cad.making import made_part

    # the first one here, so that one process compiles what is not compiled yet
    here = missing if workers == 1 else missing[:1]
    for k, solid in here:
        made = made_part(solid.shape, solid.name, *given)
        yield k, Packed.of(made), made
    there = missing[len(here) :]
    if not there:
        return
    with worker_processes(min(workers, len(there))) as pool:
        running = {pool.submit(_work, one.written, one.name, given): k for k, one in there}
        while running:
            for each in wait(running, return_when=FIRST_COMPLETED).done:
                yield running.pop(each), result_of(each), None


def _work(written: bytes, name: str, given: tuple[Any, ...]) -> Packed:
    """Make a solid in another process."""
    from OCP.BinTools import BinTools
    from OCP.TopoDS import TopoDS_Shape

    from standoff.cad.instances import as_its_kind
    from standoff.cad.making import made_part

    shape = TopoDS_Shape()
    BinTools.Read_s(shape, io.BytesIO(written))
    return Packed.of(made_part(as_its_kind(shape), name, *given))
