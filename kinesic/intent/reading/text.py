"""Intents of a text, from words, phrases, emotions and turns."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

from kinesic.body.choices import GrammarName
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.reading.denials import drop_harmless_denials, mute_statements
from kinesic.intent.reading.language import ENGLISH_TAG, Language
from kinesic.intent.reading.matching import Finding, find_rules
from kinesic.intent.reading.passage import SPEECH_ID, Passage
from kinesic.intent.reading.phrasing import PhrasePart, accent_of, find_phrases, read_grammar, stressed_near
from kinesic.intent.reading.spacy_parser import parse_grammar

CATEGORY_CERTAINTIES = {"iconic": 0.45, "metaphoric": 0.38}  # certainty of illustrating gestures, by category
MIN_WORD_LENGTH = 3  # [letters] shortest word with an illustrating gesture
LONG_TEXT = 8  # [words] at the beginning of a longer text, the speaker looks away
EMPHASIS_BONUS = 0.25  # bonus on the certainty of intents of emphasised words
EMOTICON_CERTAINTY = 0.7  # certainty of an emotion shown by an emoticon
EMOTION_STYLES = {
    "emotion-joy": "joyful",
    "emotion-joyStrong": "joyful",
    "emotion-sadness": "sad",
    "emotion-anger": "angry",
}
QUESTION_CERTAINTY = 0.7  # certainty of a question that only its punctuation marks
WORD_CACHE_SIZE = 8192  # number of words whose illustrating gesture is cached


def find_intents(
    passage: Passage,
    language: Language,
    lexicon: Lexicon,
    *,
    grammar: GrammarName = "rules",
    begins: bool = True,
    ends: bool = True,
) -> tuple[Intent, ...]:
    """Return all intents of a text, in the order of their strokes.

    The same text gives the same intents.

    Args:
        passage: the text.
        language: its rules.
        lexicon: gestures that may illustrate its words.
        grammar: method that finds the phrase structure; spaCy supports English.
        begins: whether a turn begins with it.
        ends: whether a turn ends with it.

    Raises:
        ConfigError: spaCy or its model is missing.
    """
    if not passage.words:
        return ()
    is_parsed = grammar == "spacy" and passage.language == ENGLISH_TAG
    phrase_structure = parse_grammar(passage) if is_parsed else read_grammar(passage, language)
    clauses = phrase_structure.clauses
    findings = find_rules(passage, language)
    if passage.language != ENGLISH_TAG:
        findings = drop_harmless_denials(findings, passage)
    meant = [_rule_intent(passage, clauses, finding) for finding in findings]
    if passage.language != ENGLISH_TAG:
        meant = [mute_statements(intent, passage, language) for intent in meant]
    asked = {passage.words[intent.word].sentence for intent in meant if intent.name == "question"}
    intents = [
        *meant,
        *(_phrase_intent(passage, part) for part in find_phrases(passage, language, phrase_structure)),
        *_find_illustrations(passage, lexicon),
        *([] if passage.language == ENGLISH_TAG else _find_questions(passage, asked)),
        *_feelings(passage),
        *_find_turns(passage, begins=begins, ends=ends),
    ]
    return tuple(sorted(intents, key=lambda intent: (intent.stroke.seconds, -intent.certainty, intent.name)))


def _rule_intent(passage: Passage, clauses: Sequence[int], finding: Finding) -> Intent:
    rule, last = finding.rule, finding.last
    content = [k for k in range(finding.first, finding.last + 1) if passage.words[k].is_content]
    if rule.reach == "clause":
        last = clauses[finding.last]
    elif rule.reach == "sentence":
        last = passage.sentences[passage.words[finding.first].sentence][-1]
    certainty = min(
        1.0, rule.certainty + EMPHASIS_BONUS * any(w.emphatic for w in passage.words[finding.first : finding.last + 1])
    )
    words_text = " ".join(word.text for word in passage.words[finding.first : finding.last + 1])
    word = content[-1] if content else finding.last
    intent = _make_intent(passage, rule.intent, (finding.first, word, last), certainty, f"'{words_text}' {rule.says}")
    return replace(intent, lexemes=rule.lexemes, style=rule.style)


def _phrase_intent(passage: Passage, part: PhrasePart) -> Intent:
    words_text = " ".join(word.text for word in passage.words[part.first : part.last + 1])
    return _make_intent(
        passage, part.intent, (part.first, part.last, part.last), part.certainty, f"'{words_text}' {part.says}"
    )


def _find_illustrations(passage: Passage, lexicon: Lexicon) -> Iterator[Intent]:
    """Yield intents of words that a lexicon gesture illustrates.

    Examples are `rain`, `write` and `grow`; the names of gestures are English.
    """
    if passage.language != ENGLISH_TAG:
        return
    for k, word in enumerate(passage.words):
        if not word.is_content or len(word.plain) < MIN_WORD_LENGTH:
            continue
        illustration = _find_illustration(lexicon, word.plain)
        if illustration is not None:
            gesture, category = illustration
            why = f"'{word.text}' can be shown: {category} gesture"
            certainty = CATEGORY_CERTAINTIES[category] + EMPHASIS_BONUS * word.emphatic
            yield _make_intent(passage, category, (k, k, k), certainty, why, lexemes=(gesture,))


@lru_cache(maxsize=WORD_CACHE_SIZE)
def _find_illustration(lexicon: Lexicon, word: str) -> tuple[str, str] | None:
    """Return id and category of a word's illustrating gesture, or None."""
    intents = lexicon.find(word)
    if intents is None or intents.substitute or intents.form.category not in CATEGORY_CERTAINTIES:
        return None
    return intents.form.id, intents.form.category


def _find_questions(passage: Passage, asked: Collection[int]) -> Iterator[Intent]:
    """Yield an intent for each question marked by punctuation alone."""
    for sentence, kind in enumerate(passage.kinds):
        indices = passage.sentences[sentence]
        if kind == "question" and indices and sentence not in asked:
            k = accent_of(passage, passage.words[indices[-1]].phrase)
            why = "a question mark ends the sentence"
            yield _make_intent(passage, "question", (indices[0], k, indices[-1]), QUESTION_CERTAINTY, why)


def _feelings(passage: Passage) -> Iterator[Intent]:
    for sentence, feeling in passage.feelings:
        indices = passage.sentences[sentence]
        if indices:
            why = "an emoticon shows it"
            intent = _make_intent(passage, feeling, (indices[0], indices[-1], indices[-1]), EMOTICON_CERTAINTY, why)
            yield replace(intent, style=EMOTION_STYLES.get(feeling, ""))


def _find_turns(passage: Passage, *, begins: bool, ends: bool) -> Iterator[Intent]:
    """Yield intents at turn boundaries and ends of phrases and sentences."""
    last = len(passage.words) - 1
    if begins and last >= LONG_TEXT:
        start, end, why = Moment(f"{SPEECH_ID}:start", 0.0), passage.close(min(2, last)), "eyes go aside to plan"
        yield Intent("turn-begin", start, end, end, 0.5, f"the turn begins: {why}", word=0)
    if ends:
        yield _make_intent(
            passage, "turn-end", (last, last, last), 0.6, "the turn ends: the speaker looks at the listener"
        )
    for indices in passage.phrases if passage.is_over and not ends else passage.phrases[:-1]:
        k = indices[-1]
        is_end = k < last and passage.words[k + 1].sentence != passage.words[k].sentence
        name, unit = ("boundary-sentence", "sentence") if is_end else ("boundary-phrase", "phrase")
        certainty = 0.4 if is_end else 0.15
        yield _make_intent(passage, name, (k, k, k), certainty, f"a {unit} ends with '{passage.words[k].text}'")


def _make_intent(
    passage: Passage,
    name: str,
    place: tuple[int, int, int],
    certainty: float,
    reason: str,
    *,
    lexemes: tuple[str, ...] = (),
) -> Intent:
    """Create an intent with its stroke on a stressed word nearby.

    Args:
        passage: that contains it.
        name: of its behaviour set.
        place: indices of its first word, its main word, and its last word.
        certainty: 0..1.
        reason: description for people.
        lexemes: gestures that show the intent better than those of its behaviour set.
    """
    first, word, last = place
    stressed = stressed_near(passage, word)
    return Intent(
        name=name,
        start=passage.onset(first),
        stroke=passage.stress(stressed),
        end=passage.close(max(last, stressed)),
        certainty=certainty,
        reason=reason,
        lexemes=lexemes,
        word=word,
        phrase=passage.words[stressed].phrase,
    )
