"""A figure's files: its picture as PNG and SVG, its data as Parquet, its animation as WebP."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import ArrayLike
from PIL import Image

from standoff import __version__
from standoff.whole_files import Writer
from standoff_studies.paper import style
from standoff_studies.paper.figure import Animation, Artwork, Entry

PICTURES = (".png", ".svg")
ANIMATION = ".webp"
"""Animated WebP: every browser since 2020 shows it, in true colours at a third of a GIF's size."""

MOST_PIXELS = 900
"""Longest side of an animation's frame in pixels: more would not be visible in a report."""

ENCODING = 1
"""Effort of the encoder, 0 to 6: files as small as with 4, in two fifths of the time; with 0 they
are four times as large."""

METADATA = b"standoff"
"""Key of a table's metadata that contains the JSON text."""
FORMAT = "standoff-paper-table"


def stem(entry: Entry) -> str:
    """Return the beginning of the names of a figure's files: "figure-07", "voronoi"."""
    return f"figure-{int(entry.key):02d}" if entry.key.isdecimal() else entry.key


def table_bytes(entry: Entry, name: str, columns: Mapping[str, ArrayLike]) -> bytes:
    """Return one table of a figure as a Parquet file.

    Raises
    ------
    ValueError
        If its columns are not of equal length, or not flat.
    """
    arrays = {column: np.asarray(values) for column, values in columns.items()}
    shapes = {column: array.shape for column, array in arrays.items()}
    if any(len(shape) != 1 for shape in shapes.values()) or len(set(shapes.values())) != 1:
        raise ValueError(
            f"table '{name}' of figure {entry.key}: columns must be flat and of one length; "
            f"their shapes are {shapes}"
        )
    facts = {"format": FORMAT, "figure": entry.key, "table": name, "standoff": __version__}
    table = pa.table({column: pa.array(array) for column, array in arrays.items()})
    table = table.replace_schema_metadata({METADATA: json.dumps(facts).encode()})
    buffer = io.BytesIO()
    pq.write_table(table, buffer)
    return buffer.getvalue()


def picture_bytes(artwork: Artwork) -> dict[str, bytes]:
    """Draw a figure; return the file for each extension in `PICTURES`, the same at every run."""
    software = f"Standoff {__version__}"
    metadata: dict[str, dict[str, str | None]] = {
        ".png": {"Software": software},
        ".svg": {"Creator": software, "Date": None},
    }
    found = {}
    with style.settings():
        figure = artwork.draw()
        for ending in PICTURES:
            buffer = io.BytesIO()
            figure.savefig(buffer, format=ending[1:], metadata=metadata[ending], facecolor="white")
            found[ending] = buffer.getvalue()
    return found


def animation_bytes(animation: Animation) -> bytes:
    """Draw an animation, frame by frame.

    Raises
    ------
    ValueError
        If it has no frames.
    """
    if animation.frames < 1:
        raise ValueError(f"an animation needs a frame; this one has {animation.frames}")
    frames = []
    with style.settings():
        figure = style.new_figure(*animation.size)
        figure.set_dpi(min(style.DPI, MOST_PIXELS / max(animation.size)))
        for k in range(animation.frames):
            figure.clear()
            animation.draw(figure, k)
            figure.canvas.draw()
            pixels = np.asarray(figure.canvas.buffer_rgba())  # type: ignore[attr-defined]
            frames.append(Image.fromarray(pixels).convert("RGB"))
    buffer = io.BytesIO()
    frames[0].save(
        buffer,
        format="WEBP",
        save_all=True,
        append_images=frames[1:],
        duration=round(1000.0 * animation.seconds),
        loop=0,
        lossless=True,
        quality=50,
        method=ENCODING,
    )
    return buffer.getvalue()


def files_of(
    entry: Entry, artwork: Artwork, folder: Path, animations: bool = True
) -> dict[Path, Writer]:
    """Draw a figure; return what writes its files, to be written whole or not at all.

    Parameters
    ----------
    entry : Entry
    artwork : Artwork
    folder : Path
        Where they go.
    animations : bool
        Also draw the animation, if there is one.
    """
    contents = {f"{stem(entry)}{end}": data for end, data in picture_bytes(artwork).items()}
    for name, columns in artwork.tables.items():
        contents[f"{stem(entry)}-{name}.parquet"] = table_bytes(entry, name, columns)
    if animations and artwork.animation is not None:
        contents[f"{stem(entry)}{ANIMATION}"] = animation_bytes(artwork.animation)
    return {folder / name: _writer(data) for name, data in contents.items()}


def _writer(data: bytes) -> Writer:
    return lambda file: file.write(data)
