"""Chains of coupled joints, and hinges with the motor of their gear."""

import pytest

from kinesic.sim.importer.couplings import _narrower, _resolve, _sum
from kinesic.sim.importer.model_tree import Follow


def test_coupling_chain_is_resolved_to_its_independent_driver():
    follows = {"a": Follow("b", 2.0, 0.1), "b": Follow("c", -0.5, 0.2), "c": Follow("motor", 3.0, 0.0)}
    result = _resolve("a", follows)
    assert result.driver == "motor"
    assert (result.ratio, result.offset) == (pytest.approx(-3.0), pytest.approx(0.5))
    assert _resolve("c", follows) == follows["c"]


@pytest.mark.parametrize(
    "follows",
    [
        {"a": Follow("a", 1.0, 0.0)},
        {"a": Follow("b", 1.0, 0.0), "b": Follow("a", 1.0, 0.0)},
        {"a": Follow("b", 1.0, 0.0), "b": Follow("c", 1.0, 0.0), "c": Follow("b", 1.0, 0.0)},
    ],
)
def test_couplings_in_a_circle_have_no_driver(follows):
    assert _resolve("a", follows) is None


def test_gear_has_the_narrower_range_and_the_summed_friction_of_its_two_joints():
    assert [_narrower(*ends, max) for ends in ((None, None), (None, 1.0), (2.0, None), (1.0, 2.0))] == [None, 1, 2, 2]
    assert _narrower(1.0, 2.0, min) == 1.0
    assert [_sum(*pair) for pair in ((None, None), (None, 1.0), (2.0, None), (1.0, 2.0))] == [None, 1, 2, 3]
