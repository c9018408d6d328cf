"""A recorded, jittery motion carries a tool past a lens and a rounded box at rest."""

import pytest
from benchmarks.real_motion import (
    OBSTACLES,
    RECORDING,
    RUNS,
    TOOL,
    TOOL_IN_HAND,
    recorded_motion,
    track,
)

import standoff as so
from oracles.brute import nearest_points
from standoff.motion import Offset
from standoff_studies.oracles import Box, Ellipsoid, Lens, Placed

pytestmark = pytest.mark.skipif(
    not RECORDING.exists(), reason="the recorded motion is not part of the project"
)

ORACLES = {"lens": Lens(0.15, 0.0675), "rounded box": Box(0.16, 0.10, 0.12, 0.02)}
ORACLE_TOOL = Ellipsoid(0.06, 0.03, 0.02)
EQUAL = 1e-10
"""Difference to cold queries, over the pair's size."""


@pytest.fixture(scope="module")
def motion():
    return recorded_motion()


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize("name", OBSTACLES)
def test_every_frame_is_certified_and_equal_to_a_cold_query(name, run, motion):
    record = track(name, RUNS[run], motion)
    print(record)
    assert record.frames == len(motion.times) - 1 > 2900
    assert record.certified == record.cold_certified == record.frames
    assert 0 < record.nearest < 0.02
    assert record.distance_error <= EQUAL
    assert record.witness_error <= EQUAL
    assert record.certificate <= EQUAL
    assert record.same_features == record.frames
    assert record.counts.restarts == 0
    assert record.counts.switches >= 30
    assert {feature.split()[0] for feature in record.features} == {"face", "edge", "vertex"}


@pytest.mark.parametrize("name", OBSTACLES)
def test_cold_queries_are_the_truth(name, motion):
    """Every 50th frame against nearest points proven by their multipliers."""
    body, rest = OBSTACLES[name]
    path = Offset(motion, TOOL_IN_HAND)
    fixed = Placed(ORACLES[name], rest.rotation, rest.translation)
    size = body.size + TOOL.size
    for t in motion.times[::50]:
        pose = path.pose(t)
        known = nearest_points(fixed, Placed(ORACLE_TOOL, pose.rotation, pose.translation))
        found = so.distance(body, TOOL, rest, pose)
        assert abs(found.distance - known.distance) <= 1e-12 * size
        assert abs(found.point_a - known.point_a).max() <= EQUAL * size
        assert abs(found.point_b - known.point_b).max() <= EQUAL * size
        assert found.feature_a.kind == known.feature_a.kind
