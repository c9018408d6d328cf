"""The law of data files: pose samples, patches and recordings are read whole, or refused."""

from __future__ import annotations

from pathlib import Path
from random import Random

import numpy as np

import standoff as so
from fuzz.laws import Broken, refusals
from fuzz.mutation import damaged
from standoff.motion import read_pose_samples

BY_ROWS = 0.5
"""Share of text files whose numbers are changed, not their bytes."""
NUMBERS = (
    *("nan", "inf", "-inf", "1e400", "1e101", "-1e99", "1e-320", "0", "-0", "1", "0x1", "1_0"),
    *("", "a", "1,0", "١", "1e", "--1", "0.7071", "1e9", "999999999999999999999"),
)  # fmt: skip


def file_input(seeds: dict[str, bytes], random: Random) -> tuple[str, bytes]:
    """Return a name, whose ending says the format, and damaged content."""
    name = random.choice(sorted(seeds))
    content = seeds[name]
    if name.endswith((".tum", ".csv")) and random.random() < BY_ROWS:
        return name, _other_numbers(content, name, random)
    return name, damaged(content, random)


def _other_numbers(content: bytes, name: str, random: Random) -> bytes:
    separator = "," if name.endswith("csv") else " "
    lines = content.decode(errors="replace").splitlines()
    for _ in range(random.choice((1, 1, 2, 4))):
        k = random.randrange(len(lines)) if lines else 0
        fields = lines[k].split(separator) if lines else []
        if fields:
            fields[random.randrange(len(fields))] = random.choice(NUMBERS)
            lines[k] = separator.join(fields)
    return "\n".join(lines).encode()


def check_file(name: str, content: bytes, folder: Path) -> str:
    """Read a file by what its name begins with: ``recording`` or ``samples``.

    Raises
    ------
    Broken
        The law of files does not hold.
    """
    file = folder / name
    file.write_bytes(content)
    before = sorted(p.name for p in folder.iterdir())
    with refusals((ValueError, OSError)) as refused:
        if name.startswith("recording"):
            run = so.open_recording(file)
            if not len(run.time) == len(run.distance) == len(run.feature_a):
                raise Broken("columns of different lengths")
        else:
            samples = read_pose_samples(file)
            for t in (samples.start, 0.5 * samples.start + 0.5 * samples.end, samples.end):
                pose = samples.pose(t)
                if not np.isfinite(pose.matrix).all():
                    raise Broken(f"a pose that is not finite at {t}: {pose.matrix}")
                samples.twist(t)
    if sorted(p.name for p in folder.iterdir()) != before or file.read_bytes() != content:
        raise Broken("the folder was changed")
    if refused and str(file) not in refused[0]:
        raise Broken(f"the message names no file: {refused[0]}")
    return "refused" if refused else "read"
