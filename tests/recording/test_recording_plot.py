"""The picture of a recording: its panels, what they show, and its files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread
from moving_pairs import REST, random_pairs, straight

import standoff as so

POINT, BOX = so.shapes.point(), so.shapes.box(1.0, 1.0, 1.0)
PAST = straight((-1.0, -0.9, 0.8), (1.0, 0.77, 0.013))


@pytest.fixture(scope="module")
def past() -> so.Recording:
    return so.track(so.Tracker(POINT, BOX, 1e-2), PAST, REST, 2.0)


def panel(figure: Figure, words: str) -> Axes:
    """Return the panel whose title or axis bears the words."""
    for axes in figure.axes:
        if words in (axes.get_ylabel(), axes.get_title(loc="left")):
            return axes
    raise AssertionError([axes.get_ylabel() for axes in figure.axes])


def line(axes: Axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    for drawn in axes.get_lines():
        if drawn.get_label() == label:
            return drawn.get_xdata(), drawn.get_ydata()
    raise AssertionError([drawn.get_label() for drawn in axes.get_lines()])


def test_the_picture_shows_the_recording(past: so.Recording) -> None:
    figure = past.plot()
    far = panel(figure, "distance")
    for label, values in (
        ("distance", past.distance),
        ("certified lower bound", past.lower_bound),
    ):
        times, drawn = line(far, label)
        np.testing.assert_array_equal(times, past.time)
        np.testing.assert_array_equal(drawn, values)
    error = panel(figure, "error")
    assert error.get_yscale() == "log"
    drawn = line(error, "residual")[1]
    visible = past.residual > drawn.min()
    np.testing.assert_array_equal(drawn[visible], past.residual[visible])
    assert line(error, "distance − lower bound")[1].min() > 0.0


def test_modes_are_bands_between_the_located_switches(past: so.Recording) -> None:
    figure = past.plot()
    band = panel(figure, "B: active features of box")
    spans = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in band.patches]
    np.testing.assert_allclose(spans, [visit[2:] for visit in past.modes()], atol=1e-15)
    named = {text.get_text() for text in band.texts}
    assert named == {str(v.feature_b) for v in past.modes() if v.end - v.start > 0.14}
    switches = line(band, "switch")[0]
    np.testing.assert_array_equal(switches, [event.time for event in past.events])
    hatches = {patch.get_hatch() for patch in band.patches}
    assert len(hatches) == 3


def test_parameters_are_drawn_where_there_are_any(past: so.Recording) -> None:
    figure = past.plot()
    panels = [axes for axes in figure.axes if axes.get_ylabel() == "parameters"]
    assert len(panels) == 1  # the point has none
    drawn = np.concatenate([d.get_ydata() for d in panels[0].get_lines()])
    expected = past.parameters_b[:, :2]
    assert drawn.size == np.count_nonzero(~np.isnan(expected))
    assert set(drawn) == set(expected[~np.isnan(expected)])
    # One line for each stay in an edge, two for the face's: nothing joins two features.
    assert len(panels[0].get_lines()) == 4


def test_an_overlap_is_shaded() -> None:
    through = straight((-1.0, 0.1, 0.3), (1.0, 0.05, 0.0))
    recording = so.track(so.Tracker(so.shapes.box(0.3, 0.2, 0.25), BOX, 1e-2), through, REST, 2.0)
    figure = recording.plot()
    shown = [text.get_text() for text in panel(figure, "distance").get_legend().get_texts()]
    assert "in penetration" in shown
    band = panel(figure, "A: active features of box")
    switches = line(band, "switch")[0]
    assert len(switches) == sum(e.body == "A" for e in recording.events)
    assert (recording.distance[recording.penetrating] < 1e-12).all()


def test_uncertified_frames_are_marked() -> None:
    recording = so.track(so.Tracker(POINT, BOX, 1e-2, law=so.PaperLaw()), PAST, REST, 2.0)
    bad = ~recording.certified
    assert bad.any()
    times = line(panel(recording.plot(), "error"), "the same, not certified")[0]
    np.testing.assert_array_equal(times, recording.time[bad])


def test_units_and_titles_come_from_the_info(past: so.Recording) -> None:
    from dataclasses import replace

    info = replace(past.info, title="Past", length_unit="mm", bodies=("tip", "block"))
    figure = replace(past, info=info).plot()
    panel(figure, "Past: A = tip, B = block")
    panel(figure, "distance (mm)")
    panel(figure, "error (mm)")
    panel(figure, "B: active features of block")


@pytest.mark.parametrize(
    ("ending", "head"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("PDF", b"%PDF")]
)
def test_files(past: so.Recording, tmp_path: Path, ending: str, head: bytes) -> None:
    target = tmp_path / f"run.{ending}"
    figure = past.plot(target)
    assert isinstance(figure, Figure)
    assert target.read_bytes().startswith(head)
    assert list(tmp_path.iterdir()) == [target]


def test_the_panels_are_inked(tmp_path: Path) -> None:
    a, b, path_a, path_b = random_pairs(3)[2]
    recording = so.track(so.Tracker(a, b, 1e-2), path_a, path_b, 1.0)
    recording.plot(tmp_path / "run.png")
    image = imread(tmp_path / "run.png")[..., :3]
    height = image.shape[0]
    for k in range(6):  # no blank stretch of the picture
        part = image[k * height // 6 : (k + 1) * height // 6]
        assert np.mean(part.min(axis=2) < 0.5) > 0.002


def test_other_endings_and_folders_are_refused(past: so.Recording, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"'\.jpg' is not known here.*\.png, \.svg, \.pdf"):
        past.plot(tmp_path / "run.jpg")
    with pytest.raises(FileNotFoundError):
        past.plot(tmp_path / "no" / "run.png")
    assert not list(tmp_path.iterdir())
