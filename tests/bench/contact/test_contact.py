"""Benchmark of contacts: independent forces, compared plans and collisions with a ball."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.contact import bench_gestures, compare_plans, summarise_plans
from kinesic.bench.contact.collisions import GESTURE_BLOCK, Collision, collide
from kinesic.bench.contact.independent_forces import MujocoContacts
from kinesic.body.impact_policy import find_policy, read_impact_limits
from kinesic.planning.impact_limits import knot_times
from kinesic.planning.setup import Setup
from kinesic.session.documents import read_block
from kinesic.session.plan import plan
from kinesic.session.setup import set_up


@pytest.fixture(scope="module")
def setup() -> Setup:
    return set_up()


def test_contact_ratio_computed_with_mujoco_equals_that_of_the_planner(setup: Setup):
    policy = find_policy("child")
    assert policy is not None
    assert setup.impacts is not None
    trajectory = plan(GESTURE_BLOCK.format("cut"), setup).trajectory
    angles, velocities, _ = trajectory.sample(knot_times(trajectory))
    survey = setup.impacts.survey(angles, velocities, policy.rows)
    ratio = MujocoContacts(setup.robot).largest_ratio(trajectory, policy.rows)
    assert ratio == pytest.approx(survey.values.max(), rel=1e-6)
    assert ratio > 1.0


def test_robot_at_rest_has_a_contact_ratio_of_zero(setup: Setup):
    policy = find_policy("adult")
    assert policy is not None
    trajectory = plan('<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"/>', setup).trajectory
    assert MujocoContacts(setup.robot).largest_ratio(trajectory, policy.rows) == pytest.approx(0.0, abs=1e-9)


def test_large_gesture_planned_near_adults_stays_below_the_contact_force_limit_in_mujoco(setup: Setup):
    lexemes = ("large",)
    blocks = [read_block(GESTURE_BLOCK.format(lexeme), setup, source=lexeme) for lexeme in lexemes]
    compared = compare_plans(blocks, setup)
    assert [entry.name for entry in compared] == list(lexemes)
    assert max(entry.ratio_before for entry in compared) > 1.0 >= max(entry.ratio for entry in compared)
    metrics = {metric.name: metric for metric in summarise_plans("contact", compared)}
    assert metrics["contact.over"].value == 0.0
    assert metrics["contact.over_without_policy"].value == sum(entry.ratio_before > 1.0 for entry in compared)
    late = replace(compared[0], ratio=1.2, shift=0.5, dropped=1)
    worse = {metric.name: metric for metric in summarise_plans("contact", [late, compared[0]])}
    assert (worse["contact.over"].value, worse["contact.over"].ok, worse["contact.over"].why) == (1.0, False, "large")
    assert (worse["contact.shifted"].value, worse["contact.dropped"].value) == (1.0, 1.0)


def test_simulated_collision_with_a_free_ball_has_at_most_the_reported_force(setup: Setup):
    regions = read_impact_limits().regions
    found = list(collide(setup, ["large"], {name: regions[name] for name in ("face", "hand")}, 2, seed=4))
    assert [collision.region for collision in found] == ["face", "hand"]
    assert all(0.2 < collision.ratio <= 1.0 for collision in found)
    again = list(collide(setup, ["large"], {"face": regions["face"]}, 1, seed=4))
    assert again[0].peak == found[0].peak


@pytest.mark.soak
@pytest.mark.parametrize("robot", ["upper22", "upper36"])
def test_random_contacts_with_a_free_ball_never_exceed_their_force_bound(robot: str):
    setup = set_up(robot)
    lexemes = sorted(form.id for form in setup.lexicon.forms)
    ratios = [collision.ratio for collision in collide(setup, lexemes, read_impact_limits().regions, 200)]
    assert max(ratios) <= 1.0
    assert np.median(ratios) > 0.5  # the bound is not far above the forces


@pytest.mark.soak
def test_angry_and_sad_gestures_stay_within_the_contact_limits_near_adults():
    metrics = {metric.name: metric for metric in bench_gestures("upper22", ("angry", "sad"), every=20)}
    assert metrics["contact.upper22.gestures.over"].value == 0.0


def test_collision_ratio_is_the_measured_force_divided_by_its_bound():
    assert Collision("beat", "hand", "l_wrist", 1.0, 50.0, 100.0).ratio == 0.5
