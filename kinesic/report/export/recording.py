"""Content of an exported recording: motion, surfaces, words and sync points."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.captions import make_captions
from kinesic.planning.plan import Plan
from kinesic.report.gltf.capsule_mesh import capsule_mesh, join_surfaces
from kinesic.report.labels import label
from kinesic.sim.part_colours import PART_COLOURS, shell_parts
from kinesic.sim.shells.shell import SegmentShell
from kinesic.sim.shells.variant import find_shell

TRANSFORM_STEP = 2  # samples of joint angles per sample of segment motions
WORLD_FRAME = "world"  # name of the coordinate frame in which the root segment stands
LIGHT_COLOUR = (0.90, 0.91, 0.92)  # sRGB colour of housings
DARK_COLOUR = (0.18, 0.20, 0.24)  # sRGB colour of joints and of the torso's capsules


@dataclass(frozen=True, eq=False)
class JointTrack:
    """Angles, velocities and torques of all joints over time."""

    angles: Floats  # (m, n) [rad]
    velocities: Floats  # (m, n) [rad/s]
    torques: Floats | None = None  # (m, n) [Nm]; None: unknown


@dataclass(frozen=True, eq=False)
class TimedText:
    """Text at a time, such as a word or a sync point."""

    time: float  # [s] performance time
    source: str  # id of the behaviour
    text: str


@dataclass(frozen=True, eq=False)
class SegmentSurface:
    """Triangles of one colour on a segment."""

    segment: str
    vertices: Floats  # (v, 3) [m] in the segment
    normals: Floats  # (v, 3) outward
    triangles: NDArray[np.integer]  # (t, 3)
    colour: tuple[float, ...]  # red, green, blue in sRGB, 0..1


@dataclass(frozen=True, eq=False)
class ExportedMotion:
    """Motion of a robot with words and sync points, in performance time."""

    robot: Robot
    times: Floats  # (m,) [s] at the rate of commands
    planned: JointTrack
    measured: JointTrack | None  # in the twin; None: not performed
    words: tuple[TimedText, ...]  # spoken text between two synchronisation marks
    syncs: tuple[TimedText, ...]  # planned sync points

    @classmethod
    def of_plan(cls, plan: Plan) -> "ExportedMotion":
        """Return the planned motion at the times of the commands."""
        times = plan.command_times
        angles, velocities, _ = plan.trajectory.sample(times)
        return cls(plan.setup.robot, times, JointTrack(angles, velocities), None, _words(plan), _syncs(plan))

    @classmethod
    def of_performance(cls, performance: DryRun) -> "ExportedMotion":
        """Return the planned and the twin's measured motion of a performance."""
        plan, measured = performance.plan, performance.measured
        angles, velocities, _ = plan.trajectory.sample(measured.times)
        planned = JointTrack(angles, velocities)
        performed = JointTrack(measured.angles, measured.velocities, measured.torques)
        return cls(plan.setup.robot, measured.times, planned, performed, _words(plan), _syncs(plan))

    @property
    def shown(self) -> JointTrack:
        """Joint states that define the segment poses, measured if available."""
        return self.measured or self.planned

    @property
    def tracks(self) -> Mapping[str, JointTrack]:
        """Planned and, if available, measured joint states, by name."""
        return {"planned": self.planned} | ({} if self.measured is None else {"measured": self.measured})


def surfaces(robot: Robot) -> Iterator[SegmentSurface]:
    """Yield a robot's surfaces: its shell, or capsules if it has none."""
    shell = find_shell(robot)
    if shell is not None:
        parts = shell_parts(robot)
        for name, part in shell.segments.items():
            housing = PART_COLOURS[parts[name]][:3] if parts[name] in ("l_hand", "r_hand") else LIGHT_COLOUR
            for triangles, colour in ((part.shell, housing), (part.joint, DARK_COLOUR)):
                if len(triangles):
                    yield _compact(name, part, triangles, colour)
        return
    limbs = {name for chain, members in robot.chains.items() if chain != "torso" for name in members}
    for segment in robot.skeleton.segments:
        if segment.capsules:
            mesh = join_surfaces([capsule_mesh(capsule) for capsule in segment.capsules])
            colour = LIGHT_COLOUR if segment.name in limbs else DARK_COLOUR
            yield SegmentSurface(segment.name, mesh.positions, mesh.normals, mesh.corners, colour)


def _compact(
    name: str, part: SegmentShell, triangles: NDArray[np.integer], colour: tuple[float, ...]
) -> SegmentSurface:
    """Create a surface from triangles, without unused vertices."""
    used, corners = np.unique(triangles, return_inverse=True)
    return SegmentSurface(name, part.vertices[used], part.normals[used], corners.reshape(-1, 3), colour)


def _words(plan: Plan) -> tuple[TimedText, ...]:
    return tuple(TimedText(caption.begin, caption.behaviour, caption.text) for caption in make_captions(plan))


def _syncs(plan: Plan) -> tuple[TimedText, ...]:
    """Return the planned sync points in order of time."""
    names = {behaviour.id: label(behaviour) for behaviour in plan.timeline.block.behaviours}
    zero = plan.trajectory.zero
    texts = [TimedText(zero + s.planned, s.behaviour, f"{names[s.behaviour]} {s.sync}") for s in plan.syncs]
    return tuple(sorted(texts, key=lambda text: text.time))
