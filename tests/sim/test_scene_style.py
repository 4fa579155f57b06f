from dataclasses import replace

import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.model import build_model
from kinesic.sim.part_colours import parts
from kinesic.sim.scene_style import CAMERA_NAME, eyeballs, styled_model

ROBOT = Robot.load()
MODEL = styled_model(ROBOT, width=320, height=240)


def test_scenery_has_no_mass_and_no_contacts():
    plain = build_model(ROBOT)
    assert MODEL.body_mass.sum() == pytest.approx(plain.body_mass.sum())
    solid = [k for k in range(MODEL.ngeom) if MODEL.geom_contype[k] or MODEL.geom_conaffinity[k]]
    assert len(solid) == sum(len(segment.capsules) for segment in ROBOT.skeleton.segments)


def test_camera_is_in_front_of_the_robot_with_a_level_horizon():
    camera = MODEL.camera(CAMERA_NAME)
    assert camera.pos[0] > 1.0
    assert abs(camera.pos[1]) < camera.pos[0]
    view = np.empty(9)

    mujoco.mju_quat2Mat(view, camera.quat)
    assert view.reshape(3, 3)[2, 0] == pytest.approx(0.0, abs=1e-9), "the horizon is level"


def test_offscreen_buffer_fits_the_requested_picture_size():
    assert (MODEL.vis.global_.offwidth, MODEL.vis.global_.offheight) == (320, 240)


def test_segments_are_assigned_to_body_parts_for_colouring():
    painted = parts(ROBOT)
    assert set(painted) == {segment.name for segment in ROBOT.skeleton.segments}
    assert painted[ROBOT.chains["l_arm"][-1]] == "l_hand"
    assert painted[ROBOT.chains["r_arm"][0]] == "limb"
    assert painted[ROBOT.skeleton.segments[0].name] == "trunk"


def test_drawn_pupils_point_in_the_facing_direction_of_the_eye_site():
    white, pupil = eyeballs(ROBOT)[:2]
    eyes = ROBOT.sites["eyes"]
    assert (white.dark, pupil.dark) == (False, True)
    assert float((pupil.centre - white.centre) @ eyes.facing) > 0.0
    assert eyeballs(replace(ROBOT, sites={name: site for name, site in ROBOT.sites.items() if name != "eyes"})) == ()
