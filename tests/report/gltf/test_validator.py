"""glTF scenes checked by the Khronos glTF validator, if it is installed."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.face.assets.body import load_figure
from kinesic.report.gltf.scene import KEY_FRAME_RATE, SceneMotion, write_scene
from kinesic.studio import page

MODULES = Path(page.__file__).parent / "client" / "node_modules"
SCRIPT = """
const validator = require("gltf-validator");
validator.validateBytes(new Uint8Array(require("fs").readFileSync(process.argv[1])))
  .then((report) => process.stdout.write(JSON.stringify(report)));
"""

pytestmark = [
    pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed"),
    pytest.mark.skipif(not (MODULES / "gltf-validator").is_dir(), reason="no gltf-validator here: make studio"),
]


def validated(path: Path) -> dict:
    """Return the validator's report of a file."""
    ended = subprocess.run(
        ["node", "-e", SCRIPT, str(path)], cwd=MODULES.parent, capture_output=True, text=True, check=True, timeout=60
    )
    return json.loads(ended.stdout)


def written(robot: Robot, path: Path) -> Path:
    """Write a .glb file with random postures and a moving face."""
    lower, upper = robot.skeleton.lower, robot.skeleton.upper
    angles = np.random.default_rng(5).uniform(lower, upper, (4, len(lower)))
    units = [{"12": share, "63": share, "26": 1.0 - share} for share in (0.0, 0.4, 0.8, 1.0)]
    write_scene(robot, SceneMotion(np.arange(4) / KEY_FRAME_RATE, angles, units), path)
    return path


@pytest.mark.parametrize("name", ["upper22", "upper36", "human"])
def test_gltf_scene_passes_the_khronos_validator(name: str, tmp_path: Path):
    report = validated(written(Robot.load(name), tmp_path / "robot.glb"))
    assert report["issues"]["numErrors"] == 0, report["issues"]["messages"]
    assert report["issues"]["numWarnings"] == 0, report["issues"]["messages"]
    assert report["info"]["version"] == "2.0"
    assert report["info"]["animationCount"] == 1
    if name == "human":
        assert report["info"]["hasSkins"]
        assert report["info"]["hasMorphTargets"]
        assert report["info"]["hasTextures"]
        assert report["info"]["maxInfluences"] == 8
        assert report["info"]["totalTriangleCount"] > len(load_figure().mesh.triangles) / 2


def test_khronos_validator_finds_injected_errors(tmp_path: Path):
    path = written(Robot.load("upper22"), tmp_path / "robot.glb")
    data = bytearray(path.read_bytes())
    at = data.index(b'"LINEAR"')
    data[at : at + 8] = b'"LINEUR"'
    path.write_bytes(data)
    assert validated(path)["issues"]["numWarnings"] + validated(path)["issues"]["numErrors"] > 0
