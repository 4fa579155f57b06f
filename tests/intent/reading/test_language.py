import pytest

from kinesic.bml.parse import parse
from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author, plan_behaviours
from kinesic.intent.behaviour_sets import own_sets
from kinesic.intent.reading.language import load_language

SAID = {  # greeting, denial, question, farewell
    "de": ("Hallo, meine Freunde!", "Ich habe das alte Haus nie gesehen.", "Wo ist der Hund?", "Auf Wiedersehen."),
    "es": ("¡Hola, amigos!", "No he visto nunca la casa vieja.", "¿Dónde está el perro?", "Hasta luego."),
    "ja": ("こんにちは、皆さん。", "私はその古い家を見たことがありません。", "犬はどこですか。", "さようなら。"),
    "fr": ("Bonjour, mes amis !", "Je n'ai jamais vu la vieille maison.", "Où est le chien ?", "Au revoir."),
}
MEANT = ("performative-greet", "negation", "question", "performative-farewell")


@pytest.fixture(scope="module")
def lexicon():
    return Lexicon.load()


@pytest.mark.parametrize("language", SAID)
def test_a_language_greets_denies_and_asks(lexicon, language):
    style = Style.load("neutral")
    for text, meant in zip(SAID[language], MEANT, strict=True):
        chosen = plan_behaviours(text, lexicon, style, language=language)[1].behaviours
        names = {each.intent.name for each in chosen}
        assert meant in names, text
        assert meant == "negation" or "negation" not in names
        assert meant != "negation" or "NOD" not in {each.lexeme for each in chosen}
    block = parse(author(" ".join(SAID[language]), lexicon, style, language=language))
    assert block.notices == ()
    assert block.behaviours[0].action.script.language == language


@pytest.mark.parametrize("language", SAID)
def test_beats_alone_are_left_where_no_rule_holds(lexicon, language):
    behaviours = plan_behaviours("Xaluno venda mirolo kestan.", lexicon, Style.load("neutral"), language=language)[1]
    assert {each.intent.name for each in behaviours.behaviours if each.channel == "gesture"} == {"accent"}


@pytest.mark.parametrize("language", SAID)
def test_every_rule_of_a_language_has_a_behaviour_set(language):
    rules = [rule for found in load_language(language).rules.values() for rule in found]
    assert [rule.intent for rule in rules if own_sets().find(rule.intent) is None] == []


def test_a_language_without_rules_is_refused_and_a_region_is_not():
    with pytest.raises(ConfigError, match="no rules for the language 'xx'; there are de, en, es, fr, ja"):
        load_language("xx")
    assert load_language("de-AT").tag == "de"


def test_the_name_of_a_language_is_no_path(tmp_path):
    (tmp_path / "own.toml").write_text("")
    for tag in (f"{tmp_path}/own", "../robots/upper22", "behaviours", "x" * 300, "a\0"):
        with pytest.raises(ConfigError, match="no rules for the language"):
            load_language(tag)
