"""Committed shells: enclosed servos, distance from shapes, and file size."""

from pathlib import Path

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.sim.shells.part import list_servo_boxes
from kinesic.sim.shells.shell import (
    SHELL_SUFFIX,
    SegmentShell,
    Shell,
    fingerprint,
    is_stale,
    load_shell,
    read_shell,
    write_shell,
)

ROBOT_NAMES = ("upper22", "upper36")
MAX_SHELL_DISTANCE = 0.021  # [m] from a shell to the shapes and servos of its segment
MAX_HEAD_DISTANCE = 0.030  # [m] largest distance between the head's shell and its shapes, at the rounded corners
PEDESTAL_HEIGHT = 0.23  # [m] height of the base's wide foot, out of the hands' reach
MAX_SEGMENT_TRIANGLES = 3000  # triangles of one segment
MAX_FILE_SIZE = 300_000  # [bytes] largest shell file


@pytest.fixture(scope="module", params=ROBOT_NAMES)
def robot(request: pytest.FixtureRequest) -> Robot:
    return Robot.load(request.param)


@pytest.fixture(scope="module")
def shell(robot: Robot) -> Shell:
    result = load_shell(robot)
    assert result is not None, f"python -m kinesic.sim.shells.bake {robot.name}"
    return result


def test_committed_shell_matches_the_robot_description(robot: Robot, shell: Shell):
    assert not is_stale(robot)
    assert shell.made_from == fingerprint(robot)


def test_shell_encloses_every_servo(robot: Robot, shell: Shell):
    for name, surface, shift, _ in _surfaces(robot, shell):
        for servo in list_servo_boxes(robot, name):
            wound = _winding(surface, servo.corners + shift)
            assert (wound > 0.5).all(), f"{name}: corners {wound.round(2)} of the servo at {servo.centre}"


def test_shell_is_within_21_mm_of_shapes_and_servos_and_within_30_mm_at_the_head(robot: Robot, shell: Shell):
    for name, surface in shell.segments.items():
        parts = [(part, shift) for part, _, shift, drawn in _surfaces(robot, shell) if drawn == name]
        away = np.min([_distance(robot, part, surface.vertices - shift) for part, shift in parts], axis=0)
        if name == robot.skeleton.segments[0].name:
            away = away[surface.vertices[:, 2] > surface.vertices[:, 2].min() + PEDESTAL_HEIGHT]
        limit = MAX_HEAD_DISTANCE if name == robot.chains["neck"][-1] else MAX_SHELL_DISTANCE
        assert np.abs(away).max() < limit, f"{name}: {1000 * np.abs(away).max():.1f} mm"


def test_robot_stands_on_a_broad_flat_base(shell: Shell):
    points = shell.segments["humanoid_root"].vertices
    foot = points[points[:, 2] < points[:, 2].min() + 0.01]
    assert np.ptp(foot[:, 0]) > 0.2
    assert np.ptp(foot[:, 1]) == pytest.approx(np.ptp(foot[:, 0]), abs=0.005)
    column = points[np.abs(points[:, 2] + 0.2) < 0.05]
    assert np.ptp(column[:, 0]) < 0.09


def test_forearm_tapers_to_the_wrist(shell: Shell):
    points = shell.segments["l_elbow"].vertices
    widths = [np.ptp(points[np.abs(points[:, 2] - z) < 0.012][:, 0]) for z in (-0.11, -0.16, -0.188)]
    assert widths[0] > widths[1] + 0.002
    assert widths[1] > widths[2] + 0.002


def test_head_is_wider_than_its_shape_and_hides_the_neck(robot: Robot, shell: Shell):
    head, shape = shell.segments["skullbase"].vertices, robot.skeleton.segments[robot.skeleton.segment("skullbase")]
    assert np.ptp(head[:, 1]) > 2.3 * shape.capsules[0].radius
    assert np.ptp(head[:, 1]) > 0.8 * np.ptp(head[:, 2])
    collar = shell.segments["vl5"].vertices[:, 2].max() - 0.29 - 0.07  # in the head's frame
    assert head[:, 2].min() < collar


def test_shell_is_closed_and_faces_outwards(shell: Shell):
    for name, surface in shell.segments.items():
        edges = np.concatenate([surface.triangles[:, [k, (k + 1) % 3]] for k in range(3)]).astype(int)
        there, back = ({(int(a), int(b)) for a, b in rows} for rows in (edges, edges[:, ::-1]))
        assert there == back, name
        corners = surface.vertices[surface.triangles]
        assert np.einsum("ti,ti->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() > 0.0
        np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1.0, atol=0.02)


def test_shell_file_stays_within_its_size_and_triangle_limits(robot: Robot, shell: Shell):
    assert max(len(surface.triangles) for surface in shell.segments.values()) <= MAX_SEGMENT_TRIANGLES
    assert robot.path.with_suffix(SHELL_SUFFIX).stat().st_size < MAX_FILE_SIZE


def test_left_and_right_shells_have_mirrored_extents_and_joint_surfaces(shell: Shell):
    for name, surface in shell.segments.items():
        if name.startswith("l_"):
            other = shell.segments[f"r_{name[2:]}"]
            for one, two in ((surface.vertices, other.vertices * (1.0, -1.0, 1.0)),):
                np.testing.assert_allclose(one.max(axis=0), two.max(axis=0), atol=0.002)
                np.testing.assert_allclose(one.min(axis=0), two.min(axis=0), atol=0.002)
    assert all(len(shell.segments[name].joint) for name in ("l_elbow", "l_shoulder", "vl5", "skullbase"))


def _surfaces(robot: Robot, shell: Shell) -> list[tuple[str, SegmentShell, Floats, str]]:
    """List each segment with the surface that encloses it.

    Returns:
        Segment, surface, origin of the segment in the surface's frame, and segment of the surface.
    """
    results = []
    for segment in robot.skeleton.segments:
        name, shift = segment.name, np.zeros(3)
        while name not in shell.segments:
            above = robot.skeleton.segments[robot.skeleton.segment(name)]
            assert above.parent is not None
            assert not any(hinge.segment == name for hinge in robot.skeleton.hinges)
            name, shift = above.parent, shift + above.origin_in_parent
        results.append((segment.name, shell.segments[name], shift, name))
    return results


def _winding(surface: SegmentShell, points: Floats) -> Floats:
    """Return a surface's winding number around points: 1 inside, 0 outside."""
    a, b, c = (surface.vertices[surface.triangles[:, k]][None] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    volume = np.einsum("nti,nti->nt", a, np.cross(b, c))
    below = la * lb * lc + (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
    return np.asarray(np.arctan2(volume, below).sum(axis=1) / (2 * np.pi))


def _distance(robot: Robot, name: str, points: Floats) -> Floats:
    """Return signed distances [m] from points to a segment's shapes and servos."""
    segment = robot.skeleton.segments[robot.skeleton.segment(name)]
    results = [np.full(len(points), np.inf)]
    for shape in segment.capsules:
        way = shape.end - shape.start
        share = np.clip((points - shape.start) @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
        results.append(np.linalg.norm(points - shape.start - share[:, None] * way, axis=1) - shape.radius)
    for servo in list_servo_boxes(robot, name):
        beyond = np.abs(points - servo.centre) - servo.half
        results.append(np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0))
    return np.asarray(np.min(results, axis=0))


def test_written_shell_file_is_read_back_up_to_rounding(robot: Robot, shell: Shell, tmp_path: Path):
    write_shell(shell, tmp_path / "again.npz")
    again = read_shell(tmp_path / "again.npz")
    assert list(again.segments) == list(shell.segments)
    for name, surface in shell.segments.items():
        np.testing.assert_allclose(again.segments[name].vertices, surface.vertices, atol=2e-5)
        np.testing.assert_array_equal(again.segments[name].triangles, surface.triangles)
