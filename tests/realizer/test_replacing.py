"""Replacing blocks, and the time of the next event."""

import numpy as np
import pytest

from .conftest import Play

HELD_OFFER = '<gesture id="g" lexeme="offer" mode="LEFT_HAND" start="0" stroke="1.5" relax="9" end="10"/>'
NOD = '<head id="h" lexeme="NOD" start="0" end="1"/>'


@pytest.mark.parametrize(("composition", "goes_home"), [("REPLACE", True), ("MERGE", False)])
def test_hand_returns_to_rest_only_if_another_block_replaces_its_block(play: Play, composition: str, goes_home: bool):
    play.send("a", HELD_OFFER).until(3.0).send("b", NOD, f'composition="{composition}"')
    robot = play.scene.setup.robot
    arm = list(robot.joints("l_arm"))
    away = np.abs(play.scene.motion.angles(np.array([6.0]))[0] - robot.skeleton.rest)[arm].max()
    assert (away < 0.02) == goes_home
    play.until(12.0)
    assert play.at("b:end") > 3.5
    assert play.was_told("a:g:relax") != goes_home


def test_next_event_of_a_scene_is_the_next_feedback_time(play: Play):
    assert play.scene.next_time == np.inf
    play.send("a", '<head id="h" lexeme="NOD" start="2" end="3"/>')
    assert play.scene.next_time == pytest.approx(play.scene.agenda[0].time)
    play.until(2.5)
    assert 2.5 < play.scene.next_time < 3.5
    play.until(5.0)
    assert play.scene.next_time == np.inf


def test_next_event_while_a_block_waits_is_not_after_the_end_of_the_running_block(play: Play):
    play.send("a", '<head id="h" lexeme="NOD" start="0" end="3"/>').send("b", NOD, 'composition="APPEND"')
    play.until(0.5)
    end = play.scene.blocks[0].end
    looked = []
    while play.scene.blocks and play.scene.blocks[0].id == "a":
        looked.append(play.scene.next_time)
        play.until(play.now + 0.1)
    assert all(time <= end for time in looked)
    assert play.at("b:start") == pytest.approx(play.at("a:end"), abs=0.3)
