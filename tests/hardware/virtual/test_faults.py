from math import inf
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.hardware.virtual.faults import DEFAULTS, KINDS, FaultPlan, PlannedFault


def test_a_file_is_a_plan(tmp_path: Path):
    path = tmp_path / "faults.toml"
    path.write_text(
        'seed = 7\n[[fault]]\nkind = "corrupt"\nrate = 0.01\n'
        '[[fault]]\nkind = "reboot"\nservos = [3]\nstart = 2.0\nvalue = 0.4\n'
        '[[fault]]\nkind = "unplug"\nstart = 1.0\nseconds = 0.2\n',
        encoding="utf-8",
    )
    plan = FaultPlan.read(path)
    assert plan.seed == 7
    assert plan.mishaps == (
        PlannedFault("corrupt", rate=0.01),
        PlannedFault("reboot", servos=(3,), start=2.0, value=0.4),
        PlannedFault("unplug", start=1.0, seconds=0.2),
    )
    assert plan.of(frozenset({"unplug"})) == plan.mishaps[2:]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[[fault]]\nkind = "gremlin"', r"Invalid enum value 'gremlin'"),
        ('[[fault]]\nkind = "corrupt"\nrate = 1.5', r"corrupt: rate is 1.5, must be within 0\.\.1"),
        ('[[fault]]\nkind = "reboot"\nrate = 0.5', "reboot has no rate; give it a start"),
        ('[[fault]]\nkind = "corrupt"\nvalue = 5', "corrupt has no value; those with one are late, noise"),
        ('[[fault]]\nkind = "silent"\nstart = -1.0', "start is -1.0 s"),
        ('[[fault]]\nkind = "silent"\nsecond = 1.0', "unknown field `second`.*did you mean seconds"),
    ],
)
def test_a_wrong_file_teaches(tmp_path: Path, text: str, message: str):
    path = tmp_path / "faults.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError, match=message):
        FaultPlan.read(path)


def test_a_figure_is_the_usual_one_unless_given():
    assert PlannedFault("late").figure == DEFAULTS["late"]
    assert PlannedFault("late", value=0.1).figure == 0.1
    assert set(DEFAULTS) < set(KINDS)


def test_a_mishap_lasts_from_its_start_for_its_seconds():
    mishap = PlannedFault("silent", servos=(2,), start=1.0, seconds=0.5)
    assert [mishap.strikes(2, time) for time in (0.9, 1.0, 1.4, 1.5)] == [False, True, True, False]
    assert not mishap.strikes(3, 1.2)
    assert PlannedFault("silent").end == inf
