"""Recordings as files of the Rerun viewer."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.robot import Robot
from kinesic.files.output_file import new_file
from kinesic.report.export.recording import TRANSFORM_STEP, WORLD_FRAME, ExportedMotion, TimedText, surfaces
from kinesic.report.segment_motion import segment_motions
from kinesic.sim.scene_layout import CAMERA_DIRECTION, find_scene_view

if TYPE_CHECKING:
    from rerun import RecordingStream
    from rerun.blueprint import Blueprint

APPLICATION_ID = "kinesic"  # name of the recordings in the viewer
TIMELINE_NAME = "performance"  # name of the viewer's timeline, which shows performance time
WORD_ENTITY = "speech"  # entity path of spoken words
SYNC_ENTITY = "behaviours"  # entity path of sync points
EYE_DISTANCE = 1.3  # distance of the camera / height of the view
JOINT_ENTITY = "joints"  # parent entity of the joint angles, which are at joints/TRACK/HINGE


def save_rerun(motion: ExportedMotion, path: Path, *, force: bool) -> Path:
    """Write a motion as a Rerun recording and return the path.

    Raises:
        ConfigError: the path is a folder, a link or, unless forced, an existing file.
        ModuleNotFoundError: the package rerun-sdk is missing.
    """
    import rerun  # noqa: PLC0415 - an extra

    with new_file(path, force=force) as fresh, rerun.RecordingStream(APPLICATION_ID) as recording:
        recording.save(fresh, default_blueprint=_blueprint(motion.robot))
        _write_robot(motion, recording)
        _write_joints(motion, recording)
        _write_texts(WORD_ENTITY, motion.words, recording)
        _write_texts(SYNC_ENTITY, motion.syncs, recording)
        recording.flush()
        recording.disconnect()
    return path


def _blueprint(robot: Robot) -> "Blueprint":
    """Return the viewer layout: robot, joint angles, words and sync points."""
    from rerun import blueprint  # noqa: PLC0415 - an extra

    view = find_scene_view(robot)
    towards = np.array(CAMERA_DIRECTION) / np.linalg.norm(CAMERA_DIRECTION)
    eye = blueprint.EyeControls3D(
        position=view.middle + EYE_DISTANCE * view.height * towards, look_target=view.middle, eye_up=(0.0, 0.0, 1.0)
    )
    return blueprint.Blueprint(
        blueprint.Horizontal(
            blueprint.Spatial3DView(origin=WORLD_FRAME, name="robot", eye_controls=eye),
            blueprint.Vertical(
                blueprint.TimeSeriesView(origin=JOINT_ENTITY, name="joint angles [rad]"),
                blueprint.TextLogView(origin="/", contents=[f"/{WORD_ENTITY}", f"/{SYNC_ENTITY}"], name="speech"),
            ),
        ),
        collapse_panels=True,
    )


def _write_robot(motion: ExportedMotion, recording: "RecordingStream") -> None:
    """Write surfaces once, and segment poses relative to their parents."""
    import rerun  # noqa: PLC0415 - an extra

    recording.log(WORLD_FRAME, rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    paths: list[str] = []
    times = rerun.TimeColumn(TIMELINE_NAME, duration=motion.times[::TRANSFORM_STEP])
    for move in segment_motions(motion.robot, motion.shown.angles[::TRANSFORM_STEP]):
        above = paths[move.parent] if move.parent >= 0 else WORLD_FRAME
        paths.append(f"{above}/{motion.robot.skeleton.segments[move.segment].name}")
        columns = rerun.Transform3D.columns(translation=move.translations, quaternion=move.rotations)
        recording.send_columns(paths[-1], indexes=[times], columns=columns)
    for number, surface in enumerate(surfaces(motion.robot)):
        mesh = rerun.Mesh3D(
            vertex_positions=surface.vertices.astype(np.float32),
            vertex_normals=surface.normals.astype(np.float32),
            triangle_indices=surface.triangles.astype(np.uint32),
            albedo_factor=[*surface.colour, 1.0],
        )
        recording.log(f"{paths[motion.robot.skeleton.segment(surface.segment)]}/surface_{number}", mesh, static=True)


def _write_joints(motion: ExportedMotion, recording: "RecordingStream") -> None:
    """Write the angle of each hinge [rad] of each joint track."""
    import rerun  # noqa: PLC0415 - an extra

    times = rerun.TimeColumn(TIMELINE_NAME, duration=motion.times)
    for track_name, track in motion.tracks.items():
        for hinge, name in enumerate(motion.robot.skeleton.names):
            columns = rerun.Scalars.columns(scalars=track.angles[:, hinge])
            recording.send_columns(f"{JOINT_ENTITY}/{track_name}/{name}", indexes=[times], columns=columns)


def _write_texts(entity: str, texts: tuple[TimedText, ...], recording: "RecordingStream") -> None:
    import rerun  # noqa: PLC0415 - an extra

    if texts:
        times = rerun.TimeColumn(TIMELINE_NAME, duration=[entry.time for entry in texts])
        columns = rerun.TextLog.columns(text=[f"{entry.source}: {entry.text}" for entry in texts])
        recording.send_columns(entity, indexes=[times], columns=columns)
