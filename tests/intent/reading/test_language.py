import tomllib
from pathlib import Path

import pytest

from kinesic.bml.parse import parse
from kinesic.body.config import ConfigError
from kinesic.body.scripts import PHRASE_STOPS, SENTENCE_STOPS
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author, plan_behaviours
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.syllables import count_syllables, stressed_syllable
from kinesic.intent.reading.words import read_text

SAMPLE_SENTENCES = {  # language -> sentences of greeting, denial, question and farewell
    "de": ("Hallo, meine Freunde!", "Ich habe das alte Haus nie gesehen.", "Wo ist der Hund?", "Auf Wiedersehen."),
    "es": ("¡Hola, amigos!", "No he visto nunca la casa vieja.", "¿Dónde está el perro?", "Hasta luego."),
    "ja": ("こんにちは、皆さん。", "私はその古い家を見たことがありません。", "犬はどこですか。", "さようなら。"),
    "it": ("Ciao, amici!", "Non ho mai visto la vecchia casa.", "Dov'è il cane?", "Arrivederci."),
    "nl": ("Hallo, vrienden!", "Ik heb het oude huis nooit gezien.", "Waar is de hond?", "Tot ziens."),
    "pt": ("Olá, amigos!", "Nunca vi a casa velha.", "Onde está o cão?", "Até logo."),
    "fr": ("Bonjour, mes amis !", "Je n'ai jamais vu la vieille maison.", "Où est le chien ?", "Au revoir."),
}
EXPECTED_INTENTS = ("performative-greet", "negation", "question", "performative-farewell")


@pytest.fixture(scope="module")
def lexicon():
    return Lexicon.load()


@pytest.mark.parametrize("language", SAMPLE_SENTENCES)
def test_language_rules_find_greeting_negation_and_question(lexicon, language):
    style = Style.load("neutral")
    for text, meant in zip(SAMPLE_SENTENCES[language], EXPECTED_INTENTS, strict=True):
        chosen = plan_behaviours(text, lexicon, style, language=language)[1].behaviours
        names = {item.intent.name for item in chosen}
        assert meant in names, text
        assert meant == "negation" or "negation" not in names
        assert meant != "negation" or "NOD" not in {item.lexeme for item in chosen}
    block = parse(author(" ".join(SAMPLE_SENTENCES[language]), lexicon, style, language=language))
    assert block.notices == ()
    assert block.behaviours[0].action.script.language == language


@pytest.mark.parametrize("language", SAMPLE_SENTENCES)
def test_text_without_matching_rules_has_only_beats(lexicon, language):
    behaviours = plan_behaviours("Xaluno venda mirolo kestan.", lexicon, Style.load("neutral"), language=language)[1]
    assert {behaviour.intent.name for behaviour in behaviours.behaviours if behaviour.channel == "gesture"} == {
        "accent"
    }


@pytest.mark.parametrize("language", SAMPLE_SENTENCES)
def test_intent_of_every_language_rule_has_a_behaviour_set(language):
    rules = [rule for item in load_language(language).rules.values() for rule in item]
    assert [rule.intent for rule in rules if builtin_sets().find(rule.intent) is None] == []


def test_regional_tag_has_the_rules_of_its_language_and_its_own_voice(lexicon):
    assert load_language("de-AT").rules == load_language("de").rules
    bml = author("Good morning.", lexicon, Style.load("neutral"), language="en_GB")
    assert parse(bml).behaviours[0].action.script.language == "en-gb"
    assert "'Good morning' greets" in bml


@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("de", "Kommst du morgen?"),
        ("fr", "Est-il là ?"),
        ("it", "Ti piace il caffè?"),
        ("nl", "Houd je van koffie?"),
        ("pt", "Você gosta de café?"),
    ],
)
def test_question_without_question_word_gets_a_questioning_face(lexicon, language, text):
    behaviours = plan_behaviours(text, lexicon, Style.load("neutral"), language=language)[1].behaviours
    assert [behaviour.lexeme for behaviour in behaviours if behaviour.channel == "face"] == ["question"]


@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("de", "Kein Problem."),
        ("it", "Nessun problema."),
        ("it", "Non solo questo."),
        ("nl", "Geen probleem."),
        ("pt", "Não só isso."),
    ],
)
def test_idioms_with_negative_words_get_no_head_shake(lexicon, language, text):
    behaviours = plan_behaviours(text, lexicon, Style.load("neutral"), language=language)[1].behaviours
    assert "SHAKE" not in {behaviour.lexeme for behaviour in behaviours}


def test_sentence_ends_after_a_word_of_one_letter_but_not_after_an_initial(lexicon):
    rules = load_language("it")
    assert read_text("Non so chi è. Andiamo via.", rules).kinds == ("statement", "statement")
    assert read_text("Il mio amico J. Rossi parla.", rules).kinds == ("statement",)


PLAIN_TEXTS = tomllib.loads(Path(__file__).with_name("plain_texts.toml").read_text())


@pytest.mark.parametrize("language", PLAIN_TEXTS)
def test_language_without_rules_has_beats_pauses_and_questions(lexicon, language):
    sample = PLAIN_TEXTS[language]
    passage, selection = plan_behaviours(sample["text"], lexicon, Style.load("neutral"), language=language)
    words = [word.text for word in passage.words]
    assert len(passage.kinds) == sample["sentences"]
    assert "".join(words) == "".join(
        letter for letter in sample["text"] if letter not in SENTENCE_STOPS + PHRASE_STOPS + " "
    )
    questions = {behaviour.intent.word for behaviour in selection.behaviours if behaviour.intent.name == "question"}
    assert [words[index] for index in questions] == [sample["asked"]]
    assert {behaviour.intent.name for behaviour in selection.behaviours if behaviour.channel == "gesture"} <= {
        "accent",
        "question",
    }
    assert any(behaviour.intent.name == "accent" for behaviour in selection.behaviours)
    (warning,) = selection.warnings
    assert "only voice, beats, pauses and questions" in warning
    assert f"{language}" in warning


@pytest.mark.parametrize(
    ("word", "language", "count", "stressed"),
    [
        ("coração", "pt", 3, 2),
        ("difícil", "pt", 3, 1),
        ("falar", "pt", 2, 1),
        ("jóvenes", "es", 3, 0),
        ("hablar", "es", 2, 1),
        ("città", "it", 2, 1),
        ("parlare", "it", 3, 1),
        ("vergeten", "nl", 3, 1),
        ("universiteit", "nl", 5, 3),
        ("gehen", "de", 2, 0),
        ("verstehen", "de", 3, 1),
        ("universität", "de", 5, 4),
        ("amicale", "fr", 3, 2),
        ("хорошо", "ru", 3, 1),
        ("teşekkürler", "tr", 4, 3),
        ("你好", "zh", 2, 1),
        ("καλημέρα", "el", 4, 2),
    ],
)
def test_syllables_and_stress_follow_the_language(word, language, count, stressed):
    assert (count_syllables(word, language), stressed_syllable(word, language)) == (count, stressed)


def test_language_tag_that_looks_like_a_path_is_rejected(tmp_path):
    (tmp_path / "own.toml").write_text("")
    for tag in (f"{tmp_path}/own", "../robots/upper22", "behaviours", "fml.", "x" * 300, "a\0"):
        with pytest.raises(ConfigError, match="is not a language tag"):
            load_language(tag)
