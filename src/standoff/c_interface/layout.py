"""The kernels' constants as a C header: where the library's C file finds each number of a block."""

from __future__ import annotations

import json

from standoff.kernels.body import layout as L
from standoff.kernels.compiler.machine import source_digest
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion.tolerances import ROUNDED
from standoff.tracking.status import OF_SOLIDS, Status
from standoff.version import __version__

OF_BLOCKS = (
    *("N_LONG_BLOCK", "BLOCK_MOTION", "BLOCK_TIME_STEP", "BLOCK_HAS_TWIST", "BLOCK_EVENTS"),
    *("POSE_A", "POSE_B", "TWIST_A", "TWIST_B", "N_OPTIONS", "O_SMOOTH", "O_FRAME"),
    *("DISTANCE", "LOWER_BOUND", "UPPER_BOUND", "POINT_A", "POINT_B", "NORMAL", "VELOCITY_A"),
    *("VELOCITY_B", "RESIDUAL", "STATUS", "OUT_MODE", "OUT_Q", "OUT_COUNTS"),
    *("FINE", "BAD_POSE_A", "BAD_POSE_B", "BAD_TWIST", "OUT_OF_PLANE"),
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
    constants |= {"N_FACES": L.N_FACES, "ROUNDED": ROUNDED}
    texts = {"KERNELS_DIGEST": source_digest(), "VERSION": __version__}
    lines = ["/* Made with the library. */"]
    lines += [f"#define {name} {value!r}" for name, value in constants.items()]
    lines += [f"#define {name} {json.dumps(text)}" for name, text in texts.items()]
    elsewhere = (Status.REFUSED, *OF_SOLIDS)  # of rows in Python, and of solids
    told = [status.advice for status in Status if status not in elsewhere]
    advice = ", ".join(json.dumps(sentence) for sentence in told)
    frames = " ".join(f"SMOOTH_FRAME({name})" for name in smooth_frames)
    lines += [f"#define STATUS_ADVICE {advice}", f"#define SMOOTH_FRAMES {frames}"]
    return "\n".join(lines) + "\n"
