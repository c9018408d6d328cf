"""The programs in examples/design do what they say, on less than they take themselves."""

import runpy
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "design"


def test_the_lash_of_many_cams():
    program = runpy.run_path(str(FOLDER / "cam_tolerances.py"))
    found = program["analysed"](20_001, angles=24, remade=8)
    # the roller keeps the nominal lash, and nothing moves it as much as a wrong phase
    assert np.abs(found["exact"] - found["linear"]).max() <= 2e-3
    assert np.abs(found["exact"] - program["LASH"]).max() >= 0.02
    rates = dict(zip(found["names"], found["rates"], strict=True))
    np.testing.assert_allclose(rates["radius"], -1.0, atol=1e-9)
    # on the heel only the base circle counts, on the nose both of its numbers alike
    np.testing.assert_allclose(rates["base"][12], -1.0, atol=1e-9)
    assert abs(rates["nose"][12]) + abs(rates["reach"][12]) + abs(rates["phase"][12]) <= 1e-9
    sizes = np.array([program["DEVIATION"][name] for name in found["names"]])
    np.testing.assert_allclose(
        found["spread"], np.linalg.norm(found["rates"] * sizes[:, None], axis=0), rtol=1e-12
    )
    assert len(found["least"]) == 20_001
    # the least of several angles is less than that of the heel, whose deviation is known
    heel = np.hypot(program["DEVIATION"]["base"], program["DEVIATION"]["radius"])
    assert found["least"].mean() < program["LASH"] - 0.3 * heel
    assert found["least"].std() == pytest.approx(0.032, rel=0.1)


def test_the_backlash_of_gears():
    """One step, as the gears' backlash is all but linear; of a pair of equal gears, one design."""
    program = runpy.run_path(str(FOLDER / "gear_backlash.py"))
    pair = program["Pair"].of((14, 14), 2.5e-3, 13.98)
    a = pair.a.only("thinning")
    pair = pair._replace(a=a, b=a)
    found, rates = program["backlash"](pair, 0.1)
    assert abs(found - program["by_formula"](pair)) <= 1e-12
    assert abs(program["measured"](pair, 0.1) - found) <= 5e-8
    assert abs(rates["thinning"] - 4.0 * program["base"](14)) <= 1e-6
    nearer, farther = (
        program["by_formula"](pair._replace(centres=13.98 + x)) for x in (-1e-4, 1e-4)
    )
    assert abs(rates["centres"] - (farther - nearer) / 2e-4) <= 1e-6
    better = 2.5e-3 - (found - program["WANTED"]) / rates["thinning"]
    assert abs(program["by_formula"](pair.changed(thinning=better)) - program["WANTED"]) <= 1e-9
