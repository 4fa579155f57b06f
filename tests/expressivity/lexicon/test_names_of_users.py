"""Tests of names in a user's lexicon for own and built-in gestures."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon

BUILTIN_LEXICON = Lexicon.load()
GESTURE_TOML = """
category = "beat"
[[gesture]]
id = "own"
meanings = ["wink", "mine"]
keys = [{ right = { at = ["XC", 0.1, "ZNear"], palm = "in up" } }, { both = { at = [0.3, 0.2, 0.5] } }]
"""
SYNONYM_TOML = """
[synonyms]
own = ["mine", "Hello"]
greet_wave = ["ciao"]
[classes.dance]
gesture = "own"
words = ["dance"]
"""


def test_user_synonyms_override_builtin_ones_and_user_classes_give_substitutes(tmp_path: Path):
    (tmp_path / "own.toml").write_text(GESTURE_TOML + SYNONYM_TOML.lstrip())
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


def test_meanings_serve_as_names_of_user_gestures_but_not_of_builtin_ones(tmp_path: Path):
    (tmp_path / "own.toml").write_text(GESTURE_TOML)
    assert Lexicon.load(tmp_path / "own.toml").find("wink").form.id == "own"
    assert Lexicon.load().sense(BUILTIN_LEXICON.find("belly").form).words[-1] == "pregnant"
    assert BUILTIN_LEXICON.find("pregnant") is None


def test_user_gesture_file_may_contain_only_synonyms(tmp_path: Path):
    (tmp_path / "names.toml").write_text('[synonyms]\ngreet_wave = ["servus"]\n')
    assert Lexicon.load(tmp_path / "names.toml").find("Servus!").form.id == "greet_wave"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("greet_wave =", "greet_wafe =", r"synonym ciao: no gesture greet_wafe; did you mean greet_wave\?"),
        ('"mine"', '"ciao"', "synonym ciao of greet_wave is one of own already"),
        ('"mine"', '"Stop_RH"', "synonym Stop_RH of own is a gesture itself"),
        ('"mine"', '"RH"', "synonym 'RH' of own has no word that describes a movement"),
        ('gesture = "own"', 'gesture = "owner"', r"class dance: no gesture owner"),
        ('category = "beat"', "", "has gestures and no category"),
    ],
)
def test_invalid_synonym_or_class_in_a_user_file_is_refused_with_its_cause(tmp_path: Path, old, new, message):
    assert old in GESTURE_TOML + SYNONYM_TOML
    (tmp_path / "own.toml").write_text((GESTURE_TOML + SYNONYM_TOML.lstrip()).replace(old, new))
    with pytest.raises(ConfigError, match=message):
        Lexicon.load(tmp_path / "own.toml")
