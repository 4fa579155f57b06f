"""Positions of ROS coordinate frames, from the transforms that ROS publishes."""

from dataclasses import dataclass, field
from math import isfinite

import numpy as np

from kinesic.body.arrays import Floats, sealed

MAX_FRAMES = 2000  # largest number of kept frames
MAX_DEPTH = 100  # largest number of transforms from a frame to its root


@dataclass(frozen=True, eq=False)
class _Transform:
    """Pose of a frame in its parent."""

    parent: str
    rotation: Floats  # (3, 3)
    origin: Floats  # (3,) [m]
    time: float  # [s] clock time of its arrival


@dataclass(eq=False)
class FrameTree:
    """Latest transforms between frames."""

    _transforms: dict[str, _Transform] = field(default_factory=dict)  # by child

    def add(self, message: object, time: float) -> None:
        """Store the transforms of a tf2_msgs/TFMessage that arrived at a time [s].

        Transforms with missing or infinite values are ignored.
        """
        for entry in _list(message, "transforms"):
            child, parent = _text(entry, "child_frame_id"), _text(_part(entry, "header"), "frame_id")
            pose = _part(entry, "transform")
            origin, quaternion = _numbers(_part(pose, "translation"), "xyz"), _numbers(_part(pose, "rotation"), "wxyz")
            is_new = child not in self._transforms and len(self._transforms) >= MAX_FRAMES
            if not child or not parent or origin is None or quaternion is None or is_new:
                continue
            norm = float(np.linalg.norm(quaternion))
            if norm > 0.0:
                self._transforms[child] = _Transform(parent, _rotation(quaternion / norm), origin, time)

    def age(self, frame: str, now: float) -> float | None:
        """Return the time [s] since the frame was last reported, or None."""
        transform = self._transforms.get(frame)
        return None if transform is None else now - transform.time

    def position(self, frame: str, base: str) -> Floats | None:
        """Return the origin (3,) [m] of a frame in another one.

        None if no transforms connect them.
        """
        point, root = self._to_root(frame, np.zeros(3))
        origin, base_root = self._to_root(base, np.zeros(3))
        if root != base_root:
            return None
        axes = [self._to_root(base, axis)[0] - origin for axis in np.eye(3)]
        return sealed(np.array(axes) @ (point - origin))

    def _to_root(self, frame: str, point: Floats) -> tuple[Floats, str]:
        """Return a point in the root of its frame, and the root."""
        for _ in range(MAX_DEPTH):
            transform = self._transforms.get(frame)
            if transform is None:
                break
            point, frame = transform.rotation @ point + transform.origin, transform.parent
        return point, frame


def _rotation(quaternion: Floats) -> Floats:
    """Return the rotation matrix of a unit quaternion (w, x, y, z)."""
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _part(message: object, name: str) -> object:
    return message.get(name) if isinstance(message, dict) else None


def _list(message: object, name: str) -> list[object]:
    part = _part(message, name)
    return part if isinstance(part, list) else []


def _text(message: object, name: str) -> str:
    part = _part(message, name)
    return part.lstrip("/") if isinstance(part, str) else ""


def _numbers(message: object, names: str) -> Floats | None:
    """Return finite numbers of a message, or None."""
    values = [_part(message, name) for name in names]
    if not all(isinstance(value, int | float) and isfinite(value) for value in values):
        return None
    return np.array(values, dtype=np.float64)
