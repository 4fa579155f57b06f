from itertools import pairwise
from math import degrees, radians

import numpy as np
import pytest

from kinesic.bml.block import Gesture, Torso
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.expressivity.trunk import (
    MAX_TIME_FRACTION,
    RECLINE_ANGLE,
    hold_lean,
    limit_trunk,
    named_lean,
    trunk_direction,
)
from kinesic.expressivity.turns import UPRIGHT_TURN, add_turns, rotation_range, scale_turn, turn_angles


@pytest.mark.parametrize(
    ("lexeme", "torsion", "tilt", "roll"),
    [
        ("BodyLean", 0, 12, 0),
        ("BodyRecline", 0, -12, 0),
        ("LeanLeftAndBack", 0, -12, -12),
        ("LeftSide", 0, 0, -12),
        ("BodyTurnRight", -12, 0, 0),
        ("subtleBodyLean", 0, 6, 0),
        ("Neutral", 0, 0, 0),
    ],
)
def test_words_of_a_trunk_lexeme_set_the_lean_direction(robot, lexeme, torsion, tilt, roll):
    turn = named_lean(Torso(lexeme), robot, 0.0).turn
    assert [degrees(angle) for angle in (turn.torsion, turn.tilt, turn.roll)] == pytest.approx([torsion, tilt, roll])


def test_trunk_leans_at_the_stroke_and_returns_upright(perform, phases):
    frames = perform(("t", Torso("BodyLean"), phases(0, 1, 1, 1, 1, 2, 3)))
    tilts = {frame.time: degrees(frame.torso.tilt) for frame in frames.frames}
    assert tilts == pytest.approx({0: 0, 1: 12, 2: 12, 3: 0})
    assert frames.uses["t"] == {"torso"}
    assert all(frame.given == {"torso"} for frame in frames.frames)


def test_trunk_lean_beyond_the_joint_range_is_clipped_with_a_warning(perform, phases, robot):
    frames = perform(("t", Torso("BodyRecline", amount=1.0), phases(0, 1, 1, 1, 1, 2, 3)))
    assert degrees(frames.frames[1].torso.tilt) == pytest.approx(-15)
    assert any("9.0 deg" in notice.text for notice in frames.notices)


def test_unknown_trunk_movement_is_dropped(perform, phases):
    frames = perform(("t", Torso("jingtry"), phases(0, 1, 1, 1, 1, 2, 3)))
    assert frames.outcomes["t"].kind == "dropped"
    assert "jingtry" in frames.outcomes["t"].why
    assert frames.frames == ()


def styled(**numbers) -> Style:
    """Return a style in which only expressivity moves the trunk."""
    return Style.uniform(Expressivity(**numbers)).changed(["whole_body=0"])


@pytest.fixture
def calm(phases):
    return phases(0, 1, 1, 1.6, 1.6, 2.2, 3.4)


def torso(frames):
    return np.array([turn_angles(frame.torso) for frame in frames.frames])


def test_trunk_stays_upright_during_a_gesture_of_zero_power_and_openness(perform, calm):
    frames = perform(("g", Gesture("beat", "left"), calm), style=styled(power=0.0, spatial=1.0))
    assert not torso(frames).any()
    assert not any("torso" in frame.given for frame in frames.frames)


def test_trunk_rotation_with_a_gesture_grows_with_positive_power_and_is_zero_for_other_power(perform, calm):
    turned = [
        np.abs(torso(perform(("g", Gesture("beat", "left"), calm), style=styled(power=power)))).max()
        for power in (-1.0, 0.0, 0.3, 0.6, 1.0)
    ]
    assert turned[:2] == [0.0, 0.0]
    assert turned[1:] == sorted(turned[1:])
    assert np.radians(2) < turned[-1] < np.radians(15)


def test_trunk_leans_back_with_rising_hands_and_forward_with_falling_hands(perform, calm):
    frames = perform(("g", Gesture("beat", "left"), calm), style=styled(power=1.0))
    at = {sync: frame.torso for frame in frames.frames for _, sync in frame.syncs}
    assert at["ready"].tilt < 0.0 < at["stroke"].tilt
    assert at["start"] == at["end"]
    assert at["stroke"] == at["relax"]


def test_trunk_motion_of_left_and_right_hand_is_mirrored(perform, calm):
    left, right = (
        torso(perform(("g", Gesture("offer", side), calm), style=styled(power=1.0))) for side in ("left", "right")
    )
    np.testing.assert_allclose(left, right * [-1, 1, -1], atol=1e-12)
    assert np.abs(left[:, 0]).max() > 0.0


def test_trunk_reclines_during_a_gesture_in_proportion_to_openness(perform, calm):
    tilts = [
        torso(perform(("g", Gesture("beat", "left"), calm), style=styled(openness=openness)))[:, 1].min()
        for openness in (0.5, 1.0)
    ]
    assert tilts == pytest.approx([-0.5 * RECLINE_ANGLE, -RECLINE_ANGLE])


def test_trunk_motion_with_a_gesture_fits_the_time_between_hand_keys(perform, phases, pace):
    for ready in (0.06, 0.2, 0.5):
        times = phases(0, ready, ready, 2 * ready, 2 * ready, 2.5 * ready, 3 * ready)
        frames = perform(("g", Gesture("beat", "left"), times), style=styled(power=1.0, openness=1.0))
        keys = [(frame.time, frame.torso) for frame in frames.frames if "torso" in frame.given]
        for (begin, a), (end, b) in pairwise(keys):
            least = pace.least_turn_time("torso", add_turns(b, scale_turn(a, -1.0)))
            assert least <= MAX_TIME_FRACTION * (end - begin) * (1 + 1e-9) + 1e-9


def test_crossed_arms_rest_gesture_does_not_move_the_trunk(perform, calm):
    frames = perform(("g", Gesture("arms_crossed"), calm), style=styled(power=1.0, openness=1.0))
    assert not torso(frames).any()


def test_trunk_motion_with_a_gesture_uses_the_torso_power_of_the_style(perform, calm):
    style = styled(power=1.0).changed(["torso.power=0"])
    assert not torso(perform(("g", Gesture("beat", "left"), calm), style=style)).any()


def test_lean_without_a_requested_duration_takes_at_least_0_3_s_and_its_natural_rotation_time(pace):
    at_once = {"start": 1.0, "ready": 1.0, "relax": 2.0, "end": 2.0}
    small, large = (
        hold_lean(turn, at_once, chain="torso", stays=False, pace=pace) for turn in (Turn(tilt=1e-4), Turn(torsion=0.8))
    )
    assert (small.arrive, small.back) == pytest.approx((1.3, 2.3))
    assert large.arrive - 1.0 == pytest.approx(pace.turn_time("torso", Turn(torsion=0.8)))
    assert large.arrive > 1.3


def test_spatial_extent_scales_leans_by_up_to_half(robot):
    leans = [degrees(named_lean(Torso("BodyLean"), robot, spatial).turn.tilt) for spatial in (-1.0, 0.0, 1.0)]
    assert leans == pytest.approx([6, 12, 18])


@pytest.mark.parametrize(
    ("words", "turn"),
    [
        (("turn",), (24, 0, 0)),
        (("turn", "left"), (24, 0, 0)),
        (("turn", "left", "forward"), (24, 24, 0)),
        (("left", "back"), (0, -24, -24)),
        (("left", "right"), None),
        (("bow",), (0, 24, 0)),
        (("forward", "back", "lean"), (0, 24, 0)),
        (("up",), (0, -24, 0)),
        (("upright",), (0, 0, 0)),
        (("whole", "body"), None),
    ],
)
def test_direction_words_of_a_trunk_movement_add_up(words, turn):
    named = trunk_direction(words)
    assert (None if named is None else tuple(map(degrees, turn_angles(named)))) == (
        None if turn is None else pytest.approx(turn)
    )


def test_clipping_below_a_twentieth_of_a_degree_is_not_reported(robot):
    most = rotation_range(robot, "torso")[1]
    assert (
        limit_trunk(most, robot).clipped == limit_trunk(add_turns(most, Turn(tilt=radians(0.04))), robot).clipped == ""
    )
    beyond = limit_trunk(add_turns(most, Turn(tilt=radians(0.06))), robot)
    assert (beyond.turn, beyond.clipped[:7]) == (most, "0.1 deg")


def test_trunk_accompanying_a_gesture_holds_until_relax_and_returns_with_the_hands(perform, calm):
    frames = perform(("g", Gesture("beat", "left"), calm), style=styled(power=1.0, openness=1.0))
    keys = [(frame.time, frame.torso) for frame in frames.frames if "torso" in frame.given]
    assert keys[-1] == (calm["end"], UPRIGHT_TURN)
    assert keys[-2][0] == calm["relax"]
    assert keys[-2][1] == keys[-3][1] != UPRIGHT_TURN
    assert keys[0] == (calm["start"], UPRIGHT_TURN)
