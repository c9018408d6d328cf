"""The kernels' constants as a C header: where the library's C file finds each number of a block."""

from __future__ import annotations

import json

from standoff.kernels.body import layout as L
from standoff.kernels.compiler.machine import source_digest
from standoff.kernels.entries import solid_blocks as B
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion.tolerances import ROUNDED
from standoff.tracking.status import Status
from standoff.version import __version__

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
