"""The screen of the face stands before the head, and only where there is one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.filming.face_screen import Sheet, screen_of
from kinesic.sim.model import build_model
from kinesic.sim.scene_style import styled_model
from kinesic.sim.shells.shell import shell_of, write_shell

ROBOT = Robot.load()


def faces_of(sheet: Sheet) -> tuple[np.ndarray, np.ndarray]:
    """(t, 3) the normals of triangles by their corners' order, and the mean of those that their corners have."""
    one, two, three = (sheet.places[sheet.triangles[:, k]] for k in range(3))
    return np.cross(two - one, three - one), sheet.normals[sheet.triangles].mean(axis=1)


def test_it_is_100_by_75_mm_and_clear_of_the_head():
    screen = screen_of(ROBOT)
    assert screen is not None
    places, eyes = screen.picture.places, ROBOT.sites["eyes"]
    across, up = np.ptp(places[:, 1]), np.ptp(places[:, 2])
    assert across == pytest.approx(0.097, abs=0.005)
    assert up == pytest.approx(0.075, abs=0.001)
    (head,) = [segment for segment in ROBOT.skeleton.segments if segment.name == eyes.segment]
    for shape in head.capsules:
        way = shape.end - shape.start
        share = np.clip((places - shape.start) @ way / (way @ way), 0, 1)
        assert (np.linalg.norm(places - shape.start - np.outer(share, way), axis=1) - shape.radius).min() > 0.001
    assert np.ptp(places[:, 0]) > 0.01, "it is curved"


@pytest.mark.parametrize("part", ["picture", "frame"])
def test_triangles_are_seen_from_without(part: str):
    screen = screen_of(ROBOT)
    assert screen is not None
    turned, normals = faces_of(getattr(screen, part))
    lengths = np.linalg.norm(turned, axis=1)
    assert (np.sum(turned * normals, axis=1)[lengths > 1e-9] > 0).all()
    assert np.linalg.norm(getattr(screen, part).normals, axis=1) == pytest.approx(1.0)


def test_the_left_of_the_picture_is_at_the_robots_right_and_its_top_is_up():
    screen = screen_of(ROBOT)
    assert screen is not None
    shares, places = screen.picture.shares, screen.picture.places
    assert places[shares[:, 0].argmin(), 1] < places[shares[:, 0].argmax(), 1]
    assert places[shares[:, 1].argmin(), 2] > places[shares[:, 1].argmax(), 2]
    assert (shares.min(), shares.max()) == pytest.approx((0.0, 1.0), abs=1e-9)


def test_who_has_no_head_or_skin_has_no_screen():
    nowhere = {name: site for name, site in ROBOT.sites.items() if name != "eyes"}
    on_trunk = ROBOT.sites | {"eyes": replace(ROBOT.sites["eyes"], segment=ROBOT.skeleton.segments[0].name)}
    assert screen_of(replace(ROBOT, sites=nowhere)) is None
    assert screen_of(replace(ROBOT, sites=on_trunk)) is None
    assert screen_of(Robot.load("human")) is None


def test_a_head_that_no_neck_turns_has_one_too():
    stiff = replace(ROBOT, chains={name: chain for name, chain in ROBOT.chains.items() if name != "neck"})
    screen = screen_of(stiff)
    assert screen is not None
    assert screen.segment == ROBOT.sites["eyes"].segment


def test_it_stands_before_a_shell_that_sticks_out(tmp_path: Path):
    """As the meshes of other robots do, beyond the capsules that stand for them."""
    own = replace(ROBOT, path=tmp_path / "own.toml")
    bare, shell, name = screen_of(own), shell_of(ROBOT), ROBOT.sites["eyes"].segment
    assert bare is not None
    assert shell is not None
    head = shell.segments[name]
    front = bare.picture.places[:, 0].max()
    stuck_out = replace(head, vertices=head.vertices * [1.3, 1.0, 1.0])
    assert stuck_out.vertices[:, 0].max() > front + 0.01
    write_shell(replace(shell, segments=shell.segments | {name: stuck_out}), own.path.with_suffix(".npz"))
    screen = screen_of(own)
    assert screen is not None
    moved = screen.picture.places - bare.picture.places
    assert moved[0] == pytest.approx(moved[-1]), "it goes straight ahead"
    assert moved[0, 0] > 0.005
    near = np.abs(stuck_out.vertices[:, 2] - screen.picture.places[0, 2]) < 0.02
    ahead = stuck_out.vertices[near & (np.abs(stuck_out.vertices[:, 1]) < 0.01)][:, 0].max()
    assert screen.picture.places[0, 0] > ahead


def test_it_weighs_nothing():
    assert styled_model(ROBOT, width=64, height=48).body_mass.sum() == pytest.approx(build_model(ROBOT).body_mass.sum())
