"""Face data of pages, compared with the renderer's shapes and eye rotations."""

import json
import shutil
import subprocess
from base64 import b64decode

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.dry_run import dry_run
from kinesic.face.assets.action_units import (
    FACE_CHANNELS,
    compute_gaze_rotation,
    compute_shape_weights,
    read_intensities,
)
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.rig import SKINNING_FRAMES
from kinesic.face.assets.skinning import Skin
from kinesic.report.figure.face_data import face_data
from kinesic.report.figure.skin_data import skin_data
from kinesic.report.replay import replay_data
from kinesic.report.scene import read_scripts
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

MAX_PAGE_GROWTH = 1.5e6  # [bytes] largest growth of a page by skin and face
HUMAN, FIGURE = Robot.load("human"), load_figure()
ACTION_UNITS = ({}, {"12": 1.0, "26": 0.6, "L1": 0.5}, {"61": 0.8, "63": 0.4}, {"45": 1.0, "64": 0.7, "66": 0.3})
PAGE_SCRIPT = """
const { skin, face, count, placed, angles } = JSON.parse(require("fs").readFileSync(0));
const moved = faceOf(face.shapes, count), frames = face.weights.length;
process.stdout.write(JSON.stringify(face.weights.map((weights, k) => ({
  moves: Array.from(moved(weights)),
  bones: Array.from(bonesOf(skin, placed, angles, { gaze: face.gaze[k] })),
}))));
"""


def unpacked(data: dict) -> dict:
    """Decode shape weights and eye rotations as the page does."""
    weights = np.frombuffer(b64decode(data["weights"]), "u1").reshape(len(ACTION_UNITS), -1) * data["weight_step"]
    gaze = np.frombuffer(b64decode(data["gaze"]), "<i2").reshape(len(ACTION_UNITS), 6) * data["gaze_step"]
    return {"shapes": data["shapes"], "weights": weights.tolist(), "gaze": gaze.tolist()}


def test_face_data_of_the_report_page_contain_only_blend_shapes_that_the_motion_uses():
    assert face_data(ACTION_UNITS[:1])["shapes"] == []
    assert 0 < len(face_data(ACTION_UNITS)["shapes"]) < len(FIGURE.mesh.shapes) / 2
    every = [{channel: 1.0} for channel in FACE_CHANNELS]
    data = face_data(every)
    assert len(data["shapes"]) > 45
    assert len(json.dumps(skin_data(HUMAN))) + len(json.dumps(data)) < MAX_PAGE_GROWTH


@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
def test_face_script_of_the_report_page_moves_vertices_and_eyes_like_the_renderer():
    stand = HUMAN.skeleton.frames(HUMAN.skeleton.rest)
    placed = np.tile(np.eye(4), (len(stand.origins), 1, 1))
    placed[:, :3, :3], placed[:, :3, 3] = stand.rotations, stand.origins
    given = {
        "skin": skin_data(HUMAN),
        "face": unpacked(face_data(ACTION_UNITS)),
        "count": len(FIGURE.mesh.positions),
        "placed": placed.transpose(0, 2, 1).reshape(-1, 16).tolist(),
        "angles": HUMAN.skeleton.rest.tolist(),
    }
    script = read_scripts(("shapes.js", "motion.js", "skin.js")) + PAGE_SCRIPT
    ended = subprocess.run(
        ["node", "-e", script], input=json.dumps(given), capture_output=True, text=True, check=True, timeout=60
    )
    skin, eyes = Skin(FIGURE, HUMAN.skeleton), FIGURE.mesh.vertices("eyes")
    for units, result in zip(ACTION_UNITS, json.loads(ended.stdout), strict=True):
        moves = np.array(result["moves"]).reshape(-1, 3)
        asked = (FIGURE.mesh.deltas @ compute_shape_weights(FIGURE.mesh, units)).reshape(-1, 3)
        assert np.abs(moves - asked).max() < 5e-4
        assert moves.any() == bool(units)
        bones = np.array(result["bones"]).reshape(-1, 4, 4)[len(SKINNING_FRAMES) :, :3]
        for number, (bone, centre) in enumerate(zip(bones, FIGURE.mesh.eyes, strict=True)):
            ball = eyes[(FIGURE.mesh.positions[eyes, 1] > 0.0) == (number == 0)]
            turned = (
                centre
                + (FIGURE.mesh.positions[ball] - centre) @ compute_gaze_rotation(read_intensities(units), number).T
            )
            placed_by_page = FIGURE.mesh.positions[ball] @ bone[:, :3].T + bone[:, 3]
            assert np.abs(placed_by_page - skin.move_with_head(turned, HUMAN.skeleton.rest)).max() < 2e-5


def test_replay_of_a_skinned_robot_has_a_face_per_frame():
    face = '<faceFacs id="f" au="12" start="0" end="1"/>'
    smile = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{face}</bml>'
    with_skin, without = (replay_data(dry_run(plan(smile, set_up(name)))) for name in ("human", "upper22"))
    features = with_skin["features"]
    assert isinstance(features, dict)
    rows = np.frombuffer(b64decode(str(features["weights"])), "u1").reshape(with_skin["frames"], -1)
    assert rows.shape[1] == len(features["shapes"]) > 0
    assert rows.max() > 100
    assert "features" not in without
