"""Shell of a robot: one smooth mesh for each segment.

It is stored next to the robot's TOML file. The shell has no mass and no contacts: physics uses the capsules. A shell
file contains a fingerprint of the description from which it was built. A shell of a different description is not drawn.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.files.array_file import integers_of, numbers_of, read_arrays, text_of

SHELL_SUFFIX = ".npz"  # suffix of shell files
MAX_FILE_SIZE = 2_000_000  # [bytes] largest shell file
MAX_UNPACKED_SIZE = 20_000_000  # [bytes] largest total size of a shell file's arrays
FINGERPRINT_RESOLUTION = 1e-7  # [m] grid to which sizes are rounded for the fingerprint
Corners = NDArray[np.uint16]


@dataclass(frozen=True, eq=False)
class SegmentShell:
    """Surface of one segment: light housing, and dark joints and panel lines."""

    vertices: Floats  # (v, 3) [m] in the segment's frame
    normals: Floats  # (v, 3) outward unit vectors
    shell: Corners  # (t, 3) light triangles, counterclockwise from outside
    joint: Corners  # (u, 3) dark triangles of joints and panel lines

    @property
    def triangles(self) -> Corners:
        """All triangles of the housing and the joints, (t + u, 3)."""
        return np.concatenate([self.shell, self.joint])


@dataclass(frozen=True, eq=False)
class Shell:
    """Surfaces of a robot by segment.

    A segment without a surface is hidden inside another one.
    """

    segments: Mapping[str, SegmentShell]
    made_from: str  # fingerprint of the description


def load_shell(robot: Robot) -> Shell | None:
    """Read the shell of a robot from its file, or return None.

    Returns:
        None if there is no file, if it belongs to another description, or if the robot has a skin.

    Raises:
        ConfigError: the file is broken.
    """
    if robot.skin is not None or not (path := robot.path.with_suffix(SHELL_SUFFIX)).is_file():
        return None
    shell = read_shell(path)
    if shell.made_from != fingerprint(robot):
        return None
    if extra_segments := shell.segments.keys() - {segment.name for segment in robot.skeleton.segments}:
        raise ConfigError(
            f"{path}: has a shell of segment {min(extra_segments)}, which {robot.path.name} lacks; delete it"
        )
    return shell


def is_stale(robot: Robot) -> bool:
    """Return whether the shell file belongs to another version of the description."""
    path = robot.path.with_suffix(SHELL_SUFFIX)
    return robot.skin is None and path.is_file() and read_shell(path).made_from != fingerprint(robot)


def fingerprint(robot: Robot) -> str:
    """Return a hash of the robot description's parts that determine the shell.

    It covers segments with their shapes, hinges, servos and eyes.
    """
    return sha256("\n".join(word for _, words in _describe(robot) for word in words).encode()).hexdigest()


def describe_segments(robot: Robot) -> Mapping[str, str]:
    """Return the part of the description that determines each segment's surface."""
    described: dict[str, list[str]] = {segment.name: [] for segment in robot.skeleton.segments}
    for names, words in _describe(robot):
        for name in names:
            described[name] += words
    return {name: "\n".join(words) for name, words in described.items()}


def _describe(robot: Robot) -> Iterator[tuple[Collection[str], list[str]]]:
    """Yield segment names with the description text that determines their surfaces."""
    skeleton, eyes = robot.skeleton, robot.sites.get("eyes")
    for segment in skeleton.segments:
        words = [segment.name, str(segment.parent), _spell(segment.origin_in_parent)]
        words += [_spell(np.array([*shape.start, *shape.end, shape.radius])) for shape in segment.capsules]
        yield (segment.name,), words
    for hinge, mount in zip(skeleton.hinges, robot.mounts, strict=True):
        size = np.array([mount.drive.count, *mount.drive.servo.size])
        words = [hinge.segment, _spell(hinge.axis), _spell(hinge.at), mount.segment, _spell(mount.position)]
        yield {hinge.segment, mount.segment}, [*words, _spell(size)]
    for coupling in skeleton.couplings:
        yield (coupling.segment,), [f"{coupling.segment} {_spell(coupling.axis)}"]
    for name, members in sorted(robot.chains.items()):
        yield members, [f"{name}: {', '.join(members)}"]
    if eyes is not None:
        yield (eyes.segment,), [eyes.segment, _spell(eyes.position), _spell(eyes.facing)]


def _spell(values: Floats) -> str:
    return " ".join(str(round(float(value) / FINGERPRINT_RESOLUTION)) for value in values)


def write_shell(shell: Shell, path: Path) -> None:
    """Write a shell to a compressed file, with rounded positions and normals.

    Positions are rounded to the largest coordinate / 32767, normals to 1 / 127.
    """
    surfaces = shell.segments.values()
    step = max((float(np.abs(s.vertices).max()) for s in surfaces if len(s.vertices)), default=1.0) / 32767
    counts = [(len(s.vertices), len(s.shell), len(s.joint)) for s in surfaces]
    with path.open("wb") as file:
        np.savez_compressed(
            file,
            made_from=np.array(shell.made_from),
            step=np.array(step),
            names=np.array(list(shell.segments), dtype=np.str_),
            counts=np.array(counts, dtype=np.uint32).reshape(-1, 3),
            vertices=np.concatenate([np.rint(s.vertices / step).astype(np.int16) for s in surfaces]),
            normals=np.concatenate([np.rint(127 * s.normals).astype(np.int8) for s in surfaces]),
            triangles=np.concatenate([s.triangles for s in surfaces]),
        )


def read_shell(path: Path) -> Shell:
    """Read a shell file, refusing broken or oversized ones.

    Raises:
        ConfigError: the file is broken or larger than a shell can be.
    """
    try:
        if (size := path.stat().st_size) > MAX_FILE_SIZE:
            raise ValueError(f"{size} bytes, must be at most {MAX_FILE_SIZE}")
        return _unpack(read_arrays(path, max_size=MAX_UNPACKED_SIZE))
    except (ValueError, OSError, OverflowError) as error:
        raise ConfigError(
            f"{path}: not a valid robot shell ({error}); delete it or rebuild it: python -m kinesic.sim.shells.bake "
            f"{path.with_suffix('.toml').name}"
        ) from None


def _unpack(data: Mapping[str, NDArray[np.generic]]) -> Shell:
    step, made_from = float(numbers_of(data, "step", 0)), str(text_of(data, "made_from", 0))
    if not 0.0 < step < 1.0:
        raise ValueError(f"step is {step} m, must be in (0, 1)")
    names, counts = text_of(data, "names", 1), integers_of(data, "counts", 2).astype(np.int64)
    vertices = numbers_of(data, "vertices", 2).astype(np.float64) * step
    normals = numbers_of(data, "normals", 2).astype(np.float64) / 127
    triangles = integers_of(data, "triangles", 2).astype(np.uint16)
    if counts.shape != (len(names), 3):
        raise ValueError(f"counts are {counts.shape}, must be {(len(names), 3)}")
    sums = counts.sum(axis=0)
    if (
        counts.min(initial=0) < 0
        or vertices.shape != (sums[0], 3)
        or normals.shape != (sums[0], 3)
        or triangles.shape != (sums[1] + sums[2], 3)
    ):
        raise ValueError("array sizes contradict the counts")
    segments, v, t = {}, 0, 0
    for name, (vertex_count, shell_count, joint_count) in zip(names, counts.tolist(), strict=True):
        corners = triangles[t : t + shell_count + joint_count]
        if len(corners) and int(corners.max()) >= vertex_count:
            raise ValueError(f"a triangle of {name} has an invalid vertex index")
        places, directions = sealed(vertices[v : v + vertex_count]), sealed(normals[v : v + vertex_count])
        segments[str(name)] = SegmentShell(places, directions, corners[:shell_count], corners[shell_count:])
        v, t = v + vertex_count, t + shell_count + joint_count
    return Shell(segments, made_from)
