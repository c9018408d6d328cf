"""Draw the pages' diagrams: architecture.svg (a step, room by room), certificate.svg, touching.svg.

Run: python docs/images/draw_diagrams.py [FOLDER]. Plain Python; the same run gives the same bytes.
"""

from __future__ import annotations

import math
import os
import sys
import tempfile
from pathlib import Path
from xml.sax.saxutils import escape

INK, SOFT, RED = "#222222", "#6b7280", "#a03030"
PYTHON, COMPILED, LOOP = "#dcebf7", "#f6dfc6", "#fbf1e4"
BODY_A, BODY_B = "#8fb3d3", "#e6b17c"
SANS = "font-family='Helvetica, Arial, sans-serif'"
MONO = "font-family='Menlo, Consolas, monospace'"


class Drawing:
    """SVG elements in the order they are drawn."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self.head = (
            f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' "
            f"width='{width}' height='{height}' role='img'><title>{escape(title)}</title>"
        )
        self.parts = [f"<rect width='{width}' height='{height}' fill='white'/>"]

    def text(self, x: float, y: float, words: str, size: int = 14, **style: str) -> None:
        font = MONO if style.get("mono") else SANS
        anchor = style.get("anchor", "start")
        extra = " font-style='italic'" if style.get("italic") else ""
        extra += " font-weight='bold'" if style.get("bold") else ""
        self.parts.append(
            f"<text x='{x:g}' y='{y:g}' font-size='{size}' {font} fill='{style.get('fill', INK)}' "
            f"text-anchor='{anchor}'{extra}>{escape(words)}</text>"
        )

    def box(self, x: float, y: float, w: float, h: float, fill: str, edge: str = SOFT) -> None:
        self.parts.append(
            f"<rect x='{x:g}' y='{y:g}' width='{w:g}' height='{h:g}' rx='6' fill='{fill}' "
            f"stroke='{edge}' stroke-width='1'/>"
        )

    def line(self, points: list[tuple[float, float]], colour: str = INK, **style: str) -> None:
        path = " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
        dash = f" stroke-dasharray='{style['dash']}'" if "dash" in style else ""
        self.parts.append(
            f"<polyline points='{path}' fill='none' stroke='{colour}' "
            f"stroke-width='{style.get('width', '1.4')}'{dash}/>"
        )

    def arrow(self, points: list[tuple[float, float]], colour: str = INK) -> None:
        self.line(points, colour)
        (x0, y0), (x1, y1) = points[-2:]
        angle = math.atan2(y1 - y0, x1 - x0)
        wings = [
            (x1 - 9.0 * math.cos(angle + turn), y1 - 9.0 * math.sin(angle + turn))
            for turn in (0.4, 0.0, -0.4)
        ]
        corners = " ".join(f"{x:.2f},{y:.2f}" for x, y in [(x1, y1), *wings])
        self.parts.append(f"<polygon points='{corners}' fill='{colour}'/>")

    def shape(self, points: list[tuple[float, float]], fill: str) -> None:
        corners = " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
        self.parts.append(f"<polygon points='{corners}' fill='{fill}' stroke='{INK}'/>")

    def svg(self) -> str:
        return "\n".join([self.head, *self.parts, "</svg>"]) + "\n"


def room(
    d: Drawing, y: float, fill: str, what: str, where: str, x: float = 40, w: float = 430
) -> None:
    """One room: what happens there, and its file."""
    d.box(x, y, w, 48, fill)
    d.text(x + 14, y + 20, what, 14)
    d.text(x + 14, y + 38, where, 12, mono="yes", fill=SOFT)


def architecture() -> str:
    d = Drawing(780, 822, "What a step goes through, from the call to the witness points")
    d.text(
        40, 30, "tracker.step(state, pose_a, pose_b, twist_a, twist_b)", 14, mono="yes", bold="yes"
    )
    down = 255.0
    room(d, 52, PYTHON, "a pose becomes 12 numbers, a twist 6", "tracking/inputs.py")
    d.line([(20, 116), (760, 116)], SOFT, dash="5 4")
    d.text(760, 110, "Python", 12, anchor="end", fill=SOFT)
    d.text(760, 132, "compiled by Numba", 12, anchor="end", fill=SOFT)
    room(d, 132, COMPILED, "poses that are none are refused", "kernels/frame.py")
    room(d, 196, COMPILED, "one relative pose and twist, in A's frame", "kernels/rigid.py")
    room(
        d,
        260,
        COMPILED,
        "predict: q + h w_ff, held at a boundary",
        "kernels/prediction.py, trimming.py",
    )
    d.box(28, 322, 724, 250, LOOP)
    d.text(42, 342, "settle: at least one correction, until at rest", 14)
    d.text(738, 342, "kernels/descent.py", 12, mono="yes", fill=SOFT, anchor="end")
    room(
        d,
        356,
        COMPILED,
        "points, tangents, second partials",
        "kernels/features.py, jets.py",
        42,
        330,
    )
    room(d, 424, COMPILED, "Ψ, g, H and b", "kernels/system.py", 42, 330)
    room(d, 492, COMPILED, "one solve: p and w_ff", "kernels/feedback.py", 42, 330)
    room(d, 492, COMPILED, "walk p to the first boundary, hold it", "kernels/trimming.py", 408, 330)
    room(
        d, 424, COMPILED, "resets; at rest: release the steepest", "kernels/switching.py", 408, 330
    )
    for y in (404, 472):
        d.arrow([(207, y), (207, y + 20)])
    d.arrow([(372, 516), (408, 516)])
    d.arrow([(573, 492), (573, 472)])
    d.arrow([(573, 424), (573, 380), (372, 380)])
    d.text(585, 400, "again", 12, fill=SOFT)
    room(
        d,
        592,
        COMPILED,
        "certify: the greatest lower bound of four planes",
        "kernels/certificate.py",
    )
    d.arrow([(470, 608), (520, 608)], RED)
    d.box(520, 584, 232, 66, "white", RED)
    d.text(532, 603, "gap above the tolerance:", 12, fill=RED)
    d.text(532, 621, "to roundoff, contact.py,", 12, mono="yes", fill=RED)
    d.text(532, 639, "cold_start.py", 12, mono="yes", fill=RED)
    d.arrow([(636, 584), (636, 572)], RED)
    room(
        d,
        660,
        COMPILED,
        "the answer in world axes; what the next frame needs",
        "kernels/answer.py, prediction.py",
    )
    d.line([(20, 724), (760, 724)], SOFT, dash="5 4")
    d.text(760, 718, "compiled by Numba", 12, anchor="end", fill=SOFT)
    d.text(760, 740, "Python", 12, anchor="end", fill=SOFT)
    room(
        d,
        740,
        PYTHON,
        "no bound? prove the overlap; then values and events",
        "tracking/overlap.py, proximity.py",
    )
    d.text(40, 812, "→ (TrackerState, Proximity)", 14, mono="yes", bold="yes")
    for top, bottom in ((36, 52), (100, 132), (180, 196), (244, 260), (308, 322)):
        d.arrow([(down, top), (down, bottom)])
    for top, bottom in ((572, 592), (640, 660), (708, 740)):
        d.arrow([(down, top), (down, bottom)])
    return d.svg()


def ellipse(cx: float, cy: float, a: float, b: float, tilt: float) -> list[tuple[float, float]]:
    points = []
    for k in range(120):
        t = 2.0 * math.pi * k / 120
        x, y = a * math.cos(t), b * math.sin(t)
        turned = x * math.cos(tilt) - y * math.sin(tilt), x * math.sin(tilt) + y * math.cos(tilt)
        points.append((cx + turned[0], cy + turned[1]))
    return points


def frame_at(points: list[tuple[float, float]], k: int) -> tuple[tuple[float, float], ...]:
    """Point, unit tangent and unit outward normal at a corner of a fine polygon."""
    (x0, y0), (x1, y1) = points[k - 1], points[(k + 1) % len(points)]
    length = math.hypot(x1 - x0, y1 - y0)
    tangent = (x1 - x0) / length, (y1 - y0) / length
    return points[k], tangent, (tangent[1], -tangent[0])


def ray(start: tuple[float, float], way: tuple[float, float], s: float) -> tuple[float, float]:
    return start[0] + s * way[0], start[1] + s * way[1]


def certificate() -> str:
    d = Drawing(720, 380, "The lower bound of the certificate")
    a, b = ellipse(200, 215, 130, 90, 0.25), ellipse(560, 165, 100, 60, -0.5)
    (left, right), (top, low) = ((min(c), max(c)) for c in zip(*a, strict=True))
    d.line([(left, top), (right, top), (right, low), (left, low), (left, top)], SOFT, dash="4 4")
    d.text(left, low + 17, "box of A", 12, fill=SOFT)
    d.shape(a, BODY_A)
    d.shape(b, BODY_B)
    d.text(180, 225, "A", 20, italic="yes")
    d.text(575, 165, "B", 20, italic="yes")
    point_a, tangent_a, normal_a = frame_at(a, 117)
    point_b, _, _ = frame_at(b, 66)
    length = math.dist(point_a, point_b)
    n = (point_b[0] - point_a[0]) / length, (point_b[1] - point_a[1]) / length
    across = -n[1], n[0]
    d.line([ray(point_a, tangent_a, -150), ray(point_a, tangent_a, 150)], "#2f5f8a", width="1.6")
    d.line([ray(point_a, across, -165), ray(point_a, across, 165)], RED, width="1.6")
    d.line([ray(point_b, across, -120), ray(point_b, across, 150)], RED, width="1.6")
    d.line([point_a, point_b], INK, dash="2 3")
    d.arrow([point_a, ray(point_a, normal_a, 70)], "#2f5f8a")
    d.arrow([point_a, ray(point_a, n, 100)], RED)
    end_a, end_n = ray(point_a, normal_a, 84), ray(point_a, n, 104)
    d.text(end_a[0] - 6, end_a[1] + 12, "n_A", 15, italic="yes", fill="#2f5f8a")
    d.text(end_n[0] - 8, end_n[1] - 8, "n", 15, italic="yes", fill=RED)
    for (x, y), name, dx, dy in ((point_a, "x_a", -34, 6), (point_b, "x_b", 10, 6)):
        d.parts.append(f"<circle cx='{x:.2f}' cy='{y:.2f}' r='4' fill='{INK}'/>")
        d.text(x + dx, y + dy, name, 15, italic="yes")
    d.text(360, 40, "planes square to n", 13, fill=RED)
    d.text(150, 30, "A's own tangent plane:", 13, fill="#2f5f8a")
    d.text(150, 47, "nothing of A is beyond it", 13, fill="#2f5f8a")
    return d.svg()


def panel(d: Drawing, x: float, flag: str, why: str) -> None:
    d.text(x + 110, 232, flag, 14, anchor="middle", bold="yes")
    d.text(x + 110, 252, why, 12, anchor="middle", fill=SOFT)


def pair(d: Drawing, a: tuple[float, float], b: tuple[float, float]) -> None:
    """Two witness points and the line between them."""
    d.line([a, b], RED, width="1.6")
    for x, y in (a, b):
        d.parts.append(f"<circle cx='{x:g}' cy='{y:g}' r='3.5' fill='{RED}'/>")


def touching() -> str:
    d = Drawing(740, 270, "Unique witness points, a segment of them, a circle of normals")
    for x in (20.0, 260.0):
        d.shape([(x, 160), (x + 220, 160), (x + 220, 200), (x, 200)], BODY_A)
    d.shape(ellipse(130, 85, 70, 42, 0.3), BODY_B)
    lowest = max(ellipse(130, 85, 70, 42, 0.3), key=lambda p: p[1])
    pair(d, (lowest[0], 160), lowest)
    panel(d, 20, "dimension 0", "one pair of witness points")
    d.shape([(330, 50), (420, 50), (420, 130), (330, 130)], BODY_B)
    d.line([(330, 160), (420, 160)], RED, width="4")
    d.line([(330, 130), (420, 130)], RED, width="4")
    for k in range(4):
        pair(d, (330 + 30 * k, 160), (330 + 30 * k, 130))
    panel(d, 260, "dimension 1", "any pair above each other")
    d.shape(ellipse(610, 105, 75, 75, 0.0), BODY_A)
    d.shape(ellipse(610, 105, 30, 30, 0.0), BODY_B)
    for k in range(12):
        way = math.cos(math.pi * k / 6), math.sin(math.pi * k / 6)
        d.arrow([ray((610.0, 105.0), way, 75), ray((610.0, 105.0), way, 98)], RED)
    panel(d, 500, "normal_dimension", "any direction parts them")
    return d.svg()


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    drawings = {
        "architecture.svg": architecture,
        "certificate.svg": certificate,
        "touching.svg": touching,
    }
    for name, draw in drawings.items():
        handle, part = tempfile.mkstemp(suffix=".svg", dir=folder)
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(draw())
        os.chmod(part, 0o644)
        os.replace(part, folder / name)


if __name__ == "__main__":
    main()
