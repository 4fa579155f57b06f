"""Tests of eye, head and trunk rotations in gazes."""

from dataclasses import replace
from math import atan2, degrees, radians

import pytest

from kinesic.bml.block import GAZE_SYNCS, SHIFT_SYNCS, Block, Gaze, Head, NoticeType
from kinesic.body.action_units import MAX_EYE_YAW
from kinesic.expressivity.gaze import aim
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import UPRIGHT_TURN


@pytest.fixture
def looks(robot, pace, context):
    def of(action, dialect="bml-1.0", **changes):
        changed = Pace(replace(robot, **changes), pace.limits)
        return aim(action, context(Block("bml1", (), dialect=dialect), pace=changed))

    return of


def gaze_times(*times):
    return dict(zip(GAZE_SYNCS, times, strict=True))


def frame_at(frames, time):
    return next(frame for frame in frames.frames if frame.time == time)


def test_gaze_turns_to_its_target_and_back(perform):
    frames = perform(("g", Gaze("0.07 0.5 1.13", influence="HEAD"), gaze_times(0.0, 1.0, 2.0, 3.0)))
    assert degrees(frame_at(frames, 1.0).head.torsion) == pytest.approx(75)  # 90 deg exceeds the range of the neck
    assert frame_at(frames, 2.0).head == frame_at(frames, 1.0).head
    assert frames.frames[0].head.torsion == frames.frames[-1].head.torsion == 0
    assert frames.uses["g"] == {"head"}


def test_gaze_points_the_eye_line_at_the_target(looks):
    look = looks(Gaze("1.07 1.0 1.13", influence="HEAD"))
    assert degrees(look.head.torsion) == pytest.approx(45)
    assert look.head.tilt == pytest.approx(0, abs=1e-12)
    assert looks(Gaze("1.07 0 0.13", influence="HEAD")).head.tilt == pytest.approx(radians(40))


def test_trunk_takes_part_in_gaze_rotations_beyond_45_degrees(looks):
    look = looks(Gaze("0.07 1.0 1.13"))
    assert degrees(look.torso.torsion) == pytest.approx(45)
    assert degrees(look.head.torsion) == pytest.approx(90)
    assert looks(Gaze("0.07 1.0 1.13", influence="NECK")).torso.torsion == 0
    assert looks(Gaze("0.5 0.1 1.13")).torso.torsion == 0
    asked = looks(Gaze("0.5 0.1 1.13", influence="WAIST"))
    assert asked.torso.torsion == pytest.approx(0.4 * asked.head.torsion)


def test_gaze_with_eye_influence_turns_the_head_only_beyond_the_eye_range(perform, looks):
    near, far = looks(Gaze("1.07 0.3 1.13", influence="EYES")), looks(Gaze("1.07 1.0 1.13", influence="EYES"))
    assert near.head == near.torso == UPRIGHT_TURN
    assert near.eyes.torsion == pytest.approx(atan2(0.3, 1.0))
    assert far.eyes.torsion == MAX_EYE_YAW
    assert far.head.torsion == pytest.approx(radians(45) - MAX_EYE_YAW)
    frames = perform(("g", Gaze("left", influence="EYES"), gaze_times(0.0, 1.0, 2.0, 3.0)))
    assert frames.outcomes["g"].kind == "realised"


def test_eyes_continue_beyond_the_neck_range(looks):
    look = looks(Gaze("-0.17 1.0 1.13", influence="NECK"))
    assert degrees(look.head.torsion + look.eyes.torsion) == pytest.approx(103.5, abs=0.1)
    assert look.eyes.torsion > 0.1
    assert not look.clipped


def test_robot_without_eyes_looks_with_its_head(robot, looks):
    blind = {name: site for name, site in robot.sites.items() if name != "eyes"}
    result = looks(Gaze("left", influence="EYES"), sites=blind)
    assert result.eyes == UPRIGHT_TURN
    assert result.head.torsion > 0.5
    assert "no eyes" in result.substitute


def test_unknown_target_is_replaced_by_the_audience(perform, looks):
    frames = perform(("g", Gaze("bluebox"), gaze_times(0.0, 1.0, 2.0, 3.0)))
    assert frames.outcomes["g"].kind == "substituted"
    assert [notice.type for notice in frames.notices] == [NoticeType.NO_SUCH_TARGET]
    assert looks(Gaze("bluebox")).head == looks(Gaze("audience")).head
    assert looks(Gaze("bluebox"), targets={}) is None


def test_gaze_offsets_rotate_the_head(looks):
    up = looks(Gaze("1.07 0 1.13", offset_angle=10, offset_direction="UP")).head
    assert degrees(up.tilt) == pytest.approx(-10)
    diagonal = looks(Gaze(offset_angle=20, offset_direction="DOWNLEFT")).head
    assert degrees(diagonal.tilt) == degrees(diagonal.torsion) == pytest.approx(20 / 2**0.5)
    assert looks(Gaze(offset_angle=20)).head.torsion == 0


def test_gaze_offsets_in_bml_drafts_are_fractions_of_50_degrees(looks):
    assert degrees(looks(Gaze(offset_angle=0.2, offset_direction="DOWN"), dialect="none").head.tilt) == pytest.approx(
        10
    )
    assert degrees(looks(Gaze(offset_angle=0.2, offset_direction="DOWN")).head.tilt) == pytest.approx(0.2)


def test_head_returns_after_a_gaze_to_the_permanent_gaze_shift(perform):
    frames = perform(
        ("s", Gaze("1.07 0.5 1.13", shift=True), dict(zip(SHIFT_SYNCS, (0.0, 1.0), strict=True))),
        ("g", Gaze("audience"), gaze_times(2.0, 3.0, 4.0, 5.0)),
    )
    shifted = frame_at(frames, 1.0).head
    assert shifted.torsion > 0.4
    assert frame_at(frames, 3.0).head.torsion == pytest.approx(0, abs=1e-9)
    assert frames.frames[-1].head.torsion == pytest.approx(shifted.torsion)


def test_later_gaze_overrides_an_earlier_gaze_with_a_warning(perform):
    frames = perform(
        ("g1", Gaze("1.07 0.5 1.13"), gaze_times(0.0, 1.0, 3.0, 4.0)),
        ("g2", Gaze("1.07 -0.5 1.13"), gaze_times(2.0, 2.5, 4.5, 5.0)),
    )
    assert frame_at(frames, 2.5).head.torsion == frame_at(frames, 4.5).head.torsion < -0.4
    assert [(notice.id, "g2" in notice.text) for notice in frames.notices] == [("bml1:g1", True)]
    assert {outcome.kind for outcome in frames.outcomes.values()} == {"realised"}


def test_nod_is_added_to_a_gaze(perform, nod_times):
    frames = perform(
        ("g", Gaze("1.07 0.5 1.13"), gaze_times(-1.0, 0.0, 2.0, 3.0)),
        ("h", Head("NOD", amount=1.0), nod_times),
    )
    head = frame_at(frames, 0.5).head
    assert degrees(head.tilt) == pytest.approx(20)
    assert head.torsion > 0.4
