import msgspec
import numpy as np
import pytest

from kinesic.body.calibration import NONE, Calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.calibration import Travel, calibration, calibration_text, marks, positive_way

ROBOT = Robot.load()
MANIFEST = Manifest.of(ROBOT)
ZEROS = np.array([2048 + 3 * member.joint for member in MANIFEST.members])


def at(**degrees: float) -> Ticks:
    """Positions of all servos when some hinges are turned; their servos stand the usual way round."""
    moved = [m.turns * degrees.get(m.hinge, 0.0) * TICKS_PER_TURN / 360.0 for m in MANIFEST.members]
    return np.rint(ZEROS + np.array(moved)).astype(np.int64)


def watched(*positions: Ticks) -> Travel:
    travel = Travel.begin(ZEROS)
    for row in positions:
        travel = travel.seen(row, MANIFEST)
    return travel


def found(travel: Travel, before: Calibration = NONE) -> Calibration:
    return calibration(travel, MANIFEST, ROBOT, before)


def test_zeros_are_where_the_servos_stood_whatever_turn_they_counted():
    travel = Travel.begin(ZEROS + 5 * TICKS_PER_TURN)
    assert found(travel).zero_ticks == {m.hinge: int(z) for m, z in zip(MANIFEST.members, ZEROS, strict=True)}


def test_the_first_turn_tells_the_direction_and_trembling_tells_nothing():
    travel = watched(at(vl5_roll=-2, r_elbow_flexion=3), at(vl5_roll=12, r_elbow_flexion=-30), at(vl5_roll=-20))
    seen = found(travel)
    assert seen.inverted["vl5_roll"] is False
    assert seen.inverted["r_elbow_flexion"] is True
    assert travel.ways[0] == 0


def test_an_end_short_of_the_range_is_a_limit_and_one_near_it_is_none():
    travel = watched(at(l_elbow_flexion=100), at(l_elbow_flexion=-1), at(r_elbow_flexion=133.5), at(r_elbow_flexion=2))
    assert found(travel).range_deg == {"l_elbow_flexion": (0.0, 100.0)}
    elbow = marks(travel, MANIFEST, ROBOT)[ROBOT.skeleton.joint("r_elbow_flexion")]
    assert elbow.whole


def test_a_small_move_is_no_limit():
    assert found(watched(at(l_elbow_flexion=40), at())).range_deg == {}


def test_an_inverted_servo_has_its_limits_the_right_way_round():
    travel = watched(at(l_elbow_flexion=-110), at(l_elbow_flexion=0))
    seen = found(travel)
    assert (seen.inverted["l_elbow_flexion"], seen.range_deg["l_elbow_flexion"]) == (True, (0.0, 110.0))


def test_what_was_not_turned_stays_as_it_was():
    before = Calibration("upper22", {}, {"vl5_roll": True}, {"vl5_roll": (-10.0, 20.0), "l_elbow_flexion": (0, 99)})
    seen = found(watched(at(l_elbow_flexion=135), at()), before)
    assert seen.inverted["vl5_roll"] is True
    assert seen.range_deg == {"vl5_roll": (-10.0, 20.0)}


def test_what_is_written_is_read_again():
    seen = found(watched(at(l_elbow_flexion=100), at()))
    assert msgspec.toml.decode(calibration_text(seen, ROBOT), type=Calibration) == seen


@pytest.mark.parametrize(
    ("hinge", "zero", "message"),
    [
        ("l_shoulder_flexion", 2500, "l_shoulder_flexion (servo 12): -50..170 deg would be 1931..4434 ticks"),
        ("skullbase_tilt", 100, "set its horn on anew"),
    ],
)
def test_a_horn_that_is_on_wrongly_is_named(hinge: str, zero: int, message: str):
    zeros = np.where([m.hinge == hinge for m in MANIFEST.members], zero, ZEROS)
    with pytest.raises(ConfigError) as refused:
        found(Travel.begin(zeros))
    assert message in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


def test_a_tandem_must_agree():
    zeros = ZEROS + 57 * np.array([m.id == 3 for m in MANIFEST.members])
    with pytest.raises(ConfigError) as refused:
        found(Travel.begin(zeros))
    assert "vl5_tilt (servo 2, 3): its servos stand 57 ticks apart" in str(refused.value)


def test_a_limit_that_does_not_hold_the_rest_is_refused():
    travel = watched(at(l_elbow_flexion=135), at(l_elbow_flexion=135))
    elbow = ROBOT.skeleton.joint("l_elbow_flexion")
    raised = np.where([m.joint == elbow for m in MANIFEST.members], 400, 0)
    travel = Travel(ZEROS - raised, travel.here, travel.least + raised, travel.most + raised, travel.ways)
    with pytest.raises(ConfigError, match="does not hold its rest of 25 deg"):
        found(travel)


@pytest.mark.parametrize(
    ("hinge", "words"),
    [
        ("vl5_torsion", "the front of vl5 turns to its left"),
        ("vl5_tilt", "vl5 goes forward"),
        ("vl5_roll", "vl5 goes to its right"),
        ("l_shoulder_flexion", "l_shoulder goes forward"),
        ("l_shoulder_abduct", "l_shoulder goes to its left"),
        ("r_shoulder_abduct", "r_shoulder goes to its right"),
        ("r_elbow_twisting", "the front of r_elbow turns to its right"),
        ("l_sternoclavicular_abduct", "l_sternoclavicular goes up"),
    ],
)
def test_the_positive_way_in_words(hinge: str, words: str):
    assert positive_way(ROBOT, ROBOT.skeleton.joint(hinge)) == words
