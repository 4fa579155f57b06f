from dataclasses import replace

from kinesic.body.robot import Robot
from kinesic.cli.options import PlanningOptions
from kinesic.cli.validate_fingerprint import fingerprint

SETTINGS = PlanningOptions("upper22", "neutral", (), None, None, "auto")


def test_the_same_settings_give_the_same_text():
    assert fingerprint(SETTINGS, "nominal") == fingerprint(replace(SETTINGS), "nominal")


def test_every_option_counts(tmp_path):
    targets = tmp_path / "targets.toml"
    targets.write_text("box = [1.0, 0.0, 1.0]")
    others = [
        fingerprint(SETTINGS, "pessimistic"),
        fingerprint(replace(SETTINGS, style="lively"), "nominal"),
        fingerprint(replace(SETTINGS, changes=("power=0.5",)), "nominal"),
        fingerprint(replace(SETTINGS, targets=targets), "nominal"),
        fingerprint(replace(SETTINGS, dialect="greta"), "nominal"),
    ]
    assert len({fingerprint(SETTINGS, "nominal"), *others}) == 6


def test_what_is_in_a_named_file_counts(tmp_path):
    lexicon = tmp_path / "lexicon"
    lexicon.mkdir()
    found = []
    for text in ("a = 1", "a = 2"):
        (lexicon / "own.toml").write_text(text)
        found.append(fingerprint(replace(SETTINGS, lexicon=lexicon), "nominal"))
    assert found[0] != found[1]


def test_a_calibration_changes_it(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(Robot.load().path.read_text(encoding="utf-8"), encoding="utf-8")
    mine = replace(SETTINGS, robot=str(path))
    before = fingerprint(mine)
    path.with_name("mine.calibration.toml").write_text('robot = "upper22"\n', encoding="utf-8")
    assert fingerprint(mine) != before
