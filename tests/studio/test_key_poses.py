"""Key poses of a gesture in the browser: their order on the timeline, and their recording."""

import json
import tomllib

import pytest

from kinesic.body.robot import Robot

from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
POSE = "document.querySelectorAll('.pose')[{}]"


@pytest.fixture
def edited(studio: Studio) -> Studio:
    """Page with the copy of a gesture of several key poses."""
    studio.page.value("kinesicStudio.files.choose('example', 'welcome'); 0")
    studio.until("s.name === 'welcome.bml' && s.text === s.plannedText")
    studio.page.value("document.querySelector('#lexicon').open = true; 0")
    studio.page.value(
        "(f => { f.value = 'balance'; f.dispatchEvent(new Event('input')) })(document.querySelector('#search'))"
    )
    button = "document.querySelector('[aria-label=\"Edit a copy of balance\"]')"
    studio.page.until(f"{button} !== null")
    studio.page.value(f"{button}.click()")
    studio.until("s.name === 'my_balance.toml' && s.draft?.gesture === 'my_balance' && s.text === s.plannedText")
    return studio


def keys(studio: Studio) -> list[dict[str, object]]:
    return tomllib.loads(studio.state("text"))["gesture"][0]["keys"]


def test_key_pose_dragged_past_another_on_the_studio_timeline_changes_their_order(edited: Studio):
    before = keys(edited)
    assert edited.page.value("document.querySelectorAll('.pose').length") == len(before)
    place = f"(r => [r.x + r.width / 2, r.y + r.height / 2])({POSE}.getBoundingClientRect())"
    edited.page.value(f"{POSE.format(0)}.scrollIntoView({{block: 'center'}})")
    (x, y), (to, _) = (edited.page.value(place.format(k)) for k in (0, 1))
    past = edited.state("past")
    edited.page.drag((x, y), ((x + to) / 2, y), (to + 4, y))
    edited.until(f"s.past === {past} + 1")
    assert keys(edited) == [before[1], before[0], *before[2:]]
    edited.page.value(f"{POSE.format(1)}.focus(), 0")
    edited.page.press("ArrowLeft", 37)
    edited.until(f"s.past === {past} + 2")
    assert keys(edited) == before


def test_studio_shows_a_clicked_key_pose_of_a_gesture_at_its_time(edited: Studio):
    edited.until("s.draft.keys !== undefined")
    last = len(keys(edited)) - 1
    edited.page.value(f"{POSE.format(last)}.click()")
    edited.until(f"Math.abs(s.time - s.draft.times[{last}]) < 0.01")
    pressed = "document.querySelector('#keys [aria-pressed=true]').textContent"
    assert edited.page.value(pressed) == f"Pose {last + 1}"


def test_studio_records_robot_motion_guided_by_hand_as_a_gesture(studio: Studio):
    skeleton = Robot.load().skeleton
    rest, raised = skeleton.rest.tolist(), skeleton.rest.tolist()
    raised[skeleton.joint("r_elbow_flexion")] += 1.2
    torque_off = "Object.defineProperty(kinesicStudio.robot, 'isTorqueOff', {value: true, configurable: true})"
    begin = "(r => { window.hands = r.addReport.bind(r); r.addReport = () => {} })(kinesicStudio.recorder)"
    studio.page.value(f"{torque_off}; {begin}; document.querySelector('#record-gesture').click()")
    for k, angles in enumerate((rest, raised, rest)):
        report = {"time": k / 2, "angles": angles, "planned": rest}
        studio.page.value(f"hands({json.dumps(report)})")
    end = "delete kinesicStudio.recorder.addReport; delete kinesicStudio.robot.isTorqueOff"
    studio.page.value(f"document.querySelector('#record-gesture').click(); {end}")
    studio.until("s.draft?.gesture === 'my_recording' && s.name === 'my_recording.toml'")
    poses = keys(studio)
    assert len(poses) == 3
    assert all([*pose] == ["right"] for pose in poses)
    up = [pose["right"]["at"][1] for pose in poses]
    assert up[1] > up[0] + 0.2 == pytest.approx(up[2] + 0.2)


def test_studio_records_the_drawn_hand_dragged_with_the_mouse_as_a_gesture(studio: Studio):
    studio.page.value("kinesicStudio.files.choose('example', 'welcome'); document.querySelector('#view-front').click()")
    studio.until("s.name === 'welcome.bml' && s.text === s.plannedText && s.left !== null && s.drawn > 0")
    studio.page.value("document.querySelector('#record-gesture').click()")
    hand = studio.state("left")
    x, y = hand["x"], hand["y"]
    for step in ((x + 40, y - 30), (x + 40, y - 90), (x - 20, y - 90)):
        studio.page.drag((x, y), step)
        studio.until("s.reach !== null && !kinesicStudio.view.reaching.busy")
        x, y = (studio.state("left")[axis] for axis in "xy")
    assert studio.state("past") == 0, "the document of the stage stays"
    studio.page.value("document.querySelector('#record-gesture').click()")
    studio.until("s.draft?.gesture === 'my_recording' && s.name === 'my_recording.toml'")
    recorded = tomllib.loads(studio.state("text"))["gesture"][0]
    assert "dragged" in recorded["says"]
    assert len(recorded["keys"]) >= 3
    assert all([*pose] == ["left"] for pose in recorded["keys"])
    outward, up = ([pose["left"]["at"][axis] for pose in recorded["keys"]] for axis in (0, 1))
    assert up[-1] > up[0] + 0.1
    assert max(outward) > outward[-1] + 0.05
