"""The housing of a robot: one smooth mesh for each segment, kept in a file beside the robot's TOML.

Nothing of it weighs or touches anything: physics keeps the capsules. A file says which description it was made from;
that of another one is not drawn.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.files.array_file import integers_of, numbers_of, read_arrays, text_of

SUFFIX = ".npz"
LARGEST_SHELL = 2_000_000  # [bytes] of a file
UNPACKED = 20_000_000  # [bytes] of what it holds
MOST_VERTICES = 60_000  # of one segment: its triangles count them with 16 bits
TINY = 1e-7  # [m] below which descriptions are the same
Corners = NDArray[np.uint16]


@dataclass(frozen=True, eq=False)
class SegmentShell:
    """The surface of one segment: the housing and, darker, what turns or parts it."""

    vertices: Floats  # (v, 3) [m] in the segment
    normals: Floats  # (v, 3) unit, outward
    shell: Corners  # (t, 3) anticlockwise from outside
    joint: Corners  # (u, 3) likewise: joints and panel lines

    @property
    def triangles(self) -> Corners:
        """(t + u, 3) all of it."""
        return np.concatenate([self.shell, self.joint])


@dataclass(frozen=True, eq=False)
class Shell:
    """The surfaces of a robot, by segment; one that is missing is hidden by another one."""

    segments: Mapping[str, SegmentShell]
    made_from: str  # fingerprint of the description


def shell_of(robot: Robot) -> Shell | None:
    """Reads the shell of a robot; None where there is none, where it is another's, or where the robot has a skin.

    Raises:
        ConfigError: its file is broken.
    """
    if robot.skin is not None or not (path := robot.path.with_suffix(SUFFIX)).is_file():
        return None
    shell = read_shell(path)
    if shell.made_from != fingerprint(robot):
        return None
    if unknown := shell.segments.keys() - {segment.name for segment in robot.skeleton.segments}:
        raise ConfigError(f"{path}: a shell of {min(unknown)}, which {robot.path.name} has not; delete it")
    return shell


def is_stale(robot: Robot) -> bool:
    """Says whether there is a shell beside the robot's file that was made from another description."""
    path = robot.path.with_suffix(SUFFIX)
    return robot.skin is None and path.is_file() and read_shell(path).made_from != fingerprint(robot)


def fingerprint(robot: Robot) -> str:
    """Tells apart what shells are made from: segments, their shapes, hinges, servos and eyes."""
    skeleton, eyes = robot.skeleton, robot.sites.get("eyes")
    words: list[str] = []
    for segment in skeleton.segments:
        words += [segment.name, str(segment.parent), _spell(segment.origin_in_parent)]
        words += [_spell(np.array([*shape.start, *shape.end, shape.radius])) for shape in segment.capsules]
    for hinge, mount in zip(skeleton.hinges, robot.mounts, strict=True):
        size = np.array([mount.drive.count, *mount.drive.servo.size])
        words += [hinge.segment, _spell(hinge.axis), _spell(hinge.at), mount.segment, _spell(mount.position)]
        words.append(_spell(size))
    words += [f"{coupling.segment} {_spell(coupling.axis)}" for coupling in skeleton.couplings]
    words += [f"{name}: {', '.join(members)}" for name, members in sorted(robot.chains.items())]
    words += [] if eyes is None else [eyes.segment, _spell(eyes.position), _spell(eyes.facing)]
    return sha256("\n".join(words).encode()).hexdigest()


def _spell(values: Floats) -> str:
    return " ".join(str(round(float(value) / TINY)) for value in values)


def write_shell(shell: Shell, path: Path) -> None:
    """Writes a shell: places in steps of a 32767th of the largest one, normals in steps of a 127th."""
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
    """Reads a shell.

    Raises:
        ConfigError: the file is broken, or holds more than a robot's shell does.
    """
    try:
        if (size := path.stat().st_size) > LARGEST_SHELL:
            raise ValueError(f"{size} bytes: at most {LARGEST_SHELL} are taken")
        return _unpacked(read_arrays(path, max_size=UNPACKED))
    except (ValueError, OSError, OverflowError) as error:
        raise ConfigError(
            f"{path}: no shell of a robot ({error}); delete it, or make it anew: python -m kinesic.sim.shells.bake "
            f"{path.with_suffix('.toml').name}"
        ) from None


def _unpacked(data: Mapping[str, NDArray[np.generic]]) -> Shell:
    step, made_from = float(numbers_of(data, "step", 0)), str(text_of(data, "made_from", 0))
    if not 0.0 < step < 1.0:
        raise ValueError(f"its step is {step} m")
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
        raise ValueError("its numbers are not as many as it says")
    found, v, t = {}, 0, 0
    for name, (many, light, dark) in zip(names, counts.tolist(), strict=True):
        corners = triangles[t : t + light + dark]
        if len(corners) and int(corners.max()) >= many:
            raise ValueError(f"a triangle of {name} has a corner that is none")
        places, directions = sealed(vertices[v : v + many]), sealed(normals[v : v + many])
        found[str(name)] = SegmentShell(places, directions, corners[:light], corners[light:])
        v, t = v + many, t + light + dark
    return Shell(found, made_from)
