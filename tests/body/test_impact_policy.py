from pathlib import Path

import pytest

from kinesic.body.config import CONFIGS, ConfigError
from kinesic.body.impact_policy import FORCE_MARGIN, find_policy, force_rows, read_impact_limits
from kinesic.body.robot_file import read_description

VALID_LIMITS = (CONFIGS / "impacts.toml").read_text(encoding="utf-8")


def written(folder: Path, text: str) -> Path:
    path = folder / "limits.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_contact_limits_near_adults_use_quasi_static_forces_for_hand_and_chest():
    policy = find_policy("adult")
    assert policy is not None
    assert policy.table.force["hand"] == policy.regions["hand"].quasi_static == 140
    assert policy.table.force["chest"] == policy.regions["chest"].quasi_static == 140
    assert policy.rows.names == ("hand", "forearm", "upper_arm", "chest", "energy")


def test_impact_rows_of_a_policy_are_scaled_by_its_limits_and_a_margin():
    policy = find_policy("child")
    assert policy is not None
    forces = force_rows(policy.regions)
    face = forces.names.index("face")
    assert policy.rows.scales[0] == pytest.approx(forces.scales[face] / 65)
    assert forces.scales[face] == pytest.approx(FORCE_MARGIN * 75_000**0.5)
    assert policy.rows.scales[1] == pytest.approx(forces.scales[-1] / 0.08**0.5)


def test_audience_nobody_has_no_contact_limits():
    assert find_policy("nobody") is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("force = { face = 65 }", "force = { fase = 65 }", "no region fase; did you mean face"),
        ("force = { face = 65 }", "force = { face = 0 }", "policies.child.face is 0, must be above 0"),
        ("transient = 320", "transient = -1", "regions.forearm.transient is -1, must be above 0"),
        ("[policies.child]", "[policies.robot]", "robot"),
    ],
)
def test_invalid_contact_limits_are_refused_with_their_place_in_the_file(
    tmp_path: Path, old: str, new: str, message: str
):
    path = written(tmp_path, VALID_LIMITS.replace(old, new))
    with pytest.raises(ConfigError, match=message):
        read_impact_limits(path)


def test_audience_missing_from_a_user_file_of_contact_limits_is_refused(tmp_path: Path):
    path = written(tmp_path, VALID_LIMITS.partition("[policies.child]")[0])
    with pytest.raises(ConfigError, match="no policy child"):
        find_policy("child", path)


def test_robot_file_may_name_an_audience_and_a_limits_file_in_its_folder(tmp_path: Path):
    written(tmp_path, VALID_LIMITS)
    robot = tmp_path / "own.toml"
    table = '[robot]\nname = "own"\nextends = "upper22"\n\n[audience]\nnear = "adult"\nlimits = "{}"\n'
    robot.write_text(table.format("limits.toml"), encoding="utf-8")
    described = read_description(robot)
    assert (described.audience, described.impact_limits) == ("adult", tmp_path / "limits.toml")
    robot.write_text(table.format("../limits.toml"), encoding="utf-8")
    with pytest.raises(ConfigError, match="audience"):
        read_description(robot)
