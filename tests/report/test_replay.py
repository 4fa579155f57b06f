"""Data of the page's player, which equal the motion."""

import base64
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.rotation import rotation_about
from kinesic.metrics.dry_run import DryRun
from kinesic.report import replay as module
from kinesic.report.replay import planned_replay_data, replay_data
from kinesic.report.report import report
from kinesic.report.scene import scene_data
from kinesic.sim.shells.shell import load_shell
from tests.performances import bearing


def unpacked(text, kind, frames):
    return np.frombuffer(base64.b64decode(text), dtype=kind).reshape(frames, -1)


def origins(data, angles):
    """Compute the origins (s, 3) of all segments as the player does."""
    frames = []
    for segment in data["segments"]:
        rotation, origin = (np.eye(3), np.zeros(3)) if segment["parent"] < 0 else frames[segment["parent"]]
        origin = origin + rotation @ segment["origin"]
        for hinge in segment["hinges"]:
            turned = rotation @ rotation_about(np.array(hinge["axis"]), angles[hinge["hinge"]])
            origin, rotation = origin + (rotation - turned) @ hinge["at"], turned
        frames.append((rotation, origin))
    return np.stack([origin for _, origin in frames])


def test_replay_has_the_requested_planned_and_measured_motions(hurried: DryRun) -> None:
    data = replay_data(hurried)
    moments = np.linspace(0.0, data["end"], data["frames"])
    assert np.diff(moments).max() <= 1 / module.REPLAY_RATE + 1e-12
    twin, plan, asked = (
        data["step"] * unpacked(data["motions"][name], "<i2", data["frames"]) for name in ("twin", "plan", "asked")
    )
    assert plan == pytest.approx(hurried.plan.trajectory.sample(moments)[0], abs=data["step"])
    at = np.searchsorted(hurried.measured.times, moments[10])
    assert twin[10] == pytest.approx(hurried.measured.angles[at], abs=0.02)
    assert np.abs(asked - plan).max() > 0.1, "this block had to give"
    assert data["step"] < 2e-4
    duties = data["duty_step"] * unpacked(data["duties"], "u1", data["frames"])
    assert duties.max() == pytest.approx(np.abs(hurried.measured.duties).max(), abs=0.1)


def test_replay_segments_have_the_positions_of_forward_kinematics(hurried: DryRun) -> None:
    data, skeleton = replay_data(hurried), hurried.plan.setup.robot.skeleton
    angles = hurried.measured.angles[60]
    assert origins(data, angles) == pytest.approx(skeleton.frames(angles).origins, abs=1e-3)
    assert sum(len(segment["capsules"]) for segment in data["segments"]) == sum(
        len(s.capsules) for s in skeleton.segments
    )
    assert len(data["servos"]) == len(skeleton.hinges)
    assert {"trunk", "limb", "l_hand", "r_hand"} == {segment["colour"] for segment in data["segments"]}
    assert data["screen"]["segment"] == skeleton.segment(hurried.plan.setup.robot.sites["eyes"].segment)
    assert {detail["colour"] for detail in data["details"][4:]} <= {"trunk", "limb", "l_hand", "r_hand"}


def test_robot_shell_unpacked_from_the_replay_data_equals_the_original(hurried: DryRun) -> None:
    data, robot = replay_data(hurried), hurried.plan.setup.robot
    shell = load_shell(robot)
    assert shell is not None
    assert len(data["shells"]) == len(shell.segments)
    for packed in data["shells"]:
        surface = shell.segments[robot.skeleton.segments[packed["segment"]].name]
        places = data["shell_step"] * unpacked(packed["vertices"], "<i2", len(surface.vertices))
        assert places == pytest.approx(surface.vertices, abs=data["shell_step"])
        assert unpacked(packed["shell"], "<u2", len(surface.shell)) == pytest.approx(surface.shell)
        assert packed["colour"] in ("limb", "l_hand", "r_hand")
    assert len(json.dumps(data["shells"])) < 400_000


def test_robot_without_shell_is_drawn_by_capsules_and_rods(hurried: DryRun, tmp_path: Path) -> None:
    robot = hurried.plan.setup.robot
    bare = scene_data(replace(robot, path=tmp_path / "own.toml"))
    assert bare["shells"] == []
    assert len(bare["details"]) > len(scene_data(robot)["details"])


def test_player_marks_show_moved_sync_points_and_strokes(hurried: DryRun, calm: DryRun) -> None:
    kinds = {(mark["behaviour"], mark["sync"]): mark["kind"] for mark in replay_data(hurried)["marks"]}
    assert kinds["rushed", "start"] == "moved"
    assert kinds["nod", "stroke"] == "stroke"
    assert not [mark for mark in replay_data(calm)["marks"] if "moved" in mark["kind"]]
    assert [text for _, _, text in replay_data(hurried)["words"] if text] == ["Hello there,", "welcome"]


def test_replay_beyond_its_limits_has_fewer_frames_and_only_stroke_marks(
    hurried: DryRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_MARKS", 3)
    data = replay_data(hurried, max_frames=20)
    assert data["frames"] == 20
    assert {mark["sync"] for mark in data["marks"]} == {"stroke"}


def test_servo_duties_above_the_replay_maximum_are_clipped(hurried: DryRun) -> None:
    measured = bearing(hurried.measured, np.full_like(hurried.measured.duties, 9.0))
    data = replay_data(replace(hurried, measured=measured))
    assert set(base64.b64decode(data["duties"])) == {255}


def test_replay_and_report_have_the_same_duration(hurried: DryRun) -> None:
    reported = report(hurried, source="x.bml")["timing"]
    assert isinstance(reported, dict)
    end = replay_data(hurried)["end"]
    assert end == reported["duration_s"] == planned_replay_data(hurried.plan)["end"] == hurried.duration
    assert end < hurried.measured.times[-1], "the body settles afterwards"
    stopped = replace(
        hurried,
        measured=replace(hurried.measured, times=hurried.measured.times * 0.5 * end / hurried.measured.times[-1]),
    )
    assert replay_data(stopped)["end"] == stopped.duration == pytest.approx(0.5 * end)
