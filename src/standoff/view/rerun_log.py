"""A recorded run as a file for the viewer of rerun (rerun.io)."""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from standoff.bodies.features import Feature
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, of_extra
from standoff.recording import Recording
from standoff.view.nodes import COLOURS, EDGE_COLOUR, WITNESS_COLOUR, Colour
from standoff.view.shapes import ShownShape, ShownTriangles, shape_of
from standoff.view.shown import of_frame, what_moved
from standoff.view.tolerances import MOST_LOGGED
from standoff.whole_files import file_name, write_whole

with of_extra("rerun-sdk", "rerun"):
    import rerun

CLOCK = "time"
"""Timeline of the motion, s."""


def save_rerun(recording: Recording, path: str | Path) -> None:
    """Write a run for the viewer of rerun: bodies, active features, witness points, and curves.

    The timeline ``time`` has ``/A`` and ``/B`` with their active features, the witness points and
    the line between them, ``/distance`` and ``/lower_bound``, and every switch as a line of text.
    Of a run of more than 2000 frames, 2000 are written, evenly chosen.

    Raises ModuleNotFoundError if rerun-sdk is not installed; the message names the extra. Raises
    TypeError if `path` is neither a string nor a Path. Raises ValueError if the file has another
    ending, or the recording was opened from a file or copied. Raises OSError if the file cannot be
    written.

    Parameters
    ----------
    recording : Recording
        As `so.track` returned it: one from a file does not hold what moved.
    path : str or path
        An .rrd file, written whole or not at all.
    """
    target = file_name(path)
    if target.suffix.lower() != ".rrd":
        raise StandoffError(
            f"{target}: the ending {shown(target.suffix)} is not known here; name an .rrd file",
            "path",
            path,
        )
    what_moved(recording)
    write_whole({target: lambda file: write_rerun(recording, file)})


def write_rerun(recording: Recording, file: BinaryIO) -> None:
    """Write a run for rerun to a stream; `save_rerun` describes it."""
    pair, _ = what_moved(recording)
    shapes = shape_of(pair[0]), shape_of(pair[1])
    log = rerun.RecordingStream("standoff")
    stream = log.binary_stream()
    for number, (which, shape) in enumerate(zip("AB", shapes, strict=True)):
        _log_body(log, which, shape, COLOURS[number][0])
    count = min(len(recording), MOST_LOGGED)
    frames = np.unique(np.linspace(0, len(recording) - 1, count).round().astype(int)).tolist()
    before: list[Any] = [None, None]
    for frame in frames:
        _log_frame(log, recording, frame, shapes, before)
    for event in recording.events:
        log.set_time(CLOCK, duration=float(event.time))
        log.log("switches", rerun.TextLog(f"{event.body}: {event.source} to {event.target}"))
    content = stream.read()
    if content is None:
        raise OSError("rerun did not hand out what was logged")
    file.write(content)


def _log_body(log: Any, which: str, shape: ShownShape, colour: Colour) -> None:
    if shape.skin is not None:
        mesh = rerun.Mesh3D(
            vertex_positions=shape.skin.points,
            triangle_indices=shape.skin.triangles,
            vertex_normals=_normals(shape.skin),
            albedo_factor=colour,
        )
        log.log(f"{which}/skin", mesh, static=True)
    segments = shape.segments()
    if len(segments):
        log.log(f"{which}/edges", rerun.LineStrips3D(segments, colors=EDGE_COLOUR), static=True)


def _log_frame(
    log: Any,
    recording: Recording,
    frame: int,
    shapes: tuple[ShownShape, ShownShape],
    before: list[Any],
) -> None:
    now = of_frame(recording, frame)
    log.set_time(CLOCK, duration=float(recording.time[frame]))
    for number, (which, shape) in enumerate(zip("AB", shapes, strict=True)):
        pose = now.poses[number]
        at = rerun.Transform3D(translation=pose.translation, mat3x3=pose.rotation)
        log.log(which, at)
        if before[number] != now.features[number]:
            before[number] = now.features[number]
            log.log(f"{which}/active", rerun.Clear(recursive=True))
            if now.features[number].kind:
                active = _active(shape, now.features[number], COLOURS[number][1])
                log.log(f"{which}/active/{now.features[number].kind}", active)
    if np.isfinite(now.distance):
        log.log("distance", rerun.Scalars(now.distance))
    if np.isfinite(now.lower_bound):
        log.log("lower_bound", rerun.Scalars(now.lower_bound))
    line = np.array(now.points)
    if np.isfinite(line).all():
        log.log("witness/points", rerun.Points3D(line, colors=WITNESS_COLOUR))
        log.log("witness/line", rerun.LineStrips3D([line], colors=WITNESS_COLOUR))
    else:
        log.log("witness", rerun.Clear(recursive=True))


def _active(shape: ShownShape, feature: Feature, colour: Colour) -> Any:
    found = shape.of(feature)
    if isinstance(found, ShownTriangles):
        return rerun.Mesh3D(
            vertex_positions=found.points,
            triangle_indices=found.triangles,
            vertex_normals=_normals(found),
            albedo_factor=colour,
        )
    if found.ndim == 1:
        return rerun.Points3D([found], colors=colour)
    return rerun.LineStrips3D(found, colors=colour)


def _normals(mesh: ShownTriangles) -> Any:
    """Of each point, the sum of its triangles' normals."""
    corners = mesh.points[mesh.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(mesh.points)
    for k in range(3):
        np.add.at(normals, mesh.triangles[:, k], across)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.maximum(lengths, np.finfo(float).tiny)
