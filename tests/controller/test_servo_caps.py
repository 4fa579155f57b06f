from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.choices import Audience
from kinesic.body.command import Command
from kinesic.body.impact_policy import find_policy
from kinesic.controller.feedforward import FeedForwardSetpoints
from kinesic.controller.servo_caps import POWER_MARGIN, POWER_RESERVE, VELOCITY_MARGIN, compute_caps
from kinesic.controller.servo_performance import perform_live
from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.servo_factors import NOMINAL_FACTORS

EMPTY_BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"/>'
PACE = 0.7  # [rad/s] largest joint velocity of the supervisor's moves


@pytest.fixture(scope="module")
def setup() -> Setup:
    return set_up(near="adult")


def setpoints_of(setup: Setup, velocity: float, duty: float) -> FeedForwardSetpoints:
    """Return setpoints whose last joint moves back at a velocity [rad/s]."""
    rows = np.zeros((4, len(setup.limits.speed)))
    rows[2:, -1] = -velocity / 100
    duties = np.zeros_like(rows)
    duties[1, -1] = -duty
    return FeedForwardSetpoints(rows, np.zeros_like(rows), np.zeros_like(rows), duties)


def test_caps_are_slightly_above_the_largest_setpoint_velocity_and_duty(setup: Setup):
    caps = compute_caps(setpoints_of(setup, 3.0, 0.6), setup, pace=PACE)
    assert caps.velocities[-1] == pytest.approx(VELOCITY_MARGIN * 3.0)
    assert caps.velocities[:-1] == pytest.approx(VELOCITY_MARGIN * PACE)
    assert caps.duties[-1] == pytest.approx(POWER_MARGIN * 0.6 + POWER_RESERVE)


def test_caps_leave_each_servo_the_power_to_hold_any_posture_and_to_move_to_rest(setup: Setup):
    caps = compute_caps(setpoints_of(setup, 0.0, 0.0), setup, pace=PACE)
    drives, rng = setup.robot.drives, np.random.default_rng(2)
    skeleton = setup.robot.skeleton
    angles = rng.uniform(skeleton.lower, skeleton.upper, (200, len(skeleton.rest)))
    still = np.zeros_like(angles)
    torques = np.abs(setup.dynamics.torques(angles, still, still)).max(axis=0)
    assert (caps.holding >= (torques + drives.frictionloss) / drives.stall).all()
    assert (caps.duties >= caps.holding + PACE / drives.no_load).all()
    arm = [k for k, name in enumerate(skeleton.names) if "elbow" in name or "wrist" in name]
    assert caps.duties[arm].max() < 0.35


def test_caps_never_exceed_full_power(setup: Setup):
    assert compute_caps(setpoints_of(setup, 1.0, 0.99), setup, pace=PACE).duties[-1] == 1.0


class RecordedServos:
    """Servos that record the order of caps and commands, and measure nothing."""

    settings = DEFAULT_SETTINGS

    def __init__(self) -> None:
        self.calls: list[str] = []

    def limit(self, caps: ServoCaps) -> None:
        self.calls.append("limit")

    def write(self, command: Command, /) -> None:
        self.calls.append("write")

    def close(self) -> None:
        self.calls.append("close")

    def history(self) -> tuple[Status, ...]:
        return ()

    def events(self) -> tuple[Note, ...]:
        return ()


@pytest.mark.parametrize(("near", "first"), [("nobody", "write"), ("adult", "limit")])
def test_servos_are_capped_once_before_the_first_command_near_people_only(setup: Setup, near: Audience, first: str):
    planned = replace(plan(EMPTY_BLOCK, setup), setup=replace(setup, policy=find_policy(near)))
    servos = RecordedServos()
    perform_live(SimpleNamespace(plan=planned, servo_estimate=NOMINAL_FACTORS), servos)
    assert servos.calls[0] == first
    assert servos.calls.count("limit") == (near == "adult")
