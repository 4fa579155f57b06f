"""The face on the line."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.action_units import ASIDE, UPWARD
from kinesic.body.command import NO_FACE
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.perform import plan
from kinesic.controller.play import command_times, commands, pace
from kinesic.expressivity.idle import Idling
from kinesic.expressivity.style.style import Style
from kinesic.planning.face_track import asks_face, commands_with_face, faces, heads, shown_units
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
SMILE = '<faceLexeme id="f" lexeme="smile" amount="1" start="1" attackPeak="1.5" relax="3" end="3.5"/>'


def planned(inside: str, known: Setup) -> Plan:
    return plan(BLOCK.format(inside), known)


@pytest.fixture(scope="module")
def smiling(known: Setup) -> Plan:
    return planned(
        '<speech id="s"><text>Papa, mama.</text></speech><head id="h" lexeme="NOD" stroke="2"/>' + SMILE, known
    )


def test_faces_follow_block_time_on_the_clock_of_the_performance(smiling: Plan):
    times = command_times(smiling.duration)
    rows = faces(smiling, times)
    assert len(rows) == len(times)
    zero = smiling.trajectory.zero
    smile = np.array([row.get("L12", 0.0) for row in rows])
    assert smile[np.searchsorted(times, zero + 2.0)] == pytest.approx(0.9)
    assert smile[np.searchsorted(times, zero + 0.9)] == 0.0
    assert times[np.argmax(smile > 0)] == pytest.approx(zero + 1.0, abs=0.1)


def test_commands_carry_their_face(smiling: Plan):
    times = command_times(smiling.duration)
    setup = smiling.setup
    setpoints = FeedForward(setup.robot, setup.dynamics, terms="none").lead(smiling.trajectory, times)
    rows = faces(smiling, times)
    told = list(commands(smiling.trajectory, times, setpoints, rows))
    assert [command.face for command in told] == list(rows)
    assert all(command.face is NO_FACE for command in commands(smiling.trajectory, times, setpoints))
    drawn = list(commands_with_face(smiling, times))
    for one, other in zip(told, drawn, strict=True):
        assert one.time == other.time
        assert one.face == other.face
        np.testing.assert_array_equal(one.angles, other.angles)


def test_the_lips_close_on_p_and_m(smiling: Plan):
    said, zero = smiling.utterances["s"], smiling.trajectory.zero
    sounds = [sound for sound in said.phonemes if sound.symbol in ("p", "m")]
    assert len(sounds) >= 4
    for sound in sounds:
        middle = zero + smiling.keyframes.timeline.timed[0].times["start"] + sound.start + sound.duration / 2
        assert shown_units(smiling, np.array([middle - 0.01, middle]))["24"][1] > 0.95


def test_the_style_of_the_face_is_used(known: Setup):
    wide = planned(SMILE, replace(known, style=Style.load("neutral").changed(["face.spatial=-1"])))
    plain = planned(SMILE, known)
    moments = np.array([0.0, 2.0])
    assert shown_units(wide, moments + wide.trajectory.zero)["L12"][1] == pytest.approx(
        0.5 * shown_units(plain, moments + plain.trajectory.zero)["L12"][1]
    )


def test_an_expression_that_is_tied_to_a_late_point_comes_with_it(known: Setup):
    found = planned(
        '<head id="a" lexeme="NOD" amount="1" start="0" stroke="0.1" end="0.2"/>'
        '<faceLexeme id="f" lexeme="smile" amount="1" attackPeak="a:end" relax="a:end+1" end="a:end+2"/>',
        known,
    )
    (late,) = [sync for sync in found.syncs if (sync.behaviour, sync.sync) == ("a", "end")]
    assert late.planned > late.asked + 0.1
    times = command_times(found.duration + 3.0)
    smile = np.asarray(shown_units(found, times)["L12"])
    peak = times[np.argmax(smile >= smile.max() - 1e-9)]
    assert peak == pytest.approx(found.trajectory.zero + late.planned, abs=0.015)


def test_eyes_hold_on_while_the_head_nods(known: Setup):
    found = planned('<head id="h" lexeme="NOD" amount="1" stroke="1.5"/>', replace(known, idling=Idling(1.0, 3)))
    times = command_times(found.duration)
    told, stands = shown_units(found, times), heads(found, times)
    assert stands[:, 1].min() < -0.2
    up = told["63"] * UPWARD
    assert np.corrcoef(up, -stands[:, 1])[0, 1] > 0.9
    aside = (told.get("61", 0.0) - told.get("62", 0.0)) * ASIDE + stands[:, 0]
    assert np.abs(aside).max() < 0.12  # what the eyes flit


def test_a_robot_without_a_neck_looks_ahead(known: Setup):
    robot = known.robot
    stiff = replace(robot, chains={name: parts for name, parts in robot.chains.items() if name != "neck"})
    found = planned(SMILE, known)
    np.testing.assert_array_equal(heads(replace(found, setup=replace(known, robot=stiff)), command_times(1.0)), 0.0)


@pytest.mark.parametrize(
    ("inside", "asked"),
    [
        (SMILE, True),
        ('<gaze id="g" target="left" start="0" end="2"/>', True),
        ('<head id="h" lexeme="NOD"/>', False),
        ('<faceLexeme id="f" lexeme="Qwrtz" start="0" end="2"/>', False),
    ],
)
def test_what_asks_for_a_face(known: Setup, inside: str, asked: bool):
    assert asks_face(planned(inside, known)) == asked


def test_paced_commands_come_at_their_times(smiling: Plan):
    now = [100.0]

    def clock() -> float:
        now[0] += 0.02  # each look at the clock takes a while, so that commands are late and nothing sleeps
        return now[0]

    stream = list(commands_with_face(smiling, np.array([0.0, 0.01, 0.02])))
    assert list(pace(stream, clock=clock)) == stream
