import numpy as np
import pytest

from kinesic.bml.block import Notice, NoticeType
from kinesic.body.arrays import sealed
from kinesic.body.config import ConfigError
from kinesic.controller.dry_run import dry_run
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.files.bap import BapFrames, read_bap, write_bap
from kinesic.planning.files.imported_motion import (
    MIN_APPROACH_TIME,
    REVERSAL_PROMINENCE,
    _find_reversals,
    _keys,
    plan_imported,
)
from kinesic.report.checks import checks
from kinesic.session.plan import plan

OFFER_DOCUMENT = (  # document with a gesture and a nod
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<gesture id="g" lexeme="offer" stroke="1.5"/><head id="h" lexeme="NOD" start="0.5"/></bml>'
)


@pytest.fixture(scope="module")
def offer(known, tmp_path_factory) -> BapFrames:
    """Return frames of a motion within all limits."""
    path = tmp_path_factory.mktemp("bap") / "offer.bap"
    write_bap(plan(OFFER_DOCUMENT, known).trajectory, known.robot, path)
    return read_bap(path, known.robot)


def at_frames(planned, frames: BapFrames) -> np.ndarray:
    return planned.trajectory.sample(frames.times + planned.trajectory.zero)[0]


def violations(performed: DryRun) -> int:
    results = [check for check in checks(performed) if check.name.startswith("limits.")]
    return sum(check.status == "fail" for check in results)


def test_feasible_imported_motion_is_followed_within_two_degrees(known, offer):
    planned = plan_imported(offer, known, source="offer.bap")
    away = np.degrees(np.abs(at_frames(planned, offer) - offer.angles))
    assert away.max() < 2.0
    assert np.sqrt((away**2).mean()) < 0.3
    assert planned.notices == ()
    np.testing.assert_allclose(planned.motion.planned, planned.motion.requested_times)


def test_imported_motion_begins_and_ends_at_rest(known, offer):
    late = BapFrames(offer.times + 5.0, sealed(offer.angles + 0.2), offer.given, ())
    planned = plan_imported(late, known, source="late.bap")
    motion = planned.trajectory
    np.testing.assert_allclose(motion.at(0.0).angles, known.robot.skeleton.rest, atol=2e-3)
    np.testing.assert_allclose(motion.at(motion.duration).angles, known.robot.skeleton.rest, atol=2e-3)


def test_twin_follows_imported_motion_within_one_degree_and_all_limits(known, offer):
    performed = dry_run(plan_imported(offer, known, source="offer.bap"))
    apart = np.abs(performed.measured.angles - performed.reference.angles).max()
    assert np.degrees(apart) < 1.0
    assert violations(performed) == 0


def test_too_fast_imported_motion_is_slowed_with_a_notice(known, offer):
    fast = BapFrames(sealed(offer.times / 4), offer.angles, offer.given, ())
    planned = plan_imported(fast, known, source="fast.bap")
    assert any("faster than the servos" in notice.text for notice in planned.notices)
    assert violations(dry_run(planned)) == 0


def test_imported_angles_beyond_the_joint_range_are_clipped_and_reported(known, offer):
    elbow = known.robot.skeleton.joint("l_elbow_flexion")
    angles = offer.angles.copy()
    angles[:, elbow] = -0.1
    planned = plan_imported(BapFrames(offer.times, sealed(angles), offer.given, ()), known, source="bent.bap")
    (notice,) = planned.notices
    assert "l_elbow_flexion is requested 5.7 deg beyond its range" in notice.text


def test_single_frame_of_an_imported_motion_is_reached_as_a_posture(known):
    posture = known.robot.skeleton.rest.copy()
    posture[known.robot.skeleton.joint("skullbase_torsion")] = 0.3
    planned = plan_imported(
        BapFrames(sealed([0.0]), sealed([posture]), ("skullbase_torsion",), ()), known, source="one.bap"
    )
    np.testing.assert_allclose(planned.trajectory.at(planned.trajectory.zero).angles, posture, atol=2e-3)


def test_bap_parameters_without_a_hinge_are_reported_and_refused_if_no_parameter_has_one(known, offer):
    legs = BapFrames(offer.times, offer.angles, offer.given, (4, 5))
    (notice,) = plan_imported(legs, known, source="legs.bap").notices
    assert notice == Notice(
        NoticeType.IMPOSSIBLE_TO_SCHEDULE, "motion", "the robot has no hinge for the parameters 4, 5"
    )
    with pytest.raises(ConfigError, match=r"legs\.bap: none of its parameters moves a hinge of upper22"):
        plan_imported(BapFrames(offer.times, offer.angles, (), (4, 5)), known, source="legs.bap")


@pytest.mark.parametrize("begin", [-3.0, 0.0, 7.0])
def test_keys_of_an_imported_motion_are_evenly_spaced_from_its_first_to_its_last_frame(known, begin):
    still = np.tile(known.robot.skeleton.rest, (101, 1))
    times = [key.time - begin for key in _keys(BapFrames(begin + np.linspace(0.0, 1.0, 101), still, (), ()), known)]
    np.testing.assert_allclose(times[1:-1], np.linspace(0.0, 1.0, 11), atol=1e-9)
    assert times[0] == pytest.approx(-MIN_APPROACH_TIME)
    assert times[-1] == pytest.approx(1.0 + MIN_APPROACH_TIME)


def test_notice_of_a_slowed_motion_names_the_posture_with_the_largest_shift(known, offer):
    fast = BapFrames(sealed(offer.times / 4), offer.angles, offer.given, ())
    planned = plan_imported(fast, known, source="fast.bap")
    shifts = (planned.motion.planned - planned.motion.requested_times)[1:-1]
    worst = np.abs(shifts).argmax()
    time = planned.motion.requested_times[1 + worst]
    assert planned.notices[-1].text == (
        f"faster than the servos: the posture of {time:.2f} s is shifted by {shifts[worst]:+.2f} s"
    )


@pytest.mark.parametrize("seed", range(12))
def test_reversals_of_an_imported_hinge_match_the_prominent_peaks_found_by_scipy(seed: int):
    find_peaks = pytest.importorskip(
        "scipy.signal", reason="SciPy, the oracle of this test, is not installed"
    ).find_peaks
    rng = np.random.default_rng(seed)
    angles = np.repeat(np.cumsum(rng.normal(0.0, REVERSAL_PROMINENCE / 2, 200)), rng.integers(1, 5, 200))
    peaks = [find_peaks(sign * angles, prominence=REVERSAL_PROMINENCE)[0] for sign in (1.0, -1.0)]
    np.testing.assert_array_equal(_find_reversals(angles), np.sort(np.concatenate(peaks)))


@pytest.mark.parametrize(
    ("angles", "turns"),
    [
        ([0.3], []),
        ([0.3, 0.3, 0.3], []),
        ([0.0, 0.1, 0.2], []),
        ([0.2, 0.1, 0.1, 0.1, 0.2], [2]),
        ([0.0, 0.2, 0.195, 0.2, 0.0], [1]),
        ([0.0, 0.2, 0.195, 0.21, 0.0, 0.1], [3, 4]),
    ],
    ids=["one frame", "still", "one way", "pause", "equal peaks", "noise"],
)
def test_reversal_is_an_extreme_angle_that_differs_by_more_than_noise(angles, turns):
    assert _find_reversals(np.array(angles)).tolist() == turns
