"""Files of the page with their types, and its data on robot, gestures and examples."""

import json

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.report.scene import scene_data
from kinesic.studio.page import PAGE_FOLDER, body_data, page_files

ROBOT, LEXICON = Robot.load(), Lexicon.load()


@pytest.fixture(scope="module")
def files():
    return page_files(ROBOT, LEXICON, style="joyful", document="mine.bml")


def test_studio_page_files_have_media_types_and_index_html_is_served_as_root(files):
    assert {*files} == {
        "/",
        "/studio.json",
        *(f"/{path.name}" for path in PAGE_FOLDER.iterdir() if path.name != "index.html"),
    }
    assert files["/"].type == "text/html; charset=utf-8"
    assert files["/"].body == (PAGE_FOLDER / "index.html").read_bytes()
    scripts = [file for path, file in files.items() if path.endswith(".js")]
    assert scripts
    assert {file.type for file in scripts} == {"text/javascript; charset=utf-8"}
    assert files["/studio.json"].type == "application/json"


def test_studio_page_data_lists_gestures_styles_examples_and_document(files):
    about = json.loads(files["/studio.json"].body)
    assert about["document"] == "mine.bml"
    assert about["styles"][0] == "joyful"
    assert about["styles"][1:] == sorted(about["styles"][1:])
    assert [item["id"] for item in about["gestures"]] == [form.id for form in LEXICON.forms]
    assert about["gestures"][0] == {
        "id": LEXICON.forms[0].id,
        "category": LEXICON.forms[0].category,
        "says": LEXICON.senses[0].says,
    }
    assert about["examples"][0]["name"] == "welcome"
    assert len(about["examples"]) > 8
    assert all("<bml" in item["text"] for item in about["examples"])
    assert about["robot"] == json.loads(json.dumps(body_data(ROBOT)))


def test_body_data_of_the_studio_page_equal_limits_and_rest_posture_of_the_robot():
    result = body_data(ROBOT)
    skeleton = ROBOT.skeleton
    for name in ("rest", "lower", "upper"):
        np.testing.assert_allclose(result[name], getattr(skeleton, name), atol=5.1e-5)
        assert result[name] == [round(angle, 4) for angle in result[name]]
        assert any(angle != round(angle, 3) for angle in result[name]) or name == "lower"
    assert result["hinges"] == list(skeleton.names)
    assert result["names"] == [segment.name for segment in skeleton.segments]
    assert result["hands"] == {side: ROBOT.arm(side).wrist for side in ("l", "r")}
    assert result["elbows"] == {side: ROBOT.arm(side).elbow for side in ("l", "r")}
    assert result["neck"] == skeleton.segment(ROBOT.chains["neck"][0])
    assert result["arm_length"] == round(ROBOT.arm_length, 4)
    np.testing.assert_allclose(result["gesture_origin"], ROBOT.gesture_origin, atol=5.1e-5)
    eyes = ROBOT.sites["eyes"]
    assert result["eyes"]["segment"] == skeleton.segment(eyes.segment)
    np.testing.assert_allclose(result["eyes"]["at"], eyes.position, atol=5.1e-5)
    np.testing.assert_allclose(result["eyes"]["facing"], eyes.facing, atol=5.1e-5)
    assert result.items() >= scene_data(ROBOT).items()
