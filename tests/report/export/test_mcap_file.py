"""MCAP recordings, read by the library of the format."""

from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.metrics.dry_run import DryRun
from kinesic.report.export.mcap_file import save_mcap
from kinesic.report.export.recording import ExportedMotion

pytest.importorskip("foxglove", reason="the extra mcap is not installed")
Messages = dict[str, list[tuple[float, SimpleNamespace]]]


def read(path: Path) -> Messages:
    """Return all messages by topic, each with its time [s]."""
    reader = pytest.importorskip("mcap.reader")
    factory = pytest.importorskip("mcap_protobuf.decoder").DecoderFactory()
    result: Messages = defaultdict(list)
    with path.open("rb") as file:
        for _, channel, message, content in reader.make_reader(
            file, decoder_factories=[factory]
        ).iter_decoded_messages():
            result[channel.topic].append((message.log_time / 1e9, content))
    return result


@pytest.fixture(scope="module")
def performed(hurried: DryRun, tmp_path_factory: pytest.TempPathFactory) -> Messages:
    path = tmp_path_factory.mktemp("mcap") / "hurried.mcap"
    return read(save_mcap(ExportedMotion.of_performance(hurried), path, force=False))


def positions(messages: list[tuple[float, SimpleNamespace]]) -> np.ndarray:
    return np.array([[joint.position for joint in content.joints] for _, content in messages])


def test_mcap_joint_states_equal_planned_and_measured_motion(hurried: DryRun, performed: Messages):
    planned, measured = performed["/joint_states"], performed["/measured/joint_states"]
    times = np.array([time for time, _ in planned])
    assert np.allclose(times, hurried.measured.times, atol=1e-9)
    assert [joint.name for joint in planned[0][1].joints] == list(hurried.plan.setup.robot.skeleton.names)
    assert np.abs(positions(planned) - hurried.plan.trajectory.sample(hurried.measured.times)[0]).max() < 1e-12
    assert np.abs(positions(measured) - hurried.measured.angles).max() == 0.0
    rates = np.array([[joint.velocity for joint in content.joints] for _, content in planned])
    assert np.abs(rates - hurried.plan.trajectory.sample(hurried.measured.times)[1]).max() < 1e-12
    efforts = np.array([[joint.effort for joint in content.joints] for _, content in measured])
    assert np.abs(efforts - hurried.measured.torques).max() == 0.0
    assert not planned[0][1].joints[0].HasField("effort")


def test_composed_mcap_transforms_give_the_measured_hand_position(hurried: DryRun, performed: Messages):
    """Transforms of a chain, composed as a viewer does, give the forward kinematics."""
    robot, row = hurried.plan.setup.robot, 40
    time, content = performed["/tf"][row]
    moves = {transform.child_frame_id: transform for transform in content.transforms}
    frames = robot.skeleton.frames(np.array(hurried.measured.angles[2 * row]))
    assert time == pytest.approx(hurried.measured.times[2 * row])
    name, place = "r_wrist", np.zeros(3)
    while name != "world":
        move = moves[name]
        vector = np.array([move.rotation.x, move.rotation.y, move.rotation.z])
        twice = 2.0 * np.cross(vector, place)
        place = place + move.rotation.w * twice + np.cross(vector, twice)
        place += np.array([move.translation.x, move.translation.y, move.translation.z])
        name = move.parent_frame_id
    assert np.allclose(place, frames.origins[robot.skeleton.segment("r_wrist")], atol=1e-9)


def test_mcap_scene_attaches_segment_surfaces_to_segment_frames(hurried: DryRun, performed: Messages):
    ((time, scene),) = performed["/scene"]
    segments = {segment.name for segment in hurried.plan.setup.robot.skeleton.segments}
    assert time == 0.0
    assert {entity.frame_id for entity in scene.entities} <= segments
    assert all(entity.frame_locked for entity in scene.entities)
    for triangles in (entity.triangles[0] for entity in scene.entities):
        assert max(triangles.indices) == len(triangles.points) - 1
    assert sum(len(entity.triangles[0].indices) for entity in scene.entities) > 3 * 10_000


def test_mcap_recording_contains_spoken_words_and_sync_points_at_their_times(hurried: DryRun, performed: Messages):
    zero, words = hurried.plan.trajectory.zero, performed["/speech"]
    assert [content.message for _, content in words if content.message] == ["Hello there,", "welcome"]
    two = hurried.plan.syncs["nod:stroke"].planned
    assert words[-1][0] == pytest.approx(zero + two, abs=0.02)
    strokes = {content.name: time for time, content in performed["/behaviours"] if content.message.endswith(" stroke")}
    assert strokes["nod"] == pytest.approx(zero + two, abs=1e-8)


def test_mcap_recording_of_a_plan_has_no_measured_joint_states(calm: DryRun, tmp_path: Path):
    result = read(save_mcap(ExportedMotion.of_plan(calm.plan), tmp_path / "plan.mcap", force=False))
    assert "/measured/joint_states" not in result
    assert "/speech" not in result
    assert len(result["/joint_states"]) == len(calm.plan.command_times)


def test_existing_mcap_file_is_overwritten_only_if_forced(calm: DryRun, tmp_path: Path):
    path, motion = tmp_path / "plan.mcap", ExportedMotion.of_plan(calm.plan)
    path.write_text("mine")
    with pytest.raises(ConfigError, match=r"plan\.mcap"):
        save_mcap(motion, path, force=False)
    assert path.read_text() == "mine"
    save_mcap(motion, path, force=True)
    assert path.read_bytes().startswith(b"\x89MCAP0")
