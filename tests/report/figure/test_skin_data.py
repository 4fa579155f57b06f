"""Skin data of pages, compared with the renderer's skin."""

import json
import shutil
import subprocess
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.face.assets.body import POSITION_STEP, load_figure
from kinesic.face.assets.rig import FRAME_INDICES, SKINNING_FRAMES
from kinesic.face.assets.skinning import Skin
from kinesic.report.figure.face_data import face_data
from kinesic.report.figure.skin_data import MAX_BORDER_DISTANCE, VERTEX_TYPE, skin_data
from kinesic.report.scene import SCENE_SCRIPTS, read_scripts, scene_data

from ...chromium import binary, opened

HUMAN = Robot.load("human")
FIGURE = load_figure()
MAX_PAGE_GROWTH = 1.5e6  # [bytes] largest growth of a page by skin and scripts
PICTURE_SIDE = 300  # [pixels] side of the page's picture
BONES_SCRIPT = """
const { skin, placed, angles } = JSON.parse(require("fs").readFileSync(0));
process.stdout.write(JSON.stringify(angles.map((row, k) => Array.from(bonesOf(skin, placed[k], row)))));
"""
PAGE_TEMPLATE = """<!doctype html><canvas style="width: SIDEpx; height: SIDEpx"></canvas><script>
SCRIPTS
const canvas = document.querySelector("canvas"), data = DATA, scene = sceneOf(canvas, data);
const look = { turn: 0.3, rise: 0.1, zoom: 1 };
const shown = (posture) => {
  scene.draw({ look, ghost: undefined, beside: false, ink: [0, 0, 0], ...posture });
  const gl = canvas.getContext("webgl2"), pixels = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return [gl.getError(), Array.from(pixels)];
};
</script>"""


def rows() -> np.ndarray:
    return np.frombuffer(b64decode(str(skin_data(HUMAN)["vertices"])), dtype=VERTEX_TYPE)


def test_skin_vertices_packed_for_the_report_page_equal_those_of_the_human_figure():
    whole = rows()
    packed, locks = whole[: len(FIGURE.mesh.positions)], whole[len(FIGURE.mesh.positions) :]
    assert np.abs(locks["place"][:, :3] * POSITION_STEP - FIGURE.locks.positions).max() <= POSITION_STEP
    assert (locks["joints"][:, 0] == FRAME_INDICES["skullbase"]).all()
    assert (locks["weights"] == [255, 0, 0, 0, 0, 0, 0, 0]).all()
    hair = FIGURE.mesh.normals(FIGURE.mesh.positions) * FIGURE.hair[:, None]
    assert np.abs(packed["place"][:, :3] * POSITION_STEP - FIGURE.mesh.positions - hair).max() <= POSITION_STEP
    assert (packed["weights"].sum(axis=1, dtype=int) == 255).all()
    weights = np.zeros((len(packed), len(SKINNING_FRAMES) + 2))
    np.put_along_axis(weights, packed["joints"].astype(int), packed["weights"] / 255.0, axis=1)
    weights[:, FRAME_INDICES["skullbase"]] += weights[:, len(SKINNING_FRAMES) :].sum(axis=1)
    assert np.abs(weights[:, : len(SKINNING_FRAMES)] - FIGURE.weights.toarray()).max() < 0.02
    left = FIGURE.mesh.positions[:, 1] > 0.0
    for eye, side in enumerate((left, ~left)):
        assert set(np.flatnonzero(weights[:, len(SKINNING_FRAMES) + eye])) == set(FIGURE.mesh.vertices("eyes")) & set(
            np.flatnonzero(side)
        )
    cloth = FIGURE.mesh.vertices("cloth")
    near = cloth[np.abs(FIGURE.mesh.tips[cloth]) < 0.3]
    assert np.abs(packed["mark"][near, 0] / 32767 * MAX_BORDER_DISTANCE - FIGURE.mesh.tips[near]).max() < 1e-4
    triangles = np.frombuffer(b64decode(str(skin_data(HUMAN)["triangles"])), dtype="<u2").reshape(-1, 3)
    assert np.array_equal(triangles, np.concatenate([FIGURE.mesh.triangles, len(packed) + FIGURE.locks.triangles]))


def test_report_page_data_have_a_small_skin_for_the_human_and_none_for_a_robot_without_skin():
    assert len(json.dumps(skin_data(HUMAN))) + len(read_scripts(("skin.js",))) < MAX_PAGE_GROWTH
    assert "skin" not in scene_data(Robot.load("upper36"))
    assert "skin" in scene_data(HUMAN)


@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
def test_skin_script_of_the_report_page_moves_the_skin_like_the_renderer():
    lower, upper = HUMAN.skeleton.lower, HUMAN.skeleton.upper
    angles = np.array(
        [HUMAN.skeleton.rest, lower, upper, *np.random.default_rng(2).uniform(lower, upper, (3, len(lower)))]
    )
    stand = HUMAN.skeleton.frames(angles)
    placed = np.tile(np.eye(4), (*stand.rotations.shape[:2], 1, 1))
    placed[..., :3, :3], placed[..., :3, 3] = stand.rotations, stand.origins
    columns_first = placed.transpose(0, 1, 3, 2).reshape(len(angles), -1, 16)
    given = {"skin": skin_data(HUMAN), "placed": columns_first.tolist(), "angles": angles.tolist()}
    script = read_scripts(("shapes.js", "motion.js", "skin.js")) + BONES_SCRIPT
    ended = subprocess.run(
        ["node", "-e", script], input=json.dumps(given), capture_output=True, text=True, check=True, timeout=60
    )
    result = np.array(json.loads(ended.stdout)).reshape(len(angles), -1, 4, 4)
    moved = Skin(FIGURE, HUMAN.skeleton)
    for bones, posture in zip(result, angles, strict=True):
        turns, ways = moved.compute_frame_motions(posture)
        np.testing.assert_allclose(bones[: len(turns), :3, :3], turns, atol=2e-5)
        np.testing.assert_allclose(bones[: len(turns), :3, 3], ways, atol=2e-5)
        assert not bones[:, 3].any()
        assert len(bones) == len(turns) + 2
        np.testing.assert_array_equal(bones[len(turns) :], bones[[FRAME_INDICES["skullbase"]] * 2])  # eyes look ahead


@pytest.mark.skipif(binary() is None, reason="no Chromium: apt-get install chromium")
def test_report_page_draws_skin_clothes_highlight_servo_duty_face_and_plan_overlay(tmp_path: Path):
    data = {**scene_data(HUMAN), "features": face_data([{"26": 1.0}])}
    text = PAGE_TEMPLATE.replace("SIDE", str(PICTURE_SIDE)).replace("SCRIPTS", read_scripts(SCENE_SCRIPTS))
    (tmp_path / "page.html").write_text(text.replace("DATA", json.dumps(data)), encoding="utf-8")
    rest = json.dumps(HUMAN.skeleton.rest.tolist())
    with opened((tmp_path / "page.html").as_uri()) as page:
        page.until("typeof shown === 'function' && document.readyState === 'complete'")
        if page.value("scene === null"):
            pytest.skip("this Chromium has no WebGL")

        def drawn(more: str) -> np.ndarray:
            error, pixels = page.value(f"shown({{ twin: {{ angles: {rest} }}, {more} }})")
            assert error == 0
            return np.array(pixels, dtype=int).reshape(-1, 4)

        plain = drawn("")
        red, green, blue, alpha = plain.T
        flesh = (alpha == 255) & (red > green + 15) & (green > blue)
        shirt = (alpha == 255) & (blue > green + 10) & (green > red)
        assert 0.003 < flesh.mean() < shirt.mean() < 0.3
        head = HUMAN.skeleton.segment("skullbase")
        lit = drawn(f"lit: new Set([{head}])")
        yellow = (lit[:, 0] > lit[:, 2] + 90) & (lit[:, 1] > lit[:, 2] + 50)
        assert yellow.sum() > 0.2 * flesh.sum()
        duty = json.dumps([1.0] * len(HUMAN.skeleton.names))
        hot = drawn(f"twin: {{ angles: {rest}, duty: {duty} }}")
        assert ((hot[:, 0] > 2 * hot[:, 1]) & (hot[:, 3] == 255)).sum() > 0.9 * shirt.sum()
        shut = drawn(f"twin: {{ angles: {rest}, features: {{ weights: [1], gaze: [0, 0.5, 0, 0, 0.5, 0] }} }}")
        assert 0 < (np.abs(shut - plain).max(axis=1) > 20).sum() < 0.5 * flesh.sum()
        over = drawn(f"ghost: {rest}, beside: true")
        assert ((over[:, 3] > 100) & (over[:, 3] < 200)).sum() > 0.1 * shirt.sum()
