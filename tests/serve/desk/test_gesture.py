"""Previews of single gestures: copies of built-in ones, errors and reach."""

import re
from dataclasses import replace

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.hands.appearance import look
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.serve.desk import gesture
from kinesic.serve.desk.gesture import _checks, draft_gesture, gesture_text, plan_alone, read_gesture_file


def test_exported_gesture_file_contains_only_the_requested_gesture(upper22_setup):
    lexicon = upper22_setup.lexicon
    for form in lexicon.forms[::9]:
        text = gesture_text(form.id, lexicon)
        assert text.startswith(f'category = "{form.category}"\n')
        assert text.count("[[gesture]]") == 1
        assert f'id = "{form.id}"\n' in text
    with pytest.raises(ConfigError, match="no such built-in gesture"):
        gesture_text("nobody", lexicon)


def test_gesture_preview_contains_key_times_and_results_of_gesture_checks(upper22_setup):
    text = gesture_text("conduit", upper22_setup.lexicon).replace('"conduit"', '"mine"')
    preview = draft_gesture(text, (), upper22_setup)
    assert (preview["gesture"], [list(key) for key in preview["keys"]]) == ("mine", [["both"], ["both"]])
    assert 0 < preview["times"][0] < preview["times"][1] < preview["duration"]
    assert [(item["name"], item["ok"]) for item in preview["checks"]] == [
        ("reach", True),
        ("clearance", True),
        ("distinct", False),
        ("duration", True),
    ]
    assert preview["checks"][2]["text"].startswith("it looks like conduit")
    slow = draft_gesture(text, ("temporal=-1",), upper22_setup)
    assert slow["duration"] > 1.2 * preview["duration"]
    second = re.findall(r"at = (\[.*?\])", text)[1]
    far = draft_gesture(text.replace(second, "[1.9, 0.24, 0.70]"), (), upper22_setup)
    assert ["pose 2: the left hand" in item["text"] for item in far["checks"]][:2] == [True, False]
    assert not far["checks"][0]["ok"]
    other = next(item for item in far["checks"] if item["name"] == "distinct")
    assert other["ok"]
    assert other["text"].startswith("it looks unlike all other gestures; ")
    own = draft_gesture(gesture_text("conduit", upper22_setup.lexicon), (), upper22_setup)
    assert own["checks"][2]["ok"], "a gesture is not like itself"


def test_gesture_passes_the_clearance_check_only_if_its_clearance_is_at_least_the_required_minimum(
    upper22_setup, monkeypatch
):
    beat = look(upper22_setup.lexicon.forms_by_id["beat"], upper22_setup.pace)
    monkeypatch.setattr(gesture, "_stroke_appearances", lambda pace: {"beat": beat})  # a second for all gestures
    (form, *_), lexicon = read_gesture_file(gesture_text("conduit", upper22_setup.lexicon), upper22_setup)
    plan = plan_alone(form, replace(upper22_setup, lexicon=lexicon))
    for excess, is_clear in ((-1e-6, True), (0.0, True), (1e-6, False)):
        required = float(plan.clearance.distances.min()) + excess
        stricter = replace(plan.setup, robot=replace(plan.setup.robot, min_clearance=required))
        checks = {check["name"]: check["ok"] for check in _checks(replace(plan, setup=stricter), form)}
        assert checks["clearance"] is is_clear


@pytest.mark.parametrize(
    ("old", "new", "line", "why"),
    [
        ('palm = "up in"', 'palm = "upp in"', 3, "did you mean up"),
        ("keys =", "keyz =", 3, "did you mean keys"),
        ('id = "conduit"', "id = conduit", 4, "TOML"),
        ("\n", "#", 1, "no gesture"),
    ],
)
def test_invalid_gesture_file_is_refused_with_its_line(upper22_setup, old, new, line, why):
    preview = draft_gesture(gesture_text("conduit", upper22_setup.lexicon).replace(old, new), (), upper22_setup)
    assert preview["error"]["line"] == line
    assert why in preview["error"]["text"]
    assert "/tmp" not in preview["error"]["text"]


GESTUARY = """<gestuary><gesture category="{}" id="mine"><phase><hand side="LEFT" openness="1"><uniformPosition>
<horizontalLocation value="0.3"/><verticalLocation value="0.2"/><frontalLocation value="0.5"/></uniformPosition>
<handShape value="FORM_OPEN"/></hand></phase></gesture></gestuary>"""


def test_gesture_category_from_a_foreign_gestuary_file_is_not_used_as_a_file_path(tmp_path):
    (tmp_path / "secret.toml").write_text('[[gesture]]\nid = "mine"\nsecret = 7\n')
    file = tmp_path / "gestuary.xml"
    for category in (f"{tmp_path}/secret", "../robots/upper22", "x" * 300):
        file.write_text(GESTUARY.format(category))
        lexicon = Lexicon.load(file)
        assert lexicon.forms_by_id["mine"].category == category
        with pytest.raises(ConfigError, match="mine: there is no such built-in gesture"):
            gesture_text("mine", lexicon)
