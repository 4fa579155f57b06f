"""Export of recordings as MCAP files with the message types of Foxglove."""

from pathlib import Path
from typing import TYPE_CHECKING

from kinesic.body.arrays import Floats
from kinesic.files.output_file import new_file
from kinesic.report.export.recording import (
    TRANSFORM_STEP,
    WORLD_FRAME,
    ExportedMotion,
    JointTrack,
    SegmentSurface,
    TimedText,
    surfaces,
)
from kinesic.report.segment_motion import segment_motions

if TYPE_CHECKING:
    from foxglove import Context
    from foxglove.messages import JointStates, Log, SceneEntity

NANOSECONDS_PER_SECOND = 1_000_000_000  # nanoseconds per second
JOINT_TOPICS = {"planned": "/joint_states", "measured": "/measured/joint_states"}  # MCAP topic of each joint track
TRANSFORM_TOPIC = "/tf"  # MCAP topic of segment poses
SCENE_TOPIC = "/scene"  # MCAP topic of the segments' surfaces
WORD_TOPIC = "/speech"  # MCAP topic of spoken words
SYNC_TOPIC = "/behaviours"  # MCAP topic of sync points


def save_mcap(motion: ExportedMotion, path: Path, *, force: bool) -> Path:
    """Write a motion as MCAP and return the path.

    Raises:
        ConfigError: the path is a folder, a link or, unless forced, an existing file.
        ModuleNotFoundError: the package foxglove-sdk is missing.
    """
    import foxglove  # noqa: PLC0415 - an extra

    with new_file(path, force=force) as fresh:
        context = foxglove.Context()
        with foxglove.open_mcap(fresh, allow_overwrite=True, context=context):
            _write_scene(motion, context)
            _write_joints(motion, context)
            _write_transforms(motion, context)
            _write_texts(WORD_TOPIC, motion.words, context)
            _write_texts(SYNC_TOPIC, motion.syncs, context)
    return path


def _write_scene(motion: ExportedMotion, context: "Context") -> None:
    """Write the surfaces of the robot once, each fixed to its segment."""
    from foxglove.channels import SceneUpdateChannel  # noqa: PLC0415 - an extra
    from foxglove.messages import SceneUpdate  # noqa: PLC0415 - an extra

    entities = [_entity(surface, number) for number, surface in enumerate(surfaces(motion.robot))]
    SceneUpdateChannel(SCENE_TOPIC, context=context).log(SceneUpdate(entities=entities), log_time=0)


def _entity(surface: SegmentSurface, number: int) -> "SceneEntity":
    from foxglove.messages import Color, Point3, SceneEntity, Timestamp, TriangleListPrimitive  # noqa: PLC0415 - an extra

    red, green, blue = surface.colour
    triangles = TriangleListPrimitive(
        points=[Point3(x=x, y=y, z=z) for x, y, z in surface.vertices.tolist()],
        indices=surface.triangles.ravel().tolist(),
        color=Color(r=red, g=green, b=blue, a=1.0),
    )
    return SceneEntity(
        timestamp=Timestamp(sec=0),
        frame_id=surface.segment,
        id=f"{surface.segment} {number}",
        frame_locked=True,
        triangles=[triangles],
    )


def _write_joints(motion: ExportedMotion, context: "Context") -> None:
    """Write the joint states of each track, one message per sample."""
    from foxglove.channels import JointStatesChannel  # noqa: PLC0415 - an extra

    for name, track in motion.tracks.items():
        channel = JointStatesChannel(JOINT_TOPICS[name], context=context)
        for k, time in enumerate(motion.times.tolist()):
            channel.log(_joint_states(motion, track, k), log_time=_nanoseconds(time))


def _joint_states(motion: ExportedMotion, track: JointTrack, row: int) -> "JointStates":
    from foxglove.messages import JointState, JointStates, Timestamp  # noqa: PLC0415 - an extra

    efforts: list[float | None] = [None] * track.angles.shape[1]
    if track.torques is not None:
        efforts = track.torques[row].tolist()
    columns = zip(
        motion.robot.skeleton.names, track.angles[row].tolist(), track.velocities[row].tolist(), efforts, strict=True
    )
    return JointStates(
        timestamp=Timestamp(*divmod(_nanoseconds(float(motion.times[row])), NANOSECONDS_PER_SECOND)),
        joints=[
            JointState(name=name, position=angle, velocity=velocity, effort=effort)
            for name, angle, velocity, effort in columns
        ],
    )


def _write_transforms(motion: ExportedMotion, context: "Context") -> None:
    """Write the frames of all segments, relative to their parents."""
    from foxglove.channels import FrameTransformsChannel  # noqa: PLC0415 - an extra
    from foxglove.messages import FrameTransform, FrameTransforms, Quaternion, Timestamp, Vector3  # noqa: PLC0415

    names = [segment.name for segment in motion.robot.skeleton.segments]
    moves = list(segment_motions(motion.robot, motion.shown.angles[::TRANSFORM_STEP]))
    channel = FrameTransformsChannel(TRANSFORM_TOPIC, context=context)
    for k, time in enumerate(motion.times[::TRANSFORM_STEP].tolist()):
        stamp = Timestamp(*divmod(_nanoseconds(time), NANOSECONDS_PER_SECOND))
        transforms = [
            FrameTransform(
                timestamp=stamp,
                parent_frame_id=names[move.parent] if move.parent >= 0 else WORLD_FRAME,
                child_frame_id=names[move.segment],
                translation=Vector3(**_xyz(move.translations[k])),
                rotation=Quaternion(**_xyz(move.rotations[k]), w=float(move.rotations[k, 3])),
            )
            for move in moves
        ]
        channel.log(FrameTransforms(transforms=transforms), log_time=_nanoseconds(time))


def _write_texts(topic: str, texts: tuple[TimedText, ...], context: "Context") -> None:
    from foxglove.channels import LogChannel  # noqa: PLC0415 - an extra

    channel = LogChannel(topic, context=context)
    for entry in texts:
        channel.log(_log(entry), log_time=_nanoseconds(entry.time))


def _log(each: TimedText) -> "Log":
    from foxglove.messages import Log, LogLevel, Timestamp  # noqa: PLC0415 - an extra

    stamp = Timestamp(*divmod(_nanoseconds(each.time), NANOSECONDS_PER_SECOND))
    return Log(timestamp=stamp, level=LogLevel.Info, message=each.text, name=each.source)


def _xyz(values: Floats) -> dict[str, float]:
    x, y, z = values[:3].tolist()
    return {"x": x, "y": y, "z": z}


def _nanoseconds(time: float) -> int:
    return round(time * NANOSECONDS_PER_SECOND)
