"""Names that a user's lexicon gives to gestures, of its own and of ours."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon

LEXICON = Lexicon.load()
GESTURE = """
category = "beat"
[[gesture]]
id = "own"
meanings = ["wink", "mine"]
keys = [{ right = { at = ["XC", 0.1, "ZNear"], palm = "in up" } }, { both = { at = [0.3, 0.2, 0.5] } }]
"""
SYNONYMS = """
[synonyms]
own = ["mine", "Hello"]
greet_wave = ["ciao"]
[classes.dance]
gesture = "own"
words = ["dance"]
"""


def test_names_of_the_user_come_first(tmp_path: Path):
    (tmp_path / "own.toml").write_text(GESTURE + SYNONYMS.lstrip())
    lexicon = Lexicon.load(tmp_path)
    assert [lexicon.find(name).form.id for name in ("Mine_RH", "hello", "ciao", "hi")] == [
        "own",
        "own",
        "greet_wave",
        "greet_wave",
    ]
    assert (
        lexicon.find("dance_waltz").substitute
        == 'substituted by own: it stands for its class, dance; "waltz" is left out'
    )


def test_meanings_of_the_users_gestures_find_them_and_those_of_ours_do_not(tmp_path: Path):
    (tmp_path / "own.toml").write_text(GESTURE)
    assert Lexicon.load(tmp_path / "own.toml").find("wink").form.id == "own"
    assert Lexicon.load().sense(LEXICON.find("belly").form).words[-1] == "pregnant"
    assert LEXICON.find("pregnant") is None


def test_names_alone_make_a_file(tmp_path: Path):
    (tmp_path / "names.toml").write_text('[synonyms]\ngreet_wave = ["servus"]\n')
    assert Lexicon.load(tmp_path / "names.toml").find("Servus!").form.id == "greet_wave"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("greet_wave =", "greet_wafe =", r"synonym ciao: no gesture greet_wafe; did you mean greet_wave\?"),
        ('"mine"', '"ciao"', "synonym ciao of greet_wave is one of own already"),
        ('"mine"', '"Stop_RH"', "synonym Stop_RH of own is a gesture itself"),
        ('"mine"', '"RH"', "synonym 'RH' of own has no word that says what is done"),
        ('gesture = "own"', 'gesture = "owner"', r"class dance: no gesture owner"),
        ('category = "beat"', "", "has gestures and no category"),
    ],
)
def test_a_wrong_name_teaches(tmp_path: Path, old, new, message):
    assert old in GESTURE + SYNONYMS
    (tmp_path / "own.toml").write_text((GESTURE + SYNONYMS.lstrip()).replace(old, new))
    with pytest.raises(ConfigError, match=message):
        Lexicon.load(tmp_path / "own.toml")
