"""Tests of palm contact, measured on the drawn meshes."""

from collections.abc import Sequence
from types import ModuleType

import numpy as np
import pytest
from scipy.spatial import KDTree

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.skinning import Skin
from kinesic.session.setup import set_up
from kinesic.sim.shells.shell import load_shell
from kinesic.studies.gestures.isolated import BEHAVIOUR_ID, plan_gesture

PALM_COSINE = 0.5  # smallest cosine between the palm's facing and the normal of a triangle of the palm
PALM_START = 0.4  # distance from the wrist / distance of the palm's centre, from which triangles belong to the palm
MAX_PENETRATION = 0.003  # [m] largest depth of one hand inside the other
SAMPLE_DENSITY = 2.5e5  # [1/m^2] sampled points per surface area
SKIN_GAPS = (0.0, 0.006)  # [m] smallest and largest distance of palms that touch
SHELL_GAPS = (0.004, 0.020)  # [m] smallest and largest distance of palms that hover
MAX_CONTACT_DISTANCE = 0.03  # [m] distance above which points are not inside the other hand


class Meshes:
    """Drawn triangles of both hands in a posture, in the world."""

    def __init__(self, robot: Robot, trimesh: ModuleType) -> None:
        self.robot, self.trimesh = robot, trimesh
        if robot.skin is not None:
            figure = load_figure()
            self.skin = Skin(figure, robot.skeleton)
            names = np.array([frame.segment for frame in self.skin.frames])
            owners = names[figure.weights.toarray().argmax(axis=1)]
            self.positions, self.triangles = figure.mesh.positions, figure.mesh.triangles
            self.owners = owners[self.triangles[:, 0]]
        else:
            self.shell = load_shell(robot)

    def surface(self, angles: Floats, segments: Sequence[str]):
        if self.robot.skin is not None:
            triangles = self.triangles[np.isin(self.owners, segments)]
            return self.trimesh.Trimesh(self.skin.move_skin(self.positions, angles), triangles, process=False)
        frames, parts = self.robot.skeleton.frames(angles), []
        for name in segments:
            if name in self.shell.segments:
                k, piece = self.robot.skeleton.segment(name), self.shell.segments[name]
                vertices = frames.origins[k] + piece.vertices @ frames.rotations[k].T
                parts.append(self.trimesh.Trimesh(vertices, piece.triangles.astype(int), process=False))
        return self.trimesh.util.concatenate(parts)

    def palm(self, angles: Floats, side: str):
        arm = self.robot.arm(side)
        mesh, frames = self.surface(angles, [arm.segments[-1]]), self.robot.skeleton.frames(angles)
        rotation, origin = frames.rotations[arm.wrist], frames.origins[arm.wrist]
        along = (
            (mesh.triangles_center - origin) @ rotation @ arm.palm.position / (arm.palm.position @ arm.palm.position)
        )
        mesh.update_faces((mesh.face_normals @ rotation @ arm.palm.facing > PALM_COSINE) & (along > PALM_START))
        return mesh

    def sample(self, mesh) -> tuple[Floats, Floats]:
        points, faces = self.trimesh.sample.sample_surface(mesh, int(SAMPLE_DENSITY * mesh.area), seed=1)
        return np.asarray(points), mesh.face_normals[faces]

    def gap(self, one, other) -> tuple[float, float]:
        """Return distance and penetration depth [m] of two meshes."""
        (points, _), (places, normals) = self.sample(one), self.sample(other)
        distances, nearest = KDTree(places).query(points)
        inward = -np.einsum("ij,ij->i", points - places[nearest], normals[nearest])
        inside = (inward > 0.5 * distances) & (distances < MAX_CONTACT_DISTANCE)
        return float(distances.min()), float(inward[inside].max(initial=0.0))


@pytest.mark.soak
@pytest.mark.parametrize(("name", "gaps"), [("human", SKIN_GAPS), ("upper36", SHELL_GAPS)])
@pytest.mark.parametrize("gesture", ["prayer", "please", "applause", "plead", "hands_together"])
def test_visible_palms_of_joined_hands_are_within_contact_distance_and_overlap_at_most_3_mm(
    name, gaps, gesture, trimesh
):
    setup = set_up(name)
    meshes, plan = Meshes(setup.robot, trimesh), plan_gesture(setup.lexicon.forms_by_id[gesture], setup)
    stroke = next(sync.planned for sync in plan.syncs if (sync.behaviour, sync.sync) == (BEHAVIOUR_ID, "stroke"))
    angles = plan.trajectory.sample(np.array([plan.trajectory.zero + stroke]))[0][0]
    palms = [meshes.palm(angles, side) for side in SIDES]
    hands = [meshes.surface(angles, [setup.robot.arm(side).segments[-1], *setup.robot.fingers(side)]) for side in SIDES]
    assert gaps[0] <= meshes.gap(*palms)[0] <= gaps[1]
    assert meshes.gap(*hands)[1] <= MAX_PENETRATION
