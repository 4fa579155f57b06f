"""Compact status and bounded waiting."""

import asyncio
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from time import monotonic
from typing import cast

import pytest

from kinesic.mcp.errors import RefusedError
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_line import RobotLine
from kinesic.mcp.robot_status import summarise
from kinesic.mcp.waiting import wait_for_end
from kinesic.planning.setup import Setup

PLAYING = {"block": "a", "starts_in": 0.0, "ends_in": 2.345}
NEXT = {"block": "b", "starts_in": 2.345, "ends_in": 4.0}


@dataclass
class PlayedRobot:
    """Stub robot whose blocks and outcomes follow a script."""

    blocks: list[list[Mapping[str, object]]]  # blocks in the answer to each status request; the last answer repeats
    outcomes: dict[str, list[str]] = field(
        default_factory=dict
    )  # outcomes by id of this connection's blocks; the last outcome repeats
    expected: int = 0  # number of status requests until a block of this connection is planned
    status_count: int = 0

    @property
    def documents(self) -> "PlayedRobot":
        return self

    @property
    def is_playing(self) -> bool:
        return self.status_count < self.expected

    def outcome(self, block: str) -> str | None:
        answers = self.outcomes.get(block, [])
        return answers.pop(0) if len(answers) > 1 else answers[0] if answers else None

    async def status(self) -> Mapping[str, object]:
        self.status_count += 1
        blocks = self.blocks.pop(0) if len(self.blocks) > 1 else self.blocks[0]
        return {"robot": "upper22", "state": "playing" if blocks else "resting", "waiting": 0, "blocks": blocks}


def wait(robot: PlayedRobot, block: str, timeout: float = 5.0) -> Mapping[str, object]:
    return asyncio.run(wait_for_end(RobotGate.of(cast(RobotLine, robot), cast(Setup, None)), block, timeout))


def test_status_tool_lists_playing_and_next_blocks_with_the_seconds_left():
    status = {"told": "status", "robot": "upper22", "state": "playing", "servos": None, "late": 0, "waiting": 3}
    assert summarise({**status, "blocks": [PLAYING, NEXT]}, ["g: moved"]) == {
        "robot": "upper22",
        "state": "playing",
        "playing": [{"block": "a", "seconds_left": 2.3}],
        "next": [{"block": "b", "seconds_left": 4.0, "starts_in": 2.3}],
        "documents_not_planned_yet": 3,
        "last_warnings": ["g: moved"],
    }


def test_status_tool_names_an_accepted_block_that_is_being_planned():
    status = {"robot": "upper22", "state": "resting", "waiting": 0, "planning": True, "blocks": []}
    answer = summarise(status, [], ["b", "a"])
    assert answer["documents_not_planned_yet"] == 1
    assert answer["next"] == [{"block": "a"}, {"block": "b"}]
    assert answer["state"] == "starting"
    assert summarise({**status, "state": "stopped"}, [])["state"] == "stopped"


def test_status_tool_reports_settling_after_the_last_block_until_the_robot_rests():
    status = {"robot": "upper22", "state": "playing", "waiting": 0, "blocks": []}
    assert summarise(status, []) == {"robot": "upper22", "state": "settling", "playing": []}
    assert summarise({**status, "waiting": 1}, [])["state"] == "starting"
    assert summarise({**status, "blocks": [PLAYING]}, [])["state"] == "playing"
    assert summarise({**status, "state": "stopped", "waiting": 1}, [])["state"] == "stopped"


def test_status_tool_names_each_accepted_block_once():
    status = {"robot": "upper22", "state": "resting", "waiting": 0, "blocks": [NEXT]}
    assert summarise(status, [], ["b"])["next"] == [{"block": "b", "seconds_left": 4.0, "starts_in": 2.3}]
    assert summarise({**status, "planning": True}, [], ["b"])["next"] == summarise(status, [])["next"]
    assert summarise(status, [])["state"] == "starting"


def test_status_tool_omits_an_accepted_block_that_has_just_ended():
    resting = summarise({"robot": "upper22", "state": "resting", "waiting": 0, "blocks": []}, [], ["a"])
    assert resting == {"robot": "upper22", "state": "resting", "playing": []}


def test_status_tool_explains_that_stopped_servos_have_torque():
    status = {"robot": "upper22", "state": "stopped", "servos": "armed", "waiting": 0, "blocks": []}
    assert "torque on" in str(summarise(status, [])["note"])
    assert "note" not in summarise({**status, "servos": "limp"}, [])
    assert "note" not in summarise({**status, "state": "playing"}, [])


def test_status_tool_answer_of_a_resting_robot_is_short():
    resting = summarise({"robot": "upper22", "state": "resting", "servos": "armed", "waiting": 0, "blocks": []}, [])
    assert json.dumps(resting) == '{"robot": "upper22", "state": "resting", "playing": [], "servos": "armed"}'


def test_wait_tool_reports_the_outcome_of_a_block_of_this_client():
    robot = PlayedRobot([[PLAYING]], {"a": ["", "", "interrupted"]})
    assert wait(robot, "a") == {"block": "a", "ended": True, "outcome": "interrupted"}


def test_wait_tool_follows_the_block_of_another_client():
    assert wait(PlayedRobot([[PLAYING], [PLAYING], []]), "a") == {"block": "a", "ended": True}


def test_wait_tool_without_block_id_ends_when_no_block_plays():
    assert wait(PlayedRobot([[PLAYING, NEXT], [NEXT], []]), "") == {"ended": True, "state": "resting"}


def test_wait_tool_without_block_id_waits_for_blocks_not_yet_planned():
    robot = PlayedRobot([[], [], [PLAYING], []], expected=3)
    assert wait(robot, "") == {"ended": True, "state": "resting"}
    assert robot.status_count == 4


@pytest.mark.realtime
def test_wait_tool_returns_the_status_after_its_time_limit():
    begun = monotonic()
    answer = wait(PlayedRobot([[PLAYING]], {"a": [""]}), "a", 0.25)
    assert answer["ended"] is False
    assert answer["status"]["playing"] == [{"block": "a", "seconds_left": 2.3}]
    assert 0.25 <= monotonic() - begun < 2.0


@pytest.mark.parametrize(
    ("blocks", "told"), [([PLAYING, NEXT], "; a, b play or wait"), ([], "; nothing plays")], ids=["playing", "resting"]
)
def test_refusal_of_an_unknown_block_states_which_blocks_play_or_wait(blocks: list[Mapping[str, object]], told: str):
    with pytest.raises(RefusedError, match=f"^no block 'c' was performed here{told}$"):
        wait(PlayedRobot([blocks]), "c")


def test_status_tool_gives_the_state_of_a_conversation_only_during_a_conversation():
    status = {"robot": "r", "state": "resting", "blocks": [], "waiting": 0}
    assert "conversation" not in summarise(status, [])
    assert summarise(status, [], conversation="listening")["conversation"] == "listening"
