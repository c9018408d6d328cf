"""Spike: the switching rules on trimmed faces. Run: python switching.py [--starts N]

Cold descents from random poses, features and parameters on boxes, tilted boxes, cylinders,
lenses, caps and cones; then the same starts under other rules; then where a cold start should
begin. With NUMBA_DISABLE_JIT=1 the kernels and this script are plain Python. The bodies and the
judge are in switching_cases.py, the rules in switching_rules.py, the result in switching.md.
"""

import argparse
import sys
import time

import numpy as np
from switching_cases import (
    BODIES,
    RIGHT,
    TILTS,
    box,
    cases,
    cone,
    cylinder,
    faces_away,
    lens,
    long_ellipsoid,
    low_cap,
    thin_lens,
)
from switching_rules import (
    AT_ONCE,
    CLIP,
    DROP,
    EAGER,
    EXHAUSTED,
    FLOOR,
    OURS,
    RELEASES,
    SOLVES,
    STALLED,
    ZEROING,
)

from standoff.kernels.body import layout as L
from standoff.kernels.pair.cold_start import farthest_along, gilbert, nearest_facing, sample_point
from standoff.kernels.pair.events import EVALUATIONS


def families():
    """(name, first maker, second maker, tilt or None)."""
    names = list(BODIES)
    for i, first in enumerate(names):
        for second in names[i:]:
            yield f"{first} - {second}", BODIES[first], BODIES[second], None
    for tilt in TILTS:
        yield f"boxes tilted {tilt:g}", box, box, tilt


# Parameters up to which the script's descent ends where the library's does: roundoff.
SAME = 1e-12
FEATURES, PARAMETERS = slice(4), slice(4, None)  # parts of a Place

COLUMNS = (
    "starts",
    "exhausted",
    "stalled",
    "far side",
    "wrong else",
    "false proof",
    "lost proof",
    "wrong at last",
    "differs",
)


def judge_family(family, starts, rng):
    """Counts of one family under the library's rules, with the lists of solves and releases."""
    row = dict.fromkeys(COLUMNS, 0)
    solves, releases, again = [], [], []
    for case in cases(*family[1:], starts, rng):
        outcome, place, tally = case.descend(OURS)
        ours, counts = case.settle()
        apart = np.abs(np.subtract(place[PARAMETERS], ours[PARAMETERS])).max()
        same = place[FEATURES] == ours[FEATURES] and apart <= SAME
        row["differs"] += not (same and counts[EVALUATIONS] == tally[SOLVES])
        row["starts"] += 1
        row["exhausted"] += outcome == EXHAUSTED
        row["stalled"] += outcome == STALLED
        accepted, d, n = case.certify(ours)
        right = case.right(d, n)
        row["false proof"] += accepted and not right
        if not accepted:
            away = faces_away(case.pair, case.pose, ours)
            accepted, last, n, restarts = case.restart()
            again.append(restarts)
            if d - last > RIGHT * case.size:
                row["far side" if away else "wrong else"] += 1
            else:
                row["lost proof"] += 1
            right = accepted and case.right(last, n)
        row["wrong at last"] += not right
        solves.append(int(tally[SOLVES]))
        releases.append(int(tally[RELEASES]))
    return row, solves, releases, again


def print_row(cells, widths):
    print("| " + " | ".join(str(c).ljust(w) for c, w in zip(cells, widths, strict=True)) + " |")


def main_table(starts, rng):
    chosen = list(families())
    share = -(-starts // len(chosen))
    widths = (20, *(len(c) for c in COLUMNS), 14, 12, 14)
    titles = ("family", *COLUMNS, "solves med/max", "releases max", "restarts again")
    print_row(titles, widths)
    print_row(["-" * w for w in widths], widths)
    total = dict.fromkeys(COLUMNS, 0)
    every, let_go, starts_again = [], [], []
    for family in chosen:
        row, solves, releases, again = judge_family(family, share, rng)
        for c in COLUMNS:
            total[c] += row[c]
        every, let_go, starts_again = every + solves, let_go + releases, starts_again + again
        spread = f"{int(np.median(solves))} / {max(solves)}"
        cells = (family[0], *(int(row[c]) for c in COLUMNS), spread, max(releases), sum(again))
        print_row(cells, widths)
        sys.stdout.flush()
    spread = f"{int(np.median(every))} / {max(every)}"
    cells = ("all", *(int(total[c]) for c in COLUMNS), spread, max(let_go), sum(starts_again))
    print_row(cells, widths)
    print(f"releases: median {int(np.median(let_go))}, 99 % {int(np.quantile(let_go, 0.99))}")
    print(f"solves: 99 % {int(np.quantile(every, 0.99))}")
    print(f"restarts after the first facing start: {np.bincount(starts_again or [0])}")


RULES = {
    "hold, solve, then test": OURS,
    "switch at the hit, test at once": AT_ONCE,
    "clip the coupled step": CLIP,
    "zero after the solve": ZEROING,
    "flat floor 1e-11": FLOOR,
    "flat directions dropped": DROP,
    "release at the bare tolerance": EAGER,
}
RULE_COLUMNS = (
    "exhausted",
    "stalled",
    "far side",
    "wrong else",
    "excess med/max",
    "solves med/max",
    "releases max",
)


def judge_rule(rule, drawn):
    """Counts of one rule over given cases, without any restart.

    The excess is that of the wrong answers that are not on a far side, in sizes.
    """
    row = dict.fromkeys(RULE_COLUMNS[:4], 0)
    solves, releases, excesses = [], [], []
    for case, best in drawn:
        outcome, place, tally = case.descend(rule)
        row["exhausted"] += outcome == EXHAUSTED
        row["stalled"] += outcome == STALLED
        excess = (case.certify(place)[1] - best) / case.size
        if excess > RIGHT:
            away = faces_away(case.pair, case.pose, place)
            row["far side" if away else "wrong else"] += 1
            excesses += [] if away else [excess]
        solves.append(int(tally[SOLVES]))
        releases.append(int(tally[RELEASES]))
    spread = f"{int(np.median(solves))} / {max(solves)}"
    off = f"{np.median(excesses):.0e} / {max(excesses):.0e}" if excesses else ""
    return (*(int(row[c]) for c in RULE_COLUMNS[:4]), off, spread, max(releases))


def rule_table(starts, rng):
    """Every rule on the same starts."""
    groups = {
        "box - box": [("", box, box, None)],
        "boxes tilted 0 .. 1e-6": [("", box, box, tilt) for tilt in TILTS[:5]],
        "boxes tilted 1e-5 .. 1e-2": [("", box, box, tilt) for tilt in TILTS[5:]],
        "lens - lens": [("", lens, lens, None)],
        "cylinder - cone": [("", cylinder, cone, None)],
    }
    widths = (33, 31, *(len(c) for c in RULE_COLUMNS))
    print_row(("family", "rule", *RULE_COLUMNS), widths)
    print_row(["-" * w for w in widths], widths)
    for name, members in groups.items():
        drawn = []
        for member in members[:starts]:
            for case in cases(*member[1:], -(-starts // len(members)), rng):
                accepted, best, n, _ = case.restart()
                assert accepted
                assert case.right(best, n)
                drawn.append((case, best))
        for label, rule in RULES.items():
            title = f"{name} ({len(drawn)})"
            print_row((title, label, *judge_rule(rule, drawn)), widths)
            sys.stdout.flush()


def nearest(pair, pose):
    """The nearest sampled pair, whatever its normals say."""
    ia, ra, ib, rb = pair
    a = np.array([sample_point(ia, ra, i) for i in range(ia[L.N_SAMPLES])])
    b = np.array([sample_point(ib, rb, j) for j in range(ib[L.N_SAMPLES])])
    b = b @ np.reshape(pose.R, (3, 3)).T + pose.p
    squares = ((a[:, None] - b[None]) ** 2).sum(axis=2)
    i, j = np.unravel_index(int(squares.argmin()), squares.shape)
    return int(i), int(j)


def along_gilbert(pair, pose):
    """The support samples along the direction of Gilbert's iteration."""
    return farthest_along(pair, pose, gilbert(pair, pose))


def start_table(starts, rng):
    """Descents that the certificate refuses, by where a cold query begins; each on its own pose."""
    groups = {
        "cone - low cap": (cone, low_cap, None),
        "cylinder - cone": (cylinder, cone, None),
        "cone - ellipsoid": (cone, long_ellipsoid, None),
        "box - box": (box, box, None),
        "lens - lens": (lens, lens, None),
        "thin lens - thin lens": (thin_lens, thin_lens, None),
        "ellipsoids, axes ratio to 100": (long_ellipsoid, long_ellipsoid, None),
    }
    ways = {"nearest pair": nearest, "nearest facing": nearest_facing, "Gilbert": along_gilbert}
    widths = (33, 6, 12, 14, 7, 15)
    print_row(("family", "starts", *ways, "all three fail"), widths)
    print_row(["-" * w for w in widths], widths)
    for name, family in groups.items():
        refused, all_three = dict.fromkeys(ways, 0), 0
        for case in cases(*family, starts, rng, starts_a_pose=1):
            failures = 0
            for way, choose in ways.items():
                case.begin_at_samples(*choose(case.pair, case.pose))
                failed = not case.certify(case.settle()[0])[0]
                refused[way] += failed
                failures += failed
            all_three += failures == len(ways)
        print_row((name, starts, *refused.values(), all_three), widths)
        sys.stdout.flush()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--starts", type=int, default=120_000, help="descents of the main table")
    parser.add_argument("--rule-starts", type=int, help="descents a family of the rule table")
    parser.add_argument("--seed", type=int, default=20050701)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    start = time.perf_counter()
    main_table(options.starts, rng)
    print(f"{time.perf_counter() - start:.0f} s\n")
    start = time.perf_counter()
    few = options.rule_starts or max(options.starts // 40, 20)
    rule_table(few, rng)
    print(f"{time.perf_counter() - start:.0f} s\n")
    start = time.perf_counter()
    start_table(few, rng)
    print(f"{time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
