"""A recorded run as a film: an animated GIF, or an MP4."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from standoff.checks.numbers import positive, whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, of_extra
from standoff.progress import Progress
from standoff.recording import Recording
from standoff.tracking.pair_plot import view_angles
from standoff.view.shown import what_moved
from standoff.view.tolerances import FILM_RATE, LEAST_FILM_RATE
from standoff.whole_files import file_name, write_whole

FORMATS = (".gif", ".mp4")


def save_video(
    recording: Recording,
    path: str | Path,
    *,
    pictures: int = 300,
    speed: float = 1.0,
    view: tuple[float, float] | None = None,
    progress: Progress | None = None,
) -> None:
    """Write a run as a video of both bodies, their active features and the witness line.

    Raises ModuleNotFoundError if matplotlib, or for an MP4 imageio-ffmpeg, is not installed; the
    message names the extra. Raises TypeError if `path` is neither a string nor a Path. Raises
    ValueError if the file has another ending, a number is out of range, or the recording was opened
    from a file or copied. Raises OSError if the file cannot be written.

    Parameters
    ----------
    recording : Recording
        As `so.track` returned it: one from a file does not hold what moved.
    path : str or path
        An .mp4 or a .gif file, written whole or not at all.
    pictures : int
        Greatest number of pictures to draw, each in a tenth of a second or so. At most 25 are shown
        per second; a long run is shown with fewer per second, but at least 2.
    speed : float
        Seconds of the motion in a second of the video: 0.1 shows it ten times slower.
    view : (float, float), optional
        Elevation and azimuth of the viewer, degrees. If not given, the view is across the normal of
        the closest frame.
    progress : callable, optional
        ``progress(done, total)`` is called with the pictures drawn so far, and all.
    """
    target = file_name(path)
    ending = target.suffix.lower()
    if ending not in FORMATS:
        raise StandoffError(
            f"{target}: the ending {shown(target.suffix)} is not known here; name a file that ends "
            f"in {' or '.join(FORMATS)}",
            "path",
            path,
        )
    check_installed(ending)
    what_moved(recording)
    count, factor = whole_number(pictures, "pictures"), positive(speed, "speed")
    angles = view_angles(view)
    write_whole(
        {target: lambda file: write_video(recording, file, ending, count, factor, angles, progress)}
    )


def check_installed(ending: str) -> None:
    """Refuse an ending, .gif or .mp4, whose libraries are missing.

    Raises ModuleNotFoundError: the message names the extra.
    """
    with of_extra("", "video"):
        import matplotlib  # noqa: F401

        if ending == ".mp4":
            import imageio_ffmpeg  # noqa: F401


def write_video(
    recording: Recording,
    file: BinaryIO,
    ending: str,
    pictures: int = 300,
    speed: float = 1.0,
    view: tuple[float, float] | None = None,
    progress: Progress | None = None,
) -> None:
    """Write a video to a stream; `save_video` describes it, and checks its arguments."""
    from standoff.recording.animation import drawing

    pair, paths = what_moved(recording)
    lasts = float(recording.time[-1] - recording.time[0]) / speed
    wanted = max(2, min(pictures, int(np.ceil(lasts * FILM_RATE)) + 1))
    figure, draw, count = drawing(recording, pair, paths, wanted, view)
    usual = (count - 1) / lasts if lasts > 0.0 else FILM_RATE
    rate = float(np.clip(usual, LEAST_FILM_RATE, FILM_RATE))
    images = []
    for number in range(count):
        draw(number)
        images.append(_pixels(figure))
        if progress is not None:
            progress(number + 1, count)
    write = _write_gif if ending == ".gif" else _write_mp4
    write(images, rate, file)


def _pixels(figure: Any) -> Any:
    """The figure as it is now, (height, width, 3); an MP4 asks for even numbers of both."""
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3]
    height, width = pixels.shape[0] // 2 * 2, pixels.shape[1] // 2 * 2
    return np.ascontiguousarray(pixels[:height, :width])


def _write_gif(images: list[Any], rate: float, file: BinaryIO) -> None:
    from PIL import Image

    first, *others = [Image.fromarray(image).quantize(128) for image in images]
    # GIF counts in hundredths of a second.
    shown_for = 10 * max(2, round(100.0 / rate))
    first.save(file, format="GIF", save_all=True, append_images=others, duration=shown_for, loop=0)


def _write_mp4(images: list[Any], rate: float, file: BinaryIO) -> None:
    import imageio_ffmpeg

    height, width = images[0].shape[:2]
    with tempfile.TemporaryDirectory() as folder:
        # The encoder goes back in its file when all is known, so it cannot write to a stream.
        made = Path(folder) / "run.mp4"
        film = imageio_ffmpeg.write_frames(
            str(made), (width, height), fps=rate, macro_block_size=2, ffmpeg_log_level="error"
        )
        film.send(None)
        for image in images:
            film.send(image)
        film.close()
        file.write(made.read_bytes())
