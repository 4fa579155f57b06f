import msgspec
import numpy as np
import pytest

from kinesic.body.calibration import NO_CALIBRATION, Calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.calibration import (
    MIN_RANGE_FRACTION,
    STOP_TOLERANCE,
    HingeCalibration,
    Travel,
    calibration,
    calibration_text,
    describe_positive_direction,
    measure_hinges,
)

DEFAULT_ROBOT = Robot.load()
MANIFEST = Manifest.of(DEFAULT_ROBOT)
ZERO_POSITIONS = np.array([2048 + 3 * member.joint for member in MANIFEST.members])


def at(**degrees: float) -> Ticks:
    """Return positions of all servos with some hinges rotated."""
    moved = [m.turns * degrees.get(m.hinge, 0.0) * TICKS_PER_TURN / 360.0 for m in MANIFEST.members]
    return np.rint(ZERO_POSITIONS + np.array(moved)).astype(np.int64)


def watched(*positions: Ticks) -> Travel:
    travel = Travel.begin(ZERO_POSITIONS)
    for row in positions:
        travel = travel.with_positions(row, MANIFEST)
    return travel


def found(travel: Travel, before: Calibration = NO_CALIBRATION) -> Calibration:
    return calibration(travel, MANIFEST, DEFAULT_ROBOT, before)


def test_calibrated_zeros_ignore_the_turn_count():
    travel = Travel.begin(ZERO_POSITIONS + 5 * TICKS_PER_TURN)
    assert found(travel).zero_ticks == {m.hinge: int(z) for m, z in zip(MANIFEST.members, ZERO_POSITIONS, strict=True)}


def test_calibration_takes_a_hinge_direction_from_the_first_large_rotation():
    travel = watched(at(vl5_roll=-2, r_elbow_flexion=3), at(vl5_roll=12, r_elbow_flexion=-30), at(vl5_roll=-20))
    seen = found(travel)
    assert seen.inverted["vl5_roll"] is False
    assert seen.inverted["r_elbow_flexion"] is True
    assert travel.directions[0] == 0


def test_mechanical_stop_far_inside_the_configured_range_narrows_the_range():
    travel = watched(at(l_elbow_flexion=100), at(l_elbow_flexion=-1), at(r_elbow_flexion=133.5), at(r_elbow_flexion=2))
    assert found(travel).range_deg == {"l_elbow_flexion": (0.0, 100.0)}
    elbow = measure_hinges(travel, MANIFEST, DEFAULT_ROBOT)[DEFAULT_ROBOT.skeleton.joint("r_elbow_flexion")]
    assert elbow.is_whole


def test_hinge_turned_by_little_keeps_its_configured_range_in_the_calibration():
    assert found(watched(at(l_elbow_flexion=40), at())).range_deg == {}


def test_calibrated_range_of_an_inverted_servo_is_in_ascending_order():
    travel = watched(at(l_elbow_flexion=-110), at(l_elbow_flexion=0))
    seen = found(travel)
    assert (seen.inverted["l_elbow_flexion"], seen.range_deg["l_elbow_flexion"]) == (True, (0.0, 110.0))


def test_unturned_hinge_keeps_its_calibration():
    before = Calibration("upper22", {}, {"vl5_roll": True}, {"vl5_roll": (-10.0, 20.0), "l_elbow_flexion": (0, 99)})
    seen = found(watched(at(l_elbow_flexion=135), at()), before)
    assert seen.inverted["vl5_roll"] is True
    assert seen.range_deg == {"vl5_roll": (-10.0, 20.0)}


def test_written_calibration_is_read_back():
    seen = found(watched(at(l_elbow_flexion=100), at()))
    assert msgspec.toml.decode(calibration_text(seen, DEFAULT_ROBOT), type=Calibration) == seen


def test_calibration_without_narrowed_ranges_has_no_table_of_ranges():
    assert "range_deg" not in calibration_text(found(watched()), DEFAULT_ROBOT)


@pytest.mark.parametrize(
    ("hinge", "zero", "message"),
    [
        ("l_shoulder_flexion", 2500, "l_shoulder_flexion (servo 12): -50..170 deg would be 1931..4434 ticks"),
        ("skullbase_tilt", 100, "remount its horn"),
    ],
)
def test_misaligned_servo_horn_is_reported(hinge: str, zero: int, message: str):
    zeros = np.where([m.hinge == hinge for m in MANIFEST.members], zero, ZERO_POSITIONS)
    with pytest.raises(ConfigError) as refused:
        found(Travel.begin(zeros))
    assert message in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize("offset", [-7, 7])
def test_small_offset_of_tandem_servos_is_accepted(offset: int):
    zeros = ZERO_POSITIONS + offset * np.array([m.id == 3 for m in MANIFEST.members])
    assert found(Travel.begin(zeros)).zero_ticks["vl5_tilt"] in {int(zero) for zero in zeros[1:3]}


def test_calibration_of_tandem_servos_with_different_positions_is_refused():
    zeros = ZERO_POSITIONS + 57 * np.array([m.id == 3 for m in MANIFEST.members])
    with pytest.raises(ConfigError) as refused:
        found(Travel.begin(zeros))
    assert "vl5_tilt (servo 2, 3): its servos differ by 57 ticks" in str(refused.value)


def test_calibrated_range_that_excludes_the_rest_angle_is_refused():
    travel = watched(at(l_elbow_flexion=135), at(l_elbow_flexion=135))
    elbow = DEFAULT_ROBOT.skeleton.joint("l_elbow_flexion")
    raised = np.where([m.joint == elbow for m in MANIFEST.members], 400, 0)
    travel = Travel(
        ZERO_POSITIONS - raised, travel.present, travel.lowest + raised, travel.highest + raised, travel.directions
    )
    with pytest.raises(ConfigError, match="excludes its rest of 18 deg"):
        found(travel)


@pytest.mark.parametrize(
    ("hinge", "words"),
    [
        ("vl5_torsion", "front of vl5 turns to its left"),
        ("vl5_tilt", "vl5 goes forward"),
        ("vl5_roll", "vl5 goes to its right"),
        ("l_shoulder_flexion", "l_shoulder goes forward"),
        ("l_shoulder_abduct", "l_shoulder goes to its left"),
        ("r_shoulder_abduct", "r_shoulder goes to its right"),
        ("r_elbow_twisting", "front of r_elbow turns to its right"),
        ("l_sternoclavicular_abduct", "l_sternoclavicular goes up"),
    ],
)
def test_positive_direction_of_a_hinge_is_described_for_calibration(hinge: str, words: str):
    assert describe_positive_direction(DEFAULT_ROBOT, DEFAULT_ROBOT.skeleton.joint(hinge)) == words


SHORT = float(np.degrees(STOP_TOLERANCE))


def turned(lowest: float, highest: float, *, direction: int = 1) -> HingeCalibration:
    """Return the measurements of a hinge with a configured range of -30 to 90 degrees."""
    return HingeCalibration("h", (1,), 2048, direction, 0.0, lowest, highest, -30.0, 90.0)


@pytest.mark.parametrize(
    ("hinge", "is_whole"),
    [
        (turned(-30.0 + SHORT, 90.0 - SHORT), True),
        (turned(-30.0 + SHORT + 0.01, 90.0), False),
        (turned(-30.0, 90.0 - SHORT - 0.01), False),
        (turned(-30.0, 90.0, direction=-1), True),
        (turned(-30.0, 90.0, direction=0), False),
    ],
)
def test_hinge_counts_as_turned_through_its_range_if_it_almost_reached_both_limits(hinge, is_whole):
    assert hinge.is_whole == is_whole
    assert not is_whole or hinge.range is None


@pytest.mark.parametrize(
    ("hinge", "measured"),
    [
        (turned(0.0, MIN_RANGE_FRACTION * 120.0 - 0.1), None),
        (turned(0.0, MIN_RANGE_FRACTION * 120.0 + 0.1), (0.0, round(MIN_RANGE_FRACTION * 120.0 + 0.1, 1))),
        (turned(-30.0 + SHORT, 70.04), (-30.0, 70.0)),
        (turned(-20.06, 90.0 - SHORT), (-20.1, 90.0)),
        (turned(-20.0, 70.0, direction=0), None),
    ],
)
def test_narrower_range_of_a_hinge_is_measured_only_if_enough_of_it_was_seen(hinge, measured):
    assert hinge.range == measured
