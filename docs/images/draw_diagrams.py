"""Draw the pages' diagrams: architecture.svg (a frame), certificate.svg, touching.svg.

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
        self.down = 0  # of what is drawn next, pixels
        self.parts = [f"<rect width='{width}' height='{height}' fill='white'/>"]

    def text(self, x: float, y: float, words: str, size: int = 14, **style: str) -> None:
        font = MONO if style.get("mono") else SANS
        anchor = style.get("anchor", "start")
        extra = " font-style='italic'" if style.get("italic") else ""
        extra += " font-weight='bold'" if style.get("bold") else ""
        y += self.down
        self.parts.append(
            f"<text x='{x:g}' y='{y:g}' font-size='{size}' {font} fill='{style.get('fill', INK)}' "
            f"text-anchor='{anchor}'{extra}>{escape(words)}</text>"
        )

    def box(self, x: float, y: float, w: float, h: float, fill: str, edge: str = SOFT) -> None:
        y += self.down
        self.parts.append(
            f"<rect x='{x:g}' y='{y:g}' width='{w:g}' height='{h:g}' rx='6' fill='{fill}' "
            f"stroke='{edge}' stroke-width='1'/>"
        )

    def line(self, points: list[tuple[float, float]], colour: str = INK, **style: str) -> None:
        path = " ".join(f"{x:.2f},{y + self.down:.2f}" for x, y in points)
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
        corners = " ".join(f"{x:.2f},{y + self.down:.2f}" for x, y in [(x1, y1), *wings])
        self.parts.append(f"<polygon points='{corners}' fill='{colour}'/>")

    def shape(self, points: list[tuple[float, float]], fill: str) -> None:
        corners = " ".join(f"{x:.2f},{y:.2f}" for x, y in points)
        self.parts.append(f"<polygon points='{corners}' fill='{fill}' stroke='{INK}'/>")

    def svg(self) -> str:
        return "\n".join([self.head, *self.parts, "</svg>"]) + "\n"


def stage(
    d: Drawing, x: float, y: float, w: float, what: str, where: str, fill: str = COMPILED
) -> None:
    """What happens to a pose, and the file in which it does."""
    d.box(x, y, w, 48, fill)
    d.text(x + 12, y + 20, what, 14)
    d.text(x + 12, y + 38, where, 12, mono="yes", fill=SOFT)


def panel_of(d: Drawing, x: float, y: float, w: float, h: float, name: str, where: str) -> None:
    """One of the three ways through a frame."""
    d.box(x, y, w, h, LOOP)
    d.text(x + 12, y + 22, name, 15, bold="yes")
    d.text(x + 12, y + 40, where, 12, mono="yes", fill=SOFT)


def border(d: Drawing, y: float, above: str, below: str) -> None:
    """Where Python hands over to compiled code, or takes back."""
    d.line([(20, y), (940, y)], SOFT, dash="5 4")
    d.text(940, y - 7, above, 12, anchor="end", fill=SOFT)
    d.text(940, y + 17, below, 12, anchor="end", fill=SOFT)


def before_the_ways(d: Drawing) -> None:
    routes = (
        ("step, step_into", "tracking/"),
        ("run, so.track", "tracking/"),
        ("so.distances", "tracking/"),
        ("Operator", "simulation/"),
        ("Servo, live page", "servo/"),
        ("a C program", "c_interface/"),
    )
    for k, (name, where) in enumerate(routes):
        x = 20 + 155.4 * k
        stage(d, x, 20, 143, name, where, PYTHON)
        d.line([(x + 71, 68), (x + 71, 84)])
    d.line([(91, 84), (868, 84)])
    d.arrow([(480, 84), (480, 124)])
    border(d, 104, "Python, or C", "compiled by Numba: kernels/")
    stage(d, 270, 124, 420, "the frame: one for every route", "entries/frames.py")
    stage(d, 20, 192, 448, "on faces, first: the smooth frame, without switches", "frame/smooth.py")
    stage(d, 492, 192, 448, "the law's own frame, by its address", "entries/laws.py")
    d.arrow([(400, 172), (400, 192)])
    d.arrow([(560, 172), (560, 192)])
    d.arrow([(468, 216), (492, 216)], RED)
    d.line([(20, 216), (8, 216), (8, 892)])
    d.arrow([(8, 892), (20, 892)])
    d.arrow([(716, 240), (716, 256), (480, 256), (480, 272)])
    stage(d, 270, 272, 420, "B is seen from A: one pose, one twist", "algebra/rigid.py")


def apart(d: Drawing) -> None:
    panel_of(d, 20, 300, 480, 460, "apart", "frame/apart.py")
    left, right, w = 36, 268, 216
    stage(d, left, 352, 448, "predict: q + h w_ff, up to a boundary", "frame/prediction.py")
    d.text(156, 424, "correct, until at rest", 13, italic="yes")
    d.text(484, 424, "pair/descent.py", 12, mono="yes", fill=SOFT, anchor="end")
    stage(d, left, 436, w, "points and partials", "body/jets.py")
    stage(d, left, 504, w, "pair system Ψ, g, H, b", "pair/system.py")
    stage(d, left, 572, w, "one solve: step, w_ff", "pair/newton.py")
    stage(d, right, 572, w, "walk to a boundary", "body/trimming.py")
    stage(d, right, 504, w, "hold, cross or release", "pair/switching.py")
    stage(d, left, 692, 448, "certify: a lower bound by planes", "pair/certificate.py")
    d.text(left, 662, "where the bound is too low, once more, to roundoff", 13, italic="yes")
    for y in (484, 552):
        d.arrow([(144, y), (144, y + 20)])
    d.arrow([(144, 400), (144, 436)])
    d.arrow([(252, 596), (268, 596)])
    d.arrow([(376, 572), (376, 552)])
    d.arrow([(376, 504), (376, 460), (252, 460)])
    d.text(386, 478, "again", 12, fill=SOFT)
    d.arrow([(376, 620), (376, 692)])


def in_contact(d: Drawing) -> None:
    panel_of(d, 532, 300, 192, 460, "in contact", "frame/contact.py")
    x, w = 544, 168
    stage(d, x, 372, w, "Newton's method", "depth/penetration.py")
    stage(d, x, 460, w, "descent of depth", "depth/descent.py")
    stage(d, x, 548, w, "is it the least?", "depth/search.py")
    stage(d, x, 692, w, "certify along n", "pair/certificate.py")
    for top, bottom in ((420, 460), (508, 548), (596, 692)):
        d.arrow([(x + 0.5 * w, top), (x + 0.5 * w, bottom)])
    d.text(x, 362, "from the last place and n", 12, italic="yes")
    d.text(x + 0.5 * w + 8, 444, "if it fails", 12, fill=SOFT)
    d.text(x + 0.5 * w + 8, 630, "bounds above", 12, fill=SOFT)
    d.text(x + 0.5 * w + 8, 646, "and below", 12, fill=SOFT)


def anew(d: Drawing) -> None:
    panel_of(d, 756, 300, 184, 460, "restart", "frame/restart.py")
    x, w = 768, 160
    stage(d, x, 372, w, "sampled starts", "pair/cold_start.py")
    stage(d, x, 460, w, "descend, certify", "pair/certified.py")
    stage(d, x, 548, w, "touching? depth", "frame/contact.py")
    for top, bottom in ((420, 460), (508, 548)):
        d.arrow([(x + 0.5 * w, top), (x + 0.5 * w, bottom)])
    d.text(x, 362, "from nothing; counted", 12, italic="yes")


def between_the_ways(d: Drawing) -> None:
    """How a frame comes to each way, and what leads from one to the next."""
    for x, why in ((260, "the last frame was apart"), (628, "in contact"), (848, "uncertified")):
        d.arrow([(480, 252), (480, 268), (x, 268), (x, 300)])
        d.text(x + 8, 290, why, 12, fill=SOFT)
    d.arrow([(500, 330), (532, 330)], RED)
    d.arrow([(724, 330), (756, 330)], RED)
    d.text(270, 779, "red: where the witness points have passed", 12, fill=RED)
    d.text(270, 794, "each other, or no bound holds", 12, fill=RED)


def after_the_ways(d: Drawing) -> None:
    for x in (260, 628, 848):
        d.arrow([(x, 760), (x, 800)])
    answer = "the answer in world axes, its status and rates; what the next frame needs"
    stage(d, 20, 800, 920, answer, "frame/answer.py, prediction.py")
    border(d, 868, "compiled by Numba: kernels/", "Python")
    last = "numbers become values and events"
    stage(d, 20, 888, 720, last, "tracking/proximity.py", PYTHON)
    d.arrow([(380, 848), (380, 888)])
    d.arrow([(380, 936), (380, 956)])
    d.text(380, 976, "(TrackerState, Proximity)", 14, mono="yes", bold="yes", anchor="middle")


def architecture() -> str:
    d = Drawing(960, 1058, "What a pose goes through, from the call to the witness points")
    before_the_ways(d)
    d.down = 68
    apart(d)
    in_contact(d)
    anew(d)
    between_the_ways(d)
    after_the_ways(d)
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
    panel(d, 500, "normal_dimension", "any direction separates them")
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
