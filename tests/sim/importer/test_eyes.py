"""Eye site on the front of an imported head, from shapes or meshes."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.sim.importer.eyes import place_eyes
from kinesic.sim.importer.hinges import name_hinges
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.mesh_file import Triangles
from kinesic.sim.importer.model_tree import BASE_INDEX, Surface
from kinesic.sim.importer.segments import HEAD_SEGMENT, assign_parts, lay_out_segments
from kinesic.sim.importer.zero_pose import HumanoidGeometry, analyse_geometry


def eyes_in_world(figure: HumanoidGeometry) -> tuple[str, np.ndarray]:
    hinges = name_hinges(figure)
    where = lay_out_segments(figure, hinges)
    eyes = place_eyes(figure, where, assign_parts(figure, where, hinges))
    return eyes.body, where.origins[eyes.body] + eyes.at


def box(middle: tuple[float, float, float], half: tuple[float, float, float]) -> Surface:
    """Return a triangulated box with vertices along its edges."""
    steps = np.linspace(-1.0, 1.0, 9)
    grid = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    shown = sealed(np.array(middle) + np.array(half) * grid[np.abs(grid).max(axis=1) == 1.0])
    return Surface(Triangles(shown, np.array([[0, 1, 2]], dtype=np.int32)), dark=False)


def test_eyes_are_on_the_front_of_a_spherical_head(tee_path):
    figure = analyse_geometry(load_robot_tree(tee_path))
    segment, at = eyes_in_world(figure)
    (ball,) = figure.tree.merge_parts(figure.tree.below(figure.neck[-1])).shapes
    assert segment == HEAD_SEGMENT
    assert at == pytest.approx(np.add(ball.start, [ball.radius, 0.0, 0.0]), abs=1e-4)


def test_eyes_are_on_the_front_of_a_head_mesh_despite_a_neck(tee_path):
    figure = analyse_geometry(load_robot_tree(tee_path))
    last = figure.neck[-1]
    x, _, z = figure.tree.parts[last].shapes[0].start
    surfaces = (box((x, 0.0, z), (0.11, 0.07, 0.12)), box((x, 0.0, z - 0.5), (0.02, 0.02, 0.4)))
    parts = list(figure.tree.parts)
    parts[last] = replace(parts[last], surfaces=surfaces)
    _, at = eyes_in_world(replace(figure, tree=replace(figure.tree, parts=tuple(parts))))
    assert at[0] == pytest.approx(x + 0.11, abs=1e-4)
    assert z - 0.12 < at[2] < z + 0.06


def test_fixed_head_is_found_above_the_shoulders(written, puppets):
    figure = analyse_geometry(load_robot_tree(written("stiff.xml", puppets.puppet(neck=False, trunk=False))))
    segment, plain = eyes_in_world(figure)
    shoulder = figure.arms["l"].centres.shoulder
    high = float(shoulder[2]) + 0.35 * figure.arm_length
    surfaces = (box((0.0, 0.0, high), (0.1, 0.06, 0.1)), box((0.0, 0.0, float(shoulder[2]) - 0.2), (0.3, 0.2, 0.15)))
    tree = replace(figure.tree, base=replace(figure.tree.base, surfaces=surfaces))
    assert figure.tree.merge_parts((BASE_INDEX,)).surfaces == ()
    own, at = eyes_in_world(replace(figure, tree=tree))
    assert own == segment
    assert at == pytest.approx([0.1, 0.0, high], abs=0.03)
    assert plain[2] > shoulder[2]
