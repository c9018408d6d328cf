"""The regions that are drawn before any run: counts, depths, closed forms, and the distance."""

import numpy as np
import pytest

import standoff as so
from standoff_studies.paper import catalogue, voronoi_figure


@pytest.fixture(scope="module")
def study() -> voronoi_figure.Study:
    return voronoi_figure.study()


def test_the_planar_body_has_six_lines_and_three_branches(study: voronoi_figure.Study) -> None:
    """Fig. 8: six external Voronoi lines and the internal medial axes."""
    assert len(study.planar.external) == 6
    assert len(study.planar.medial_axis) == 3
    assert study.worst_depth < 1e-7


def test_either_way_to_the_nearest_feature_is_the_same(study: voronoi_figure.Study) -> None:
    """Search over the whole boundary, and the certified answer of so.distance."""
    assert study.agreed == (voronoi_figure.POINTS, voronoi_figure.POINTS)


def test_the_lens_has_its_twelve_surfaces(study: voronoi_figure.Study) -> None:
    """Fig. 16's body: at each of three edges two surfaces and two sectors, by closed form."""
    centres = [-0.45 * np.array([np.cos(t), np.sin(t), 0.0]) for t in np.arange(3) * 2 * np.pi / 3]
    sheets = [b for b in study.lens.external if b.features[0].kind == "face"]
    sectors = [b for b in study.lens.external if b.features[0].kind == "edge"]
    assert len(sheets) == len(sectors) == 6
    for sheet in sheets:
        out = sheet.origins - centres[sheet.features[0].index]
        assert np.abs(out - sheet.directions).max() < 1e-13
    for sector in sectors:
        assert (
            np.abs(
                sector.origins - [0, 0, np.sign(sector.origins[0, 2]) * np.sqrt(1 - 0.45**2)]
            ).max()
            < 1e-13
        )
        ends = {tuple(np.round(d, 12)) for d in sector.directions[[0, -1]]}
        tips = sector.origins[0] - np.array(centres)
        assert ends <= {tuple(np.round(d, 12)) for d in tips}


def test_the_figure_states_what_holds() -> None:
    (entry,) = catalogue.chosen(["voronoi"])
    artwork = catalogue.make(entry)
    assert all(s.holds in (True, None) for s in artwork.statements)
    rays = artwork.tables["lens_rays"]
    assert len({len(np.asarray(column)) for column in rays.values()}) == 1
    assert artwork.draw().axes


def test_a_region_is_not_another_features(study: voronoi_figure.Study) -> None:
    """DESIGN.md, section 7: the lens's features at two points, the planar body's at three."""
    assert study.lens.feature_at((1.2, 0.3, 0.4)).kind == "face"
    assert study.lens.feature_at((0.1, 0.05, 1.5)).kind == "vertex"
    assert study.planar.feature_at((1.5, 0.4)) == so.Feature("edge", 0)
    assert study.planar.feature_at((1.6, 0.05)) == so.Feature("vertex", 0)
    assert study.planar.feature_at((0.1, 0.05)) == so.Feature("edge", 0)
