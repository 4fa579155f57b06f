"""Position and shape of the face screen on robots with a head."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.filming.face_screen import Sheet, build_face_screen
from kinesic.sim.model import build_model
from kinesic.sim.scene_style import styled_model
from kinesic.sim.shells.shell import load_shell, write_shell

ROBOT = Robot.load()


def compute_normals(sheet: Sheet) -> tuple[np.ndarray, np.ndarray]:
    """Return triangle normals (t, 3) by vertex order and by vertex normals."""
    one, two, three = (sheet.places[sheet.triangles[:, k]] for k in range(3))
    return np.cross(two - one, three - one), sheet.normals[sheet.triangles].mean(axis=1)


def test_curved_face_screen_spans_119_by_94_mm_and_is_clear_of_the_head():
    screen = build_face_screen(ROBOT)
    assert screen is not None
    places, eyes = screen.picture.places, ROBOT.sites["eyes"]
    across, up = np.ptp(places[:, 1]), np.ptp(places[:, 2])
    assert across == pytest.approx(0.119, abs=0.003)
    assert up == pytest.approx(0.0945, abs=0.001)
    (head,) = [segment for segment in ROBOT.skeleton.segments if segment.name == eyes.segment]
    for shape in head.capsules:
        way = shape.end - shape.start
        share = np.clip((places - shape.start) @ way / (way @ way), 0, 1)
        assert (np.linalg.norm(places - shape.start - np.outer(share, way), axis=1) - shape.radius).min() > 0.001
    assert np.ptp(places[:, 0]) > 0.01, "it is curved"


@pytest.mark.parametrize("part", ["picture", "frame"])
def test_triangles_of_the_face_screen_face_outwards(part: str):
    screen = build_face_screen(ROBOT)
    assert screen is not None
    turned, normals = compute_normals(getattr(screen, part))
    lengths = np.linalg.norm(turned, axis=1)
    assert (np.sum(turned * normals, axis=1)[lengths > 1e-9] > 0).all()
    assert np.linalg.norm(getattr(screen, part).normals, axis=1) == pytest.approx(1.0)


def test_face_picture_is_upright_and_not_mirrored_for_viewers():
    screen = build_face_screen(ROBOT)
    assert screen is not None
    shares, places = screen.picture.texture_coordinates, screen.picture.places
    assert places[shares[:, 0].argmin(), 1] < places[shares[:, 0].argmax(), 1]
    assert places[shares[:, 1].argmin(), 2] > places[shares[:, 1].argmax(), 2]
    assert (shares.min(), shares.max()) == pytest.approx((0.0, 1.0), abs=1e-9)


def test_robot_with_skin_or_without_head_has_no_face_screen():
    nowhere = {name: site for name, site in ROBOT.sites.items() if name != "eyes"}
    on_trunk = ROBOT.sites | {"eyes": replace(ROBOT.sites["eyes"], segment=ROBOT.skeleton.segments[0].name)}
    assert build_face_screen(replace(ROBOT, sites=nowhere)) is None
    assert build_face_screen(replace(ROBOT, sites=on_trunk)) is None
    assert build_face_screen(Robot.load("human")) is None


def test_narrow_head_has_a_smaller_face_screen(tmp_path: Path):
    k = ROBOT.skeleton.segment("skullbase")
    segments = list(ROBOT.skeleton.segments)
    segments[k] = replace(segments[k], capsules=tuple(replace(c, radius=0.05) for c in segments[k].capsules))
    skeleton = replace(ROBOT.skeleton, segments=tuple(segments))
    screen = build_face_screen(replace(ROBOT, skeleton=skeleton, path=tmp_path / "own.toml"))
    assert screen is not None
    assert np.ptp(screen.picture.places[:, 2]) == pytest.approx(0.238 * 0.42 * 3 / 4, abs=1e-3)


def test_robot_without_neck_joints_has_a_face_screen_on_its_head():
    stiff = replace(ROBOT, chains={name: chain for name, chain in ROBOT.chains.items() if name != "neck"})
    screen = build_face_screen(stiff)
    assert screen is not None
    assert screen.segment == ROBOT.sites["eyes"].segment


def test_face_screen_moves_in_front_of_a_protruding_shell(tmp_path: Path):
    """Meshes of imported robots may protrude beyond their capsules."""
    own = replace(ROBOT, path=tmp_path / "own.toml")
    bare, shell, name = build_face_screen(own), load_shell(ROBOT), ROBOT.sites["eyes"].segment
    assert bare is not None
    assert shell is not None
    head = shell.segments[name]
    front = bare.picture.places[:, 0].max()
    stuck_out = replace(head, vertices=head.vertices * [1.3, 1.0, 1.0])
    assert stuck_out.vertices[:, 0].max() > front + 0.01
    write_shell(replace(shell, segments=shell.segments | {name: stuck_out}), own.path.with_suffix(".npz"))
    screen = build_face_screen(own)
    assert screen is not None
    moved = screen.picture.places - bare.picture.places
    assert moved[0, 1:] == pytest.approx(0.0, abs=1e-9), "it goes straight ahead"
    assert moved[0, 0] > 0.005
    near = np.abs(stuck_out.vertices[:, 2] - screen.picture.places[0, 2]) < 0.02
    ahead = stuck_out.vertices[near & (np.abs(stuck_out.vertices[:, 1]) < 0.01)][:, 0].max()
    assert screen.picture.places[0, 0] > ahead


def test_face_screen_has_no_mass():
    assert styled_model(ROBOT, width=64, height=48).body_mass.sum() == pytest.approx(build_model(ROBOT).body_mass.sum())
