"""Positions of ROS frames, compared with rotations by hand."""

import numpy as np
import pytest

from kinesic.hardware.ros.frames import FrameTree

QUARTER = {"x": 0.0, "y": 0.0, "z": 2**-0.5, "w": 2**-0.5}  # 90 degrees to the left
UPRIGHT = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}


def transform(child: str, parent: str, origin: tuple[float, ...], rotation: dict[str, float] = UPRIGHT) -> dict:
    pose = {"translation": dict(zip("xyz", origin, strict=True)), "rotation": rotation}
    return {"transforms": [{"header": {"frame_id": parent}, "child_frame_id": child, "transform": pose}]}


def tree(*messages: object) -> FrameTree:
    frames = FrameTree()
    for time, message in enumerate(messages):
        frames.add(message, float(time))
    return frames


def test_position_of_a_person_is_found_through_the_common_root():
    frames = tree(
        transform("base_link", "map", (1.0, 0.0, 0.0), QUARTER),
        transform("camera", "base_link", (0.1, 0.0, 1.2)),
        transform("/person_a", "camera", (2.0, 0.5, 0.3)),
        transform("person_b", "map", (1.0, 3.0, 1.7)),
    )
    assert frames.position("person_a", "base_link") == pytest.approx([2.1, 0.5, 1.5])
    assert frames.position("person_a", "map") == pytest.approx([0.5, 2.1, 1.5])
    assert frames.position("person_b", "base_link") == pytest.approx([3.0, 0.0, 1.7])


def test_any_rotation_and_its_inverse_agree_with_a_rotation_about_its_axis():
    axis, angle = np.array([1.0, 2.0, 2.0]) / 3.0, 0.7
    quaternion = dict(zip("xyz", (2.0 * np.sin(angle / 2) * axis).tolist(), strict=True)) | {"w": 2 * np.cos(angle / 2)}
    frames = tree(transform("turned", "base", (0.0, 0.0, 0.0), quaternion), transform("tip", "turned", (1.0, 0.0, 0.0)))
    point = np.array([1.0, 0.0, 0.0])
    turned = point * np.cos(angle) + np.cross(axis, point) * np.sin(angle) + axis * axis[0] * (1 - np.cos(angle))
    assert frames.position("tip", "base") == pytest.approx(turned)
    assert frames.position("base", "tip") == pytest.approx([-1.0, 0.0, 0.0])


def test_frames_without_a_connection_have_no_position():
    frames = tree(transform("a", "b", (0.0, 0.0, 0.0)), transform("c", "d", (0.0, 0.0, 0.0)))
    assert frames.position("a", "c") is None
    assert frames.position("x", "a") is None


def test_frames_in_a_circle_end_the_search():
    frames = tree(transform("a", "b", (1.0, 0.0, 0.0)), transform("b", "a", (1.0, 0.0, 0.0)))
    assert frames.position("a", "c") is None


@pytest.mark.parametrize(
    "message",
    [
        None,
        {"transforms": 3},
        {"transforms": [3, {}]},
        transform("a", "", (0.0, 0.0, 0.0)),
        transform("a", "b", (float("nan"), 0.0, 0.0)),
        transform("a", "b", (0.0, 0.0, 0.0), {"x": 0, "y": 0, "z": 0, "w": 0}),
        transform("a", "b", (0.0, 0.0, 0.0), {"x": "0", "y": 0, "z": 0, "w": 1}),
    ],
)
def test_invalid_transforms_are_ignored(message: object):
    assert tree(message).age("a", 1.0) is None


def test_age_of_a_frame_counts_from_its_last_report():
    frames = tree(transform("a", "b", (0.0, 0.0, 0.0)), transform("a", "b", (0.0, 0.0, 0.0)))
    assert frames.age("a", 4.0) == 3.0


def test_frames_beyond_the_largest_number_are_ignored_but_kept_ones_are_updated(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("kinesic.hardware.ros.frames.MAX_FRAMES", 1)
    frames = tree(*(transform(name, "root", (1.0, 0.0, 0.0)) for name in ("a", "b", "a")))
    assert frames.age("b", 9.0) is None
    assert frames.age("a", 9.0) == 7.0
