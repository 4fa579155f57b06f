"""Tests of the face in planned performances."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.action_units import MAX_EYE_ELEVATION, MAX_EYE_YAW
from kinesic.body.command import NO_FACE, command_times
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.play import commands, pace_commands
from kinesic.expressivity.idle import Idling
from kinesic.expressivity.style.style import Style
from kinesic.planning.face_track import (
    commands_with_face,
    compute_action_units,
    compute_faces,
    compute_head_directions,
    needs_face,
)
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
# smile from 1 to 3.5 s
SMILE_ELEMENT = '<faceLexeme id="f" lexeme="smile" amount="1" start="1" attackPeak="1.5" relax="3" end="3.5"/>'


def planned(inside: str, known: Setup) -> Plan:
    return plan(BML_TEMPLATE.format(inside), known)


@pytest.fixture(scope="module")
def smiling(known: Setup) -> Plan:
    return planned(
        '<speech id="s"><text>Papa, mama.</text></speech><head id="h" lexeme="NOD" stroke="2"/>' + SMILE_ELEMENT, known
    )


def test_facial_expression_times_are_relative_to_the_block_start(smiling: Plan):
    times = smiling.command_times
    rows = compute_faces(smiling, times)
    assert len(rows) == len(times)
    zero = smiling.trajectory.zero
    smile = np.array([row.get("L12", 0.0) for row in rows])
    assert smile[np.searchsorted(times, zero + 2.0)] == pytest.approx(0.9)
    assert smile[np.searchsorted(times, zero + 0.9)] == 0.0
    assert times[np.argmax(smile > 0)] == pytest.approx(zero + 1.0, abs=0.1)


def test_servo_commands_contain_the_facial_action_units_of_their_time(smiling: Plan):
    times = smiling.command_times
    setup = smiling.setup
    setpoints = FeedForward(setup.robot, setup.dynamics, terms="none").compute_setpoints(smiling.trajectory, times)
    rows = compute_faces(smiling, times)
    results = list(commands(smiling.trajectory, times, setpoints, rows))
    assert [command.face for command in results] == list(rows)
    assert all(command.face is NO_FACE for command in commands(smiling.trajectory, times, setpoints))
    drawn = list(commands_with_face(smiling, times))
    for one, other in zip(results, drawn, strict=True):
        assert one.time == other.time
        assert one.face == other.face
        np.testing.assert_array_equal(one.angles, other.angles)


def test_lips_of_a_planned_speech_close_on_p_and_m(smiling: Plan):
    said, zero = smiling.utterances["s"], smiling.trajectory.zero
    sounds = [sound for sound in said.phonemes if sound.symbol in ("p", "m")]
    assert len(sounds) >= 4
    for sound in sounds:
        middle = zero + smiling.keyframes.timeline.timed[0].times["start"] + sound.start + sound.duration / 2
        assert compute_action_units(smiling, np.array([middle - 0.01, middle]))["24"][1] > 0.95


def test_face_expressivity_of_the_style_scales_facial_expressions(known: Setup):
    wide = planned(SMILE_ELEMENT, replace(known, style=Style.load("neutral").changed(["face.spatial=-1"])))
    plain = planned(SMILE_ELEMENT, known)
    moments = np.array([0.0, 2.0])
    assert compute_action_units(wide, moments + wide.trajectory.zero)["L12"][1] == pytest.approx(
        0.5 * compute_action_units(plain, moments + plain.trajectory.zero)["L12"][1]
    )


def test_facial_expression_is_delayed_with_the_sync_point_that_it_refers_to(known: Setup):
    result = planned(
        '<head id="a" lexeme="NOD" amount="1" start="0" stroke="0.1" end="0.2"/>'
        '<faceLexeme id="f" lexeme="smile" amount="1" attackPeak="a:end" relax="a:end+1" end="a:end+2"/>',
        known,
    )
    (late,) = [sync for sync in result.syncs if (sync.behaviour, sync.sync) == ("a", "end")]
    assert late.planned > late.requested + 0.1
    times = command_times(result.duration + 3.0)
    smile = np.asarray(compute_action_units(result, times)["L12"])
    peak = times[np.argmax(smile >= smile.max() - 1e-9)]
    assert peak == pytest.approx(result.trajectory.zero + late.planned, abs=0.015)


def test_eyes_stay_on_the_gaze_target_while_the_head_nods(known: Setup):
    result = planned('<head id="h" lexeme="NOD" amount="1" stroke="1.5"/>', replace(known, idling=Idling(1.0, 3)))
    times = result.command_times
    action_units, stands = compute_action_units(result, times), compute_head_directions(result, times)
    assert stands[:, 1].min() < -0.2
    up = action_units["63"] * MAX_EYE_ELEVATION
    assert np.corrcoef(up, -stands[:, 1])[0, 1] > 0.9
    aside = (action_units.get("61", 0.0) - action_units.get("62", 0.0)) * MAX_EYE_YAW + stands[:, 0]
    assert np.abs(aside).max() < 0.12  # what the eyes flit


def test_head_direction_of_a_robot_without_neck_is_straight_ahead(known: Setup):
    robot = known.robot
    stiff = replace(robot, chains={name: parts for name, parts in robot.chains.items() if name != "neck"})
    result = planned(SMILE_ELEMENT, known)
    np.testing.assert_array_equal(
        compute_head_directions(replace(result, setup=replace(known, robot=stiff)), command_times(1.0)), 0.0
    )


@pytest.mark.parametrize(
    ("inside", "asked"),
    [
        (SMILE_ELEMENT, True),
        ('<gaze id="g" target="left" start="0" end="2"/>', True),
        ('<head id="h" lexeme="NOD"/>', False),
        ('<faceLexeme id="f" lexeme="Qwrtz" start="0" end="2"/>', False),
    ],
)
def test_face_is_needed_for_known_expressions_and_gaze_but_not_for_nods(known: Setup, inside: str, asked: bool):
    assert needs_face(planned(inside, known)) == asked


def test_real_time_output_forwards_all_late_commands_in_order(smiling: Plan):
    now = [100.0]

    def clock() -> float:
        now[0] += 0.02  # each look at the clock takes a while, so that commands are late and nothing sleeps
        return now[0]

    stream = list(commands_with_face(smiling, np.array([0.0, 0.01, 0.02])))
    assert list(pace_commands(stream, clock=clock)) == stream
