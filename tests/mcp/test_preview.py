"""Dry runs: times, deviations and pictures of strokes."""

import asyncio
import json
from base64 import b64encode
from collections.abc import Mapping
from io import BytesIO
from typing import cast

import numpy as np
import pytest
from PIL import Image

from kinesic.bml.block import DocumentBounds
from kinesic.mcp.document_schema import ARM_POSES, BML_SCHEMA, FACE_LEXEMES, GAZE_TARGETS, HAND_MODES, HEAD_MOVEMENTS
from kinesic.mcp.errors import RefusedError
from kinesic.mcp.preview import MAX_FIGURES, Previewer, choose_figures, summarise_plan
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_line import RobotLine
from kinesic.mcp.stroke_picture import FIGURE_HEIGHT, LINE_HEIGHT, StrokeFigure, draw_strokes
from kinesic.serve.desk.draft import draft
from kinesic.session.setup import set_up

SETUP = set_up()
ROBOT = SETUP.robot
HINGES = len(ROBOT.skeleton.rest)


def planned(strokes: int, *, type_: str = "gesture", speech: bool = False) -> dict[str, object]:
    """Answer of the server to a document with a stroke in each second."""
    names = [f"g{k}" for k in range(strokes)]
    behaviours = [{"id": name, "type": type_, "outcome": "realised", "why": ""} for name in names]
    syncs = [{"behaviour": name, "sync": "stroke", "planned": float(k), "asked": 0.0} for k, name in enumerate(names)]
    if speech:
        behaviours.append({"id": "s", "type": "speech", "outcome": "realised", "why": ""})
        syncs += [{"behaviour": "s", "sync": sync, "planned": 0.5, "asked": 0.0} for sync in ("start", "stroke")]
    rows = np.repeat(np.arange(50 * strokes + 1)[:, None] / 50, HINGES, axis=1).astype("<f4")  # [s] as [rad]
    words = [{"speech": "s", "mark": "", "text": " one two ", "start": 0.5, "end": 1.5}]
    values = {"told": "plan", "block": "b", "duration": float(strokes), "rate": 50.0, "notices": []}
    angles = b64encode(rows.tobytes()).decode()
    return {**values, "behaviours": behaviours, "syncs": syncs, "words": words, "angles": angles}


class PlayedRobot:
    """Stub robot that answers a plan."""

    def __init__(self, plan: Mapping[str, object], robot: str = "upper22") -> None:
        self.plan, self.robot = plan, robot

    @property
    def previews(self) -> "PlayedRobot":
        return self

    async def ask(self, verb: str, *, bml: str) -> Mapping[str, object]:
        assert (verb, bml) == ("plan", "<bml/>")
        return self.plan

    async def status(self) -> Mapping[str, object]:
        return {"robot": self.robot, "state": "stopped"}


def preview(robot: PlayedRobot) -> tuple[Mapping[str, object], bytes | None]:
    gate = RobotGate.of(cast(RobotLine, robot), SETUP)
    made = asyncio.run(Previewer(gate).preview(lambda: "<bml/>"))
    return made.answer, made.picture


def test_preview_tool_gives_times_and_a_picture_even_while_the_robot_is_stopped():
    answer, picture = preview(PlayedRobot(planned(2, speech=True)))
    assert answer == {
        "seconds": 2.0,
        "behaviours": [
            {"id": "g0", "type": "gesture", "stroke": 0.0},
            {"id": "g1", "type": "gesture", "stroke": 1.0},
            {"id": "s", "type": "speech", "start": 0.5},
        ],
        "not_as_asked": [],
        "picture": "2 strokes",
    }
    assert picture is not None
    assert picture.startswith(b"\x89PNG")


def test_preview_tool_gives_the_reason_of_a_dropped_behaviour():
    plan = planned(1)
    plan["behaviours"] = [{"id": "g0", "type": "gesture", "outcome": "dropped", "why": "too close"}]
    assert summarise_plan(plan)["behaviours"] == [
        {"id": "g0", "type": "gesture", "dropped": "too close", "stroke": 0.0}
    ]


def test_figures_of_the_preview_tool_show_postures_at_strokes_with_the_spoken_words():
    figures, total = choose_figures(planned(3, speech=True), HINGES)
    assert [(figure.title, figure.note) for figure in figures] == [
        ("g0  0.00 s", ""),
        ("g1  1.00 s", "one two"),
        ("g2  2.00 s", ""),
    ]
    assert total == 3
    assert [float(figure.angles[0]) for figure in figures] == pytest.approx([0.0, 1.0, 2.0])


def test_preview_tool_shows_eight_figures_of_20_strokes_including_the_first_and_the_last():
    figures, total = choose_figures(planned(20), HINGES)
    assert total == 20
    assert len(figures) == MAX_FIGURES
    assert (figures[0].title, figures[-1].title) == ("g0  0.00 s", "g19  19.00 s")
    assert preview(PlayedRobot(planned(20)))[0]["picture"] == "8 of 20 strokes"


def test_preview_tool_shows_a_head_stroke_and_has_no_picture_without_any_stroke():
    assert choose_figures(planned(1, type_="head"), HINGES)[1] == 1
    answer, picture = preview(PlayedRobot(planned(0, speech=True)))
    assert (answer["picture"], picture) == ("no picture: no behaviour has a stroke", None)


def test_preview_tool_gives_no_picture_if_the_server_uses_another_robot():
    answer, picture = preview(PlayedRobot(planned(1), robot="upper36"))
    assert (answer["picture"], picture) == ("no picture: the server performs with another robot", None)


def test_preview_tool_refuses_an_invalid_document():
    error = {"told": "plan", "error": {"line": 1, "column": 1, "text": "not BML"}}
    with pytest.raises(RefusedError, match=r"^line 1, column 1: not BML$"):
        preview(PlayedRobot(error))


def test_picture_of_the_preview_tool_has_a_figure_for_each_posture():
    raised = ROBOT.skeleton.rest.copy()
    raised[[name.startswith("l_shoulder") for name in ROBOT.skeleton.names]] -= 1.0
    one, five = (draw_strokes(ROBOT, [StrokeFigure(raised, "g", "w" * 200)] * count) for count in (1, 5))
    with Image.open(BytesIO(one)) as small, Image.open(BytesIO(five)) as large:
        assert small.height == FIGURE_HEIGHT + 2 * LINE_HEIGHT
        assert (large.width, large.height) == (4 * small.width, 2 * small.height)
        colours = {colour for _, colour in small.convert("RGB").getcolors(10_000)}
        blue = [colour for colour in colours if colour[2] > colour[0] + 60]
        cells = [large.convert("RGB").crop((k * small.width, 0, (k + 1) * small.width, 300)) for k in range(4)]
    assert blue, "the left arm"
    assert len({cell.tobytes() for cell in cells}) == 1, "equal postures look alike"
    assert len(one) < 60_000


def test_all_values_in_the_document_schema_of_the_mcp_tools_are_performed_without_substitution():
    heads = [{"type": "head", "id": f"h{k}", "lexeme": name} for k, name in enumerate(HEAD_MOVEMENTS)]
    faces = [{"type": "face", "id": f"f{k}", "lexeme": name} for k, name in enumerate(FACE_LEXEMES)]
    looks = [{"type": "gaze", "id": f"l{k}", "target": name} for k, name in enumerate(GAZE_TARGETS)]
    poses = [
        {"type": "postureShift", "id": f"p{k}", "pose": [{"part": "ARMS", "lexeme": name}]}
        for k, name in enumerate(ARM_POSES)
    ]
    hands = [{"type": "gesture", "id": f"g{k}", "lexeme": "beat", "mode": name} for k, name in enumerate(HAND_MODES)]
    groups = (heads, faces, looks, poses, hands)
    behaviours = [{**item, "start": 4.0 * k} for group in groups for k, item in enumerate(group)]
    text = json.dumps({"id": "b", "kinesic:style": "calm", "composition": "APPEND", "behaviours": behaviours})
    answer = draft(text, (), SETUP, bounds=DocumentBounds(), max_duration=300.0)
    assert [notice for notice in answer["notices"] if notice["type"] != "IMPOSSIBLE_TO_SCHEDULE"] == []
    assert {item["outcome"] for item in answer["behaviours"]} == {"realised"}
    kinds = [item["properties"]["type"]["const"] for item in BML_SCHEMA["properties"]["behaviours"]["items"]["oneOf"]]
    assert set(kinds) >= {"head", "face", "gaze", "postureShift", "gesture"}
