from dataclasses import replace
from math import radians

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.lexicon import Lexicon, in_mode, mirror_form
from kinesic.expressivity.lexicon.toml_file import read_gestures

KEYS_LINE = "keys = [{ right = { at = [0.3, 0.45, 0.6] } }]"


def written(body: str = "", bodies: str = "") -> str:
    own = f"body = {body}\n" if body else ""
    return f'category = "beat"\n{bodies}[[gesture]]\nid = "own"\n{own}{KEYS_LINE}\n'


@pytest.fixture
def read(tmp_path):
    def of(body: str = "", bodies: str = "") -> BodyForm:
        path = tmp_path / "own.toml"
        path.write_text(written(body, bodies))
        return read_gestures(path).entries[0][0].body

    return of


def test_body_motion_table_of_a_gesture_converts_degrees_to_radians(read):
    result = read(
        '{ head = { turn = 10, tilt = -5 }, nod = 4, shoulders = 15, gaze = "hands", face = { smile = 0.5 } }'
    )
    assert result.head == Turn(torsion=radians(10), tilt=radians(-5))
    assert (result.nod, result.shoulders) == pytest.approx((radians(4), radians(15)))
    assert (result.gaze, result.face) == ("hands", (("smile", 0.5),))


def test_body_motion_of_a_gesture_overrides_that_of_the_category(read):
    bodies = "[bodies.beat]\nnod = 4\nshoulders = 3\n[bodies.emblem]\nshake = 9\n"
    assert read(bodies=bodies) == BodyForm(nod=radians(4), shoulders=radians(3))
    assert read("{ nod = 0, look = 0.5 }", bodies) == BodyForm(shoulders=radians(3), look=0.5)
    assert read() == NO_BODY


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("{ nod = -1 }", r"gesture own: body: nod is -1 deg, outside \[0, 45\]"),
        ("{ trunk = { roll = 60 } }", r"trunk.roll is 60 deg, outside \[-45, 45\]"),
        ("{ look = 1.5 }", r"look is 1.5, outside \[0, 1\]"),
        ("{ face = { smile = 2 } }", r"face.smile is 2, outside \[0, 1\]"),
        ("{ face = { xyzzy = 1 } }", "no expression for xyzzy"),
        ("{ knees = 3 }", "knees"),
        ('{ gaze = "feet" }', "feet"),
    ],
)
def test_invalid_body_motion_of_a_gesture_is_refused_with_its_field_or_value(read, body, said):
    with pytest.raises(ConfigError, match=said):
        read(body)


def test_user_gestures_inherit_the_body_motion_of_their_category(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(written())
    lexicon = Lexicon.load(path)
    assert lexicon.forms_by_id["own"].body == lexicon.bodies["beat"] != NO_BODY
    assert Lexicon.load().bodies == lexicon.bodies


def test_gestuary_gestures_inherit_the_body_motion_of_their_category(tmp_path):
    where = "".join(
        f'<{name}Location value="{word}"/>'
        for name, word in (("horizontal", "XC"), ("vertical", "YCC"), ("frontal", "ZNear"))
    )
    hand = f'<hand side="RIGHT"><symbolicPosition>{where}</symbolicPosition></hand>'
    path = tmp_path / "own.xml"
    path.write_text(f'<gestuary><gesture id="g" category="BEAT"><phase>{hand}</phase></gesture></gestuary>')
    lexicon = Lexicon.load(path)
    assert lexicon.forms_by_id["g"].body == lexicon.bodies["beat"]


def test_accompanying_body_motion_is_mirrored_with_the_hands():
    form = Lexicon.load().forms_by_id["think"]
    body = form.body
    assert mirror_form(mirror_form(form)).body == body
    assert mirror_form(form).body == in_mode(form, "left").body == body.mirrored
    assert in_mode(form, "right").body == body
    assert in_mode(form, "both").body == body.symmetric
    assert body.symmetric.mirrored == body.symmetric


def test_body_motion_with_weight_zero_is_empty_and_with_one_unchanged():
    for form in Lexicon.load().forms:
        assert form.body.weighed(head=0.0, trunk=0.0, shoulders=0.0, face=0.0) == NO_BODY
        assert form.body.weighed(head=1.0, trunk=1.0, shoulders=1.0, face=1.0) == replace(form.body, along=1.0)


def test_text_of_a_body_motion_lists_angles_gaze_and_face():
    body = BodyForm(head=Turn(torsion=radians(-8)), nod=radians(4), gaze="hands", face=(("smile", 0.5),))
    assert str(body) == "head right 8, nod 4 deg; eyes on the hands; smile 0.5"
    assert str(NO_BODY) == ""
