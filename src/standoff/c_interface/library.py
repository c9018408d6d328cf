"""The shared library and its header, built by the system's C compiler."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import BinaryIO

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.machine import source_digest
from standoff.kernels.compiler.notices import say, takes
from standoff.kernels.entries import solid_blocks as B
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion.tolerances import ROUNDED
from standoff.tracking.status import Status
from standoff.version import __version__
from standoff.whole_files import MissingFolder, file_name, write_whole

SOURCE = Path(__file__).parent / "source"
NAMES = {"linux": "libstandoff.so", "darwin": "libstandoff.dylib"}
HEADER = "standoff.h"
FLAGS = ("-std=c11", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-Wall", "-Wextra")
COMPILER = "CC"
"""The compiler's name in the environment; `cc` if not set."""

SECONDS = 130
"""About how much processor time it takes, s."""


def build_library(
    folder: str | Path,
    *,
    processor: str | None = None,
    compiler: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Path, Path]:
    """Build the shared library of the C interface; takes two to three minutes of a processor.

    Raises StandoffError: no compiler, or one that fails; a system without such libraries; a
    processor that LLVM does not know. Raises OSError if a file cannot be written.

    Parameters
    ----------
    folder : str or Path
        An existing folder; gets ``libstandoff.so`` (``.dylib`` on macOS) and ``standoff.h``, both
        or neither.
    processor : str, optional
        The processor that the code is for, by LLVM's name, such as ``"x86-64-v3"``. If not given,
        it is this machine's own, and answers equal those of Python here to the last bit.
    compiler : str, optional
        The C compiler's command; if not given, what ``CC`` in the environment says, or ``cc``.
    progress : callable, optional
        ``progress(done, total)`` is called with the parts compiled so far, and all.

    Returns
    -------
    (Path, Path)
        The library and the header.
    """
    target = file_name(folder)
    if not target.is_dir():
        raise MissingFolder(f"{target} is not a folder: make it first.")
    if sys.platform not in NAMES:
        raise StandoffError(f"The C library is built on Linux and macOS, not on {sys.platform}.")
    command = _compiler(compiler)
    from standoff.c_interface import objects  # reads all kernels

    say(f"building {NAMES[sys.platform]}, {takes(SECONDS)} ...")
    with tempfile.TemporaryDirectory() as place:
        work = Path(place)
        objects.build(work, processor, progress)
        header = layout_header(objects.smooth_symbols())
        write_whole({work / "layout.h": partial(_put, header.encode())})
        made = work / NAMES[sys.platform]
        _run([*command, *FLAGS, f"-I{work}", f"-I{SOURCE}", "-o", str(made)], work)
        library, public = target / made.name, target / HEADER
        write_whole(
            {
                library: partial(_put, made.read_bytes()),
                public: partial(_put, (SOURCE / HEADER).read_bytes()),
            }
        )
    return library, public


def link_command(folder: str | Path, program: str = "program") -> str:
    """Return what a shell compiles ``program.c`` with, so that it finds the library in a folder."""
    at = Path(folder).resolve()
    words = [*shlex.split(os.environ.get(COMPILER) or "cc"), f"{program}.c"]
    words += [f"-I{at}", f"-L{at}", "-lstandoff", "-lm", "-o", program]
    # -Wl,-rpath would split a path at its commas
    return shlex.join([*words, "-Xlinker", "-rpath", "-Xlinker", str(at)])


def _compiler(given: str | None) -> list[str]:
    """The compiler's command as words."""
    words = shlex.split(given or os.environ.get(COMPILER) or "cc")
    if not words or shutil.which(words[0]) is None:
        raise StandoffError(
            f"There is no C compiler {shown(' '.join(words))}: install one (on Debian: apt install "
            f"gcc), or name it in {COMPILER}."
        )
    return words


def _run(command: list[str], work: Path) -> None:
    """Compile the C files and link it with the kernels' object files."""
    files = [*map(str, sorted(SOURCE.glob("*.c"))), *map(str, sorted(work.glob("*.o"))), "-lm"]
    done = subprocess.run([*command, *files], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise StandoffError(f"{command[0]} failed:\n{done.stderr.strip()}")


def _put(content: bytes, file: BinaryIO) -> None:
    file.write(content)


# The kernels' constants as a C header: where the library's C file finds each number of a block.

OF_BLOCKS = (
    *("N_LONG_BLOCK", "BLOCK_MOTION", "BLOCK_TIME_STEP", "BLOCK_HAS_TWIST", "BLOCK_EVENTS"),
    *("POSE_A", "POSE_B", "TWIST_A", "TWIST_B", "N_OPTIONS", "O_SMOOTH", "O_FRAME"),
    *("DISTANCE", "LOWER_BOUND", "UPPER_BOUND", "POINT_A", "POINT_B", "NORMAL", "VELOCITY_A"),
    *("VELOCITY_B", "RESIDUAL", "STATUS", "OUT_MODE", "OUT_Q", "OUT_COUNTS"),
    *("FINE", "BAD_POSE_A", "BAD_POSE_B", "BAD_TWIST", "OUT_OF_PLANE"),
)
OF_SOLID_BLOCKS = (
    *("N_TABLED", "T_ASKED", "T_LEAVES_A", "N_ASKED", "N_SOLIDS_BLOCK", "POSES", "FRESH", "MODE"),
    *("IN_CONTACT", "ANSWER", "MINIMA", "KEYS", "ROWS", "FIXED", "CONTACT_ROW", "KEY_ROW"),
    *("FRONT_ROW", "CONTACT_COUNT", "FRONT_COUNT"),
    *("A_STATUS", "A_INSIDE", "A_SINGLE", "A_COMPLETE", "A_N_MINIMA", "A_EVALUATIONS"),
    *("A_RESTARTS", "A_ANEW", "A_LOWER", "A_UPPER", "M_REALS", "M_DISTANCE", "M_LOWER", "M_KEY"),
    *("M_FELT", "M_LEAVES", "M_PARAMETERS", "M_A", "M_B", "M_NORMAL"),
)
OF_EVENTS = (
    *("EVALUATIONS", "CORRECTIONS", "SATURATIONS", "RESTARTS", "REGULARISED", "EVENTS"),
    *("SEARCHES", "GENERAL_FRAMES", "EVENT_COLUMNS", "BODY", "SOURCE", "TARGET"),
)


def layout_header(smooth_frames: list[str]) -> str:
    """The text of ``layout.h``.

    Parameters
    ----------
    smooth_frames : list of str
        Symbols of the smooth frames, in the order in which files of pairs number them from 1.
    """
    constants = {name: getattr(K, name) for name in OF_BLOCKS}
    constants |= {name: getattr(N, name) for name in OF_EVENTS}
    constants |= {f"SOLIDS_{name}": getattr(B, name) for name in OF_SOLID_BLOCKS}
    constants |= {"N_FACES": L.N_FACES, "ROUNDED": ROUNDED}
    texts = {"KERNELS_DIGEST": source_digest(), "VERSION": __version__}
    lines = ["/* Made with the library. */"]
    lines += [f"#define {name} {value!r}" for name, value in constants.items()]
    lines += [f"#define {name} {json.dumps(text)}" for name, text in texts.items()]
    # of rows in Python alone
    told = ["no such status" if each is Status.REFUSED else each.advice for each in Status]
    advice = ", ".join(json.dumps(sentence) for sentence in told)
    frames = " ".join(f"SMOOTH_FRAME({name})" for name in smooth_frames)
    lines += [f"#define STATUS_ADVICE {advice}", f"#define SMOOTH_FRAMES {frames}"]
    return "\n".join(lines) + "\n"
