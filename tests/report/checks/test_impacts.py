"""Checks and metrics of contacts with people."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.impact_policy import find_policy
from kinesic.controller.dry_run import dry_run
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.impact_figures import CLAMP_GAP, GAP_STEP, find_closing_gap
from kinesic.planning.setup import Setup
from kinesic.report.checks.impacts import impact_checks
from kinesic.report.impacts import describe_impacts
from kinesic.report.plots.margins import margins
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="{}" start="1.0"/></bml>'


@pytest.fixture(scope="module")
def setup() -> Setup:
    return set_up()


@pytest.fixture(scope="module")
def done(setup: Setup) -> DryRun:
    return dry_run(plan(BLOCK.format("house"), setup))


def under(performance: DryRun, audience) -> DryRun:
    """Return the same motion, judged under the limits of another audience.

    These limits did not shape the motion.
    """
    planned = performance.reference.plan
    judged = replace(planned, setup=replace(planned.setup, policy=find_policy(audience)))
    return replace(performance, reference=replace(performance.reference, plan=judged))


def test_contacts_with_people_are_reported_without_checks_if_there_are_no_contact_limits(done: DryRun):
    assert impact_checks(done) == []
    described = describe_impacts(done)
    assert described is not None
    assert described["near"] == "nobody"
    forces = described["forces"]
    assert forces["face"]["force_n"] > forces["hand"]["force_n"] > forces["chest"]["force_n"] > 50.0
    assert forces["hand"]["limit_n"] is None
    assert "Not safety-rated" in described["note"]


def test_contacts_beyond_the_limits_fail_the_force_and_energy_checks_and_name_the_body_region(done: DryRun):
    found = {check.name: check for check in impact_checks(under(done, "child"))}
    assert set(found) == {"safety.energy", "safety.force", "safety.clamp"}
    assert found["safety.force"].status == found["safety.energy"].status == "fail"
    assert "N on a free face by" in found["safety.force"].where
    figures = done.reference.impacts
    assert figures is not None
    assert found["safety.force"].value == pytest.approx(figures.worst["face"].value / 65)
    assert found["safety.energy"].value == pytest.approx(figures.energies.max())


def test_motion_planned_with_contact_limits_passes_the_contact_checks(setup: Setup):
    near_child = replace(setup, policy=find_policy("child"))
    found = {check.name: check for check in impact_checks(dry_run(plan(BLOCK.format("house"), near_child)))}
    assert found["safety.force"].status == found["safety.energy"].status == "pass"
    assert 0.9 < found["safety.force"].value <= 1.0


def test_reported_contact_energy_is_half_the_effective_mass_times_velocity_squared(done: DryRun, setup: Setup):
    figures = done.reference.impacts
    assert figures is not None
    row = int(figures.energies.argmax())
    angles, velocities, _ = done.plan.trajectory.sample(figures.times[[row]])
    assert setup.impacts is not None
    jacobian = setup.impacts.jacobians(angles, figures.points[[row], -1])[0]
    velocity = jacobian @ velocities[0]
    assert figures.energies[row] > 0.5 * 0.1 * velocity @ velocity  # rotors alone weigh more than 0.1 kg at the hand
    assert figures.energies[row] < 0.5 * 1.0 * velocity @ velocity


def test_clamping_force_of_a_closing_gap_is_limited_by_the_stall_torque_of_the_weakest_hinge(setup: Setup):
    planned = plan(BLOCK.format("clap"), setup)
    gap = find_closing_gap(planned)
    assert gap is not None
    assert gap.gap < CLAMP_GAP
    pair = setup.robot.counted_pairs.index(gap.pair)
    angles = planned.trajectory.angles(np.array([gap.time]))[0]
    forces = []
    for hinge, stall in enumerate(setup.robot.drives.stall):
        moved = np.array([angles, angles])
        moved[1, hinge] += GAP_STEP
        before, after = setup.distances.gaps(moved)[:, pair]
        forces.append(stall * GAP_STEP / max(abs(after - before), 1e-12))
    assert gap.force == pytest.approx(min(forces), rel=1e-6)
    warned = {check.name: check for check in impact_checks(under(dry_run(planned), "adult"))}["safety.clamp"]
    assert warned.status == ("warn" if gap.force > 140 else "pass")


def test_plot_of_limit_margins_contains_contact_forces_and_their_limit(done: DryRun):
    assert "force of a contact with a free hand or chest [N]" in margins(done)
    assert len(margins(under(done, "child"))) > 0
    assert "free hand" not in margins(replace(done, reference=without_model(done)))


def without_model(done: DryRun):
    planned = done.reference.plan
    return replace(done.reference, plan=replace(planned, setup=replace(planned.setup, impacts=None)))
