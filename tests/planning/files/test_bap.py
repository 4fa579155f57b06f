from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import stay
from kinesic.planning.files.bap import FRAME_RATE, PARAMETER_COUNT, PARAMETER_NUMBERS, _columns, read_bap, write_bap

DEFAULT_ROBOT = Robot.load()
HINGE_NAMES = DEFAULT_ROBOT.skeleton.names
HEADER_TEMPLATE = "3.2 made 25 {}"  # BAP header with 25 frames/s and a given number of frames


def mask(*numbers: int, of: int = PARAMETER_COUNT) -> str:
    return " ".join("1" if number in numbers else "0" for number in range(1, of + 1))


@pytest.fixture
def written(tmp_path):
    """Write lines into a file."""

    def write(*lines: str):
        path = tmp_path / "made.bap"
        path.write_text("\n".join(lines) + "\n", encoding="ascii")
        return path

    return write


def angle(frames, name: str) -> list[float]:
    return frames.angles[:, HINGE_NAMES.index(name)].tolist()


def test_written_bap_is_read_back(through, tmp_path):
    angles = np.stack([DEFAULT_ROBOT.skeleton.rest, DEFAULT_ROBOT.skeleton.clamp(DEFAULT_ROBOT.skeleton.rest + 0.3)])
    motion = through(np.array([0.0, 1.0]), angles)
    write_bap(motion, DEFAULT_ROBOT, tmp_path / "m.bap")
    frames = read_bap(tmp_path / "m.bap", DEFAULT_ROBOT)
    np.testing.assert_allclose(frames.times, np.arange(26) / FRAME_RATE)
    np.testing.assert_allclose(frames.angles, motion.sample(frames.times)[0], atol=0.5e-5 + 1e-12)
    assert sorted(frames.given) == sorted(HINGE_NAMES)
    assert frames.strangers == ()


def test_bap_angle_signs_follow_the_standard(written):
    """Expect mirrored angles to differ in sign unless their axis is lateral."""
    numbers = [PARAMETER_NUMBERS[f"{side}_shoulder_{turn}"] for turn in ("flexion", "abduct") for side in "lr"]
    frames = read_bap(written(HEADER_TEMPLATE.format(1), mask(*numbers), "0 10000 10000 20000 -20000"), DEFAULT_ROBOT)
    assert angle(frames, "l_shoulder_flexion") == angle(frames, "r_shoulder_flexion") == [0.1]
    assert angle(frames, "l_shoulder_abduct") == angle(frames, "r_shoulder_abduct") == [0.2]  # mirror images


def test_negative_bap_tilt_of_the_spine_is_a_positive_hinge_angle(written):
    frames = read_bap(written(HEADER_TEMPLATE.format(1), mask(PARAMETER_NUMBERS["vl5_tilt"]), "0 -5000"), DEFAULT_ROBOT)
    assert angle(frames, "vl5_tilt") == [0.05]


def test_bap_parameter_missing_in_a_frame_keeps_its_previous_value(written):
    elbow, neck = PARAMETER_NUMBERS["l_elbow_flexion"], PARAMETER_NUMBERS["skullbase_torsion"]
    frames = read_bap(
        written(HEADER_TEMPLATE.format(3), mask(elbow), "0 50000", mask(neck), "1 20000", mask(), "4"),
        DEFAULT_ROBOT,
    )
    assert frames.times.tolist() == [0.0, 1 / 25, 4 / 25]
    assert angle(frames, "l_elbow_flexion") == [0.5, 0.5, 0.5]
    assert angle(frames, "skullbase_torsion") == [0.0, 0.2, 0.2]
    rest = DEFAULT_ROBOT.skeleton.rest[HINGE_NAMES.index("r_elbow_flexion")]
    assert angle(frames, "r_elbow_flexion") == [rest] * 3
    assert set(frames.given) == {"l_elbow_flexion", "skullbase_torsion"}


def test_bap_file_of_version_2_is_read_and_its_leg_parameter_listed_as_unknown(written):
    frames = read_bap(written("2.1 old name 30 1", mask(4, 38, of=186), "0 7 60000"), DEFAULT_ROBOT)
    assert frames.strangers == (4,)
    assert angle(frames, "l_elbow_flexion") == [0.6]


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ((), r"made\.bap:1: '' is no header"),
        (("3.2 made fast 3",), r":1: .* is no header; write VERSION NAME RATE FRAMES"),
        (("3.2 made 0 1",), r":1: 0 frames/s; must be above 0"),
        (("3.2 made nan 1",), r":1: nan frames/s; must be above 0"),
        ((HEADER_TEMPLATE.format(1), "1 0 1", "0 1 1"), r":2: a mask of 3 words; must be 296 flags"),
        ((HEADER_TEMPLATE.format(1), mask().replace("0", "2", 1), "0"), r":2: a mask of 296 words"),
        ((HEADER_TEMPLATE.format(1), mask(38), "0 1.5"), r":3: only whole numbers"),
        ((HEADER_TEMPLATE.format(1), mask(38), "0 1 2"), r":3: 2 values for 1 parameters"),
        ((HEADER_TEMPLATE.format(2), mask(38), "3 1", mask(38), "3 2"), r":5: frame 3 after frame 3"),
        ((HEADER_TEMPLATE.format(1), mask(38), "-1 1"), r":3: frame -1 after"),
        ((HEADER_TEMPLATE.format(1), mask(38)), r":2: a mask without a frame"),
        ((HEADER_TEMPLATE.format(4), mask(38), "0 1"), r":3: ends after 1 of 4 frames"),
    ],
)
def test_bap_errors_name_the_line(written, lines, message):
    with pytest.raises(ConfigError, match=message):
        read_bap(written(*lines), DEFAULT_ROBOT)


def test_missing_bap_file_is_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"none\.bap: No such file"):
        read_bap(tmp_path / "none.bap", DEFAULT_ROBOT)


def test_motion_name_in_a_bap_file_is_one_ascii_word(through, tmp_path):
    motion = through(np.array([0.0, 0.5]), np.stack([DEFAULT_ROBOT.skeleton.rest] * 2))
    path = tmp_path / "gr\u00fc\u00df dich.bap"
    write_bap(motion, DEFAULT_ROBOT, path)
    assert path.read_text(encoding="ascii").split()[1] == "gr___dich"
    assert len(read_bap(path, DEFAULT_ROBOT).times) == 14


def test_hinges_without_a_bap_parameter_are_not_written(tmp_path):
    robot = Robot.load(Path(__file__).parents[2] / "hardware" / "supervisor" / "little.toml")
    write_bap(stay(robot.skeleton.rest), robot, tmp_path / "m.bap")
    assert read_bap(tmp_path / "m.bap", robot).given == ()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_sign_of_a_bap_parameter_follows_the_axis_of_its_hinge(sign: float):
    """Reverse all hinge axes and expect reversed signs."""
    names = [*HINGE_NAMES, "l_sternoclavicular_rotate", "r_acromioclavicular_rotate"]
    axes = {hinge.name: hinge.axis for hinge in DEFAULT_ROBOT.skeleton.hinges}
    hinges = [SimpleNamespace(name=name, axis=sign * np.array(axes.get(name, (0.0, 0.0, 1.0)))) for name in names]
    columns = _columns.__wrapped__(SimpleNamespace(skeleton=SimpleNamespace(hinges=hinges)))
    usual = {column.number: column.sign for column in _columns(DEFAULT_ROBOT)}
    assert {column.number: sign * column.sign for column in columns if column.number in usual} == usual
    others = [column for column in columns if column.number not in usual]
    assert [column.sign for column in others] == [sign, sign]


@pytest.mark.parametrize(
    ("name", "axis"),
    [
        ("l_wrist_flexion", (-1.0, 0.0, 0.0)),
        ("l_elbow_flexion", (0.0, -1.0, 0.0)),
        ("l_wrist_pivot", (0.0, -1.0, 0.0)),
        ("vl5_tilt", (0.0, -1.0, 0.0)),
        ("l_shoulder_twisting", (0.0, 0.0, -1.0)),
        ("vl5_torsion", (0.0, 0.0, 1.0)),
        ("l_acromioclavicular_rotate", (0.0, 0.0, 1.0)),
        ("l_shoulder_abduct", (1.0, 0.0, 0.0)),
        ("vl5_roll", (1.0, 0.0, 0.0)),
    ],
)
@pytest.mark.parametrize("tilt", [(0.0, 0.0, 0.0), *np.eye(3), *-np.eye(3)], ids=lambda tilt: f"{tilt}")
def test_oblique_hinge_has_the_sign_of_the_body_axis_of_its_parameter(name, axis, tilt):
    """Add larger components along the other two axes of the body."""
    across = np.where(np.array(axis) == 0.0, np.array(tilt), 0.0)
    for sign in (1.0, -1.0):
        hinge = SimpleNamespace(name=name, axis=sign * (np.array(axis) + 1.5 * across))
        (column,) = _columns.__wrapped__(SimpleNamespace(skeleton=SimpleNamespace(hinges=[hinge])))
        assert (column.number, column.sign) == (PARAMETER_NUMBERS[name], sign)


def test_bap_numbers_of_the_spine_increase_from_the_skull_down():
    first = {"skullbase": 48, "vc1": 51, "vc7": 69, "vt1": 72, "vt12": 105, "vl1": 108, "vl5": 120}
    assert {bone: PARAMETER_NUMBERS[f"{bone}_roll"] for bone in first} == first
    assert [PARAMETER_NUMBERS[f"vl5_{turn}"] for turn in ("torsion", "tilt")] == [121, 122]
