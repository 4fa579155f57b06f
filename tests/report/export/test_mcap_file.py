"""MCAP recordings, read by the library of the format."""

from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.captions import make_captions
from kinesic.report.export.mcap_file import save_mcap
from kinesic.report.export.recording import ExportedMotion, surfaces
from kinesic.sim.part_colours import PART_COLOURS, shell_parts
from kinesic.sim.shells.shell import load_shell

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
    """Compose the transforms of a chain as a viewer does."""
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


def test_mcap_recording_of_a_plan_has_its_angles_and_velocities(calm: DryRun, tmp_path: Path):
    plan = calm.plan
    states = read(save_mcap(ExportedMotion.of_plan(plan), tmp_path / "plan.mcap", force=False))["/joint_states"]
    angles, velocities, _ = plan.trajectory.sample(plan.command_times)
    rates = np.array([[joint.velocity for joint in content.joints] for _, content in states])
    assert np.abs(positions(states) - angles).max() < 1e-12
    assert np.abs(rates - velocities).max() < 1e-12
    assert np.abs(angles - velocities).max() > 0.1
    assert not any(joint.HasField("effort") for _, content in states for joint in content.joints)


def test_mcap_messages_carry_the_time_at_which_they_are_logged(performed: Messages):
    def seconds(stamp: SimpleNamespace) -> float:
        return float(stamp.seconds + stamp.nanos / 1e9)

    for topic in ("/joint_states", "/measured/joint_states", "/speech", "/behaviours"):
        assert performed[topic]
        for time, content in performed[topic]:
            assert seconds(content.timestamp) == pytest.approx(time, abs=1e-9)
    for time, content in performed["/tf"]:
        assert all(seconds(transform.timestamp) == pytest.approx(time, abs=1e-9) for transform in content.transforms)
    assert len(performed["/tf"]) == -(-len(performed["/joint_states"]) // 2)
    assert performed["/joint_states"][-1][0] > 1.5, "seconds are not 0 alone"


def test_measured_mcap_velocities_are_those_of_the_twin(hurried: DryRun, performed: Messages):
    rates = [[joint.velocity for joint in content.joints] for _, content in performed["/measured/joint_states"]]
    assert np.abs(np.array(rates) - hurried.measured.velocities).max() == 0.0


def test_mcap_surfaces_are_opaque_and_hands_have_colours_of_their_own(hurried: DryRun, performed: Messages):
    ((_, scene),) = performed["/scene"]
    robot = hurried.plan.setup.robot
    shell, parts = load_shell(robot), shell_parts(robot)
    assert shell is not None
    seen: dict[str, list[tuple[float, ...]]] = defaultdict(list)
    for entity in scene.entities:
        (triangles,) = entity.triangles
        assert triangles.color.a == 1.0
        seen[entity.frame_id].append((triangles.color.r, triangles.color.g, triangles.color.b))
    assert set(seen) == set(shell.segments)
    for name, surface in shell.segments.items():
        light = PART_COLOURS[parts[name]][:3] if parts[name] in ("l_hand", "r_hand") else (0.90, 0.91, 0.92)
        kinds = ((surface.shell, light), (surface.joint, (0.18, 0.20, 0.24)))
        expected = [colour for triangles, colour in kinds if len(triangles)]
        np.testing.assert_allclose(seen[name], expected, atol=1e-9)
    assert len({entity.id for entity in scene.entities}) == len(scene.entities)


def test_mcap_triangles_are_those_of_the_shell(hurried: DryRun, performed: Messages):
    ((_, scene),) = performed["/scene"]
    shell = load_shell(hurried.plan.setup.robot)
    assert shell is not None
    entity = scene.entities[0]
    (triangles,) = entity.triangles
    points = np.array([[point.x, point.y, point.z] for point in triangles.points])
    part = shell.segments[entity.frame_id]
    rows = part.shell if len(part.shell) else part.joint
    np.testing.assert_allclose(points[np.array(triangles.indices)], part.vertices[rows.ravel()], atol=1e-9)


def test_mcap_capsules_of_limbs_are_light_and_others_dark(hurried: DryRun, tmp_path: Path):
    robot = replace(hurried.plan.setup.robot, path=tmp_path / "robot.toml")
    capsules = {surface.segment: surface.colour for surface in surfaces(robot)}
    assert set(capsules) == {segment.name for segment in robot.skeleton.segments if segment.capsules}
    limbs = {name for chain, members in robot.chains.items() if chain != "torso" for name in members}
    assert {capsules[name] for name in capsules if name in limbs} == {(0.90, 0.91, 0.92)}
    assert {capsules[name] for name in capsules if name not in limbs} == {(0.18, 0.20, 0.24)}


def test_words_and_sync_points_exported_to_mcap_have_the_times_of_the_plan(hurried: DryRun):
    motion, plan = ExportedMotion.of_plan(hurried.plan), hurried.plan
    zero = plan.trajectory.zero
    assert [text.time for text in motion.syncs] == sorted(zero + sync.planned for sync in plan.syncs)
    assert {(text.source, text.text.rpartition(" ")[2]) for text in motion.syncs} == {
        (sync.behaviour, sync.sync) for sync in plan.syncs
    }
    assert [(word.time, word.source, word.text) for word in motion.words] == [
        (caption.begin, caption.behaviour, caption.text) for caption in make_captions(plan)
    ]
    assert motion.shown is motion.planned
    performed = ExportedMotion.of_performance(hurried)
    assert performed.shown is performed.measured
    assert list(performed.tracks) == ["planned", "measured"]
    assert list(motion.tracks) == ["planned"]


def test_each_mcap_transform_names_its_parent_segment(hurried: DryRun, performed: Messages):
    skeleton = hurried.plan.setup.robot.skeleton
    names = [segment.name for segment in skeleton.segments]
    _, content = performed["/tf"][0]
    parents = {transform.child_frame_id: transform.parent_frame_id for transform in content.transforms}
    assert parents == {
        name: "world" if parent < 0 else names[parent]
        for name, (parent, _, _) in zip(names, skeleton.steps, strict=True)
    }
