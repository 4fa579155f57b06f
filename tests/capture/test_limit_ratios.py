"""Ratios of a motion to the limits of a robot of two joints."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.capture import certification
from kinesic.capture.certification import angles_between, largest_limit_ratio
from kinesic.capture.violations import Violation, find_violations

NAMES = ("nod", "turn")


def row(*values):
    return np.array(values, float)


def make_limits(**changes):
    """Return limits of two joints, wide except for the given ones."""
    wide = {name: row(1e9, 1e9) for name in ("speed", "acceleration", "jerk", "duty")}
    ranges = {"lower": row(-1, -2), "upper": row(3, 2), "inertial": row(0, 0), "viscous": row(0, 0)}
    return SimpleNamespace(**{**wide, **ranges, **changes})


def make_setup(torques=None, distances=None, **changes):
    """Return a robot of two joints whose pairs are 1 m apart by default."""
    near = SimpleNamespace(distances=np.ones(9), pairs=[("a", "b")] * 9) if distances is None else distances
    return SimpleNamespace(
        limits=make_limits(**changes),
        robot=SimpleNamespace(
            skeleton=SimpleNamespace(names=NAMES), drives=SimpleNamespace(stall=row(2, 4)), min_clearance=0.01
        ),
        dynamics=SimpleNamespace(torques=torques or (lambda angles, velocity, acceleration: 0 * angles)),
        distances=SimpleNamespace(clearance=lambda angles: near),
    )


def bump(size, column=1, count=9):
    """Return angles at the middle of their ranges, with a bump at the fifth sample."""
    angles = np.tile(row(1, 0), (count, 1))
    angles[4, column] += size
    return angles


@pytest.mark.parametrize(
    ("angles", "changes", "limit", "ratio", "time"),
    [
        (bump(2.2, 0), {}, "position", 1.1, 0.04),
        (bump(-2.2, 0), {}, "position", 1.1, 0.04),
        (bump(0.01), {"speed": row(9, 0.8)}, "velocity", 1.25, 0.04),
        (bump(0.01), {"acceleration": row(9e9, 100)}, "acceleration", 2.0, 0.04),
        (bump(0.01), {"jerk": row(9e9, 2e4)}, "jerk", 1.5, 0.04),
        (bump(0.01), {"duty": row(9, 100), "inertial": row(0, 1)}, "duty", 2.0, 0.04),
        (bump(0.01), {"duty": row(9, 0.5), "viscous": row(0, 1)}, "duty", 2.0, 0.04),
    ],
)
def test_limit_violated_by_a_captured_motion_is_reported_with_its_joint_time_and_ratio(
    angles, changes, limit, ratio, time
):
    (found,) = find_violations(angles, make_setup(**changes))
    assert (found.limit, found.part) == (limit, NAMES[int(np.ptp(angles, axis=0).argmax())])
    assert found.ratio == pytest.approx(ratio)
    assert found.time == pytest.approx(time, abs=0.011)


@pytest.mark.parametrize(("ratio", "count"), [(1.0009, 0), (1.0011, 1)])
def test_captured_motion_violates_a_limit_only_if_it_exceeds_it_by_over_a_thousandth(ratio, count):
    assert len(find_violations(bump(2.0 * ratio, 0), make_setup())) == count


def test_fraction_of_a_limit_violation_of_a_clip_counts_only_samples_beyond_the_limit():
    angles = np.tile(row(1, 0), (10, 1))
    angles[3:6, 0] += (2.1, 2.5, 2.0)
    (found,) = [item for item in find_violations(angles, make_setup()) if item.limit == "position"]
    assert (found.ratio, found.time, found.fraction) == (pytest.approx(1.25), 0.04, pytest.approx(0.2))
    assert str(found) == "position of nod: 1.25 times the limit at 0.04 s, 20.0 % of the time"


def test_drive_duty_is_torque_over_stall_torque_plus_velocity_over_free_velocity():
    setup = make_setup(lambda angles, velocity, acceleration: velocity * 3, viscous=row(0.5, 0.25))
    found = {item.part: item for item in find_violations(bump(0.02), setup) if item.limit == "torque"}
    assert found["turn"].ratio == pytest.approx(2.0 * 3 / 4 + 2.0 * 0.25)
    assert set(found) == {"turn"}


@pytest.mark.parametrize("window", [1, 4, 9, 100])
def test_drive_duties_do_not_depend_on_the_number_of_samples_computed_together(monkeypatch, window):
    monkeypatch.setattr("kinesic.capture.violations.SAMPLES_PER_WINDOW", window)
    shapes = []

    def torques(angles, velocity, acceleration):
        shapes.append(len(angles))
        return 8.0 * angles

    angles = np.linspace(0, 1, 9)[:, None] * row(1, 0.9)
    found = {item.part: item.ratio for item in find_violations(angles, make_setup(torques)) if item.limit == "torque"}
    assert found == {"nod": pytest.approx(4.0), "turn": pytest.approx(1.8)}
    assert (max(shapes), sum(shapes)) == (min(window, 9), 9)


def test_body_pairs_too_close_in_a_captured_motion_are_reported_each_with_its_worst_time():
    distances = row(0.01, 0.009, 0.005, 0.02, -0.01, 0.0099, 0.5, 0.5, 0.5)
    pairs = [("arm", "hip"), ("arm", "hip"), ("arm", "hip"), *[("hand", "head")] * 3, *[("arm", "hip")] * 3]
    found = find_violations(bump(0), make_setup(distances=SimpleNamespace(distances=distances, pairs=pairs)))
    assert [(item.limit, item.part, item.time) for item in found] == [
        ("clearance", "hand to head", 0.04),
        ("clearance", "arm to hip", 0.02),
    ]
    assert [item.ratio for item in found] == pytest.approx([3.0, 1.5])
    assert [item.fraction for item in found] == pytest.approx([2 / 9, 2 / 9])


class Still:
    """Trajectory of constant derivatives that records its sample times."""

    start, duration = 2.0, 1.0

    def __init__(self, angles=(1, 0), velocities=(0, 0), accelerations=(0, 0), jerks=(0, 0)):
        self._rows = [row(*values)[None] for values in (angles, velocities, accelerations, jerks)]
        self.times = []

    def sample(self, times):
        self.times.append(times)
        return tuple(self._rows[:3])

    def jerks(self, times):
        self.times.append(times)
        return self._rows[3]


@pytest.mark.parametrize(
    ("trajectory", "changes", "ratio"),
    [
        (Still(), {}, 0.0),
        (Still(angles=(2, 0)), {}, 0.5),
        (Still(angles=(1, -3)), {}, 1.5),
        (Still(angles=(1, 0.25)), {"lower": row(0, 0), "upper": row(2, 0)}, 0.25e9),
        (Still(velocities=(0, -3)), {"speed": row(1, 2)}, 1.5),
        (Still(accelerations=(0, -3)), {"acceleration": row(1, 2)}, 1.5),
        (Still(jerks=(0, -3)), {"jerk": row(1, 2)}, 1.5),
        (
            Still(velocities=(4, 0), accelerations=(2, 0)),
            {"inertial": row(3, 3), "viscous": row(2, 2), "duty": row(10, 1)},
            1.4,
        ),
        (
            Still(velocities=(4, 0), accelerations=(2, 0)),
            {"inertial": row(3, 3), "viscous": row(-2, 2), "duty": row(10, 1)},
            0.2,
        ),
    ],
)
def test_largest_limit_ratio_of_a_trajectory_is_the_largest_of_all_limits(trajectory, changes, ratio):
    assert largest_limit_ratio(trajectory, make_setup(**changes)) == pytest.approx(ratio, abs=1e-6)


def test_largest_limit_ratio_is_searched_at_four_samples_per_knot_interval():
    trajectory = Still()
    largest_limit_ratio(trajectory, make_setup())
    for times in trajectory.times:
        assert (times[0], times[1] - times[0]) == (2.0, pytest.approx(certification.KNOT_INTERVAL / 4))
        assert 3.0 - 1e-2 < times[-1] < 3.0


@pytest.mark.parametrize(
    ("first", "second", "angle"),
    [((1, 0, 0), (0, 2, 0), 90), ((1, 0, 0), (-3, 0, 0), 180), ((1, 1, 0), (1, 0, 0), 45), ((0, 0, 2), (0, 0, 1), 0)],
)
def test_angle_between_vectors_of_any_length_is_zero_to_half_a_turn(first, second, angle):
    assert np.degrees(angles_between(row(*first)[None], row(*second)[None])) == pytest.approx([angle])


def test_limit_violation_of_a_captured_motion_is_described_in_one_line():
    text = str(Violation("jerk", "nod", 1.234, 2.345, 0.1234))
    assert text == "jerk of nod: 2.35 times the limit at 1.23 s, 12.3 % of the time"
