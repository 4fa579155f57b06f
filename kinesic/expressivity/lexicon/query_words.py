"""Function words and related movement words of gesture searches."""

from collections.abc import Iterable, Mapping, Sequence

from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.names import split_words, word_set
from kinesic.expressivity.lexicon.word_stems import word_stem

# Words that say nothing about a gesture; directions such as up and over count.
_FUNCTION_WORDS = word_set(
    "a an the of to at on with and or is are was be being been am does did it its as than my your his their our "
    "i me you we they he she him her them this that these those some any something someone somebody for "
    "show make do put in front"
)
_RELATED_WORDS = (  # groups of words for similar movements or places of the body
    "apart part spread wide",
    "finger forefinger index",
    "lips lip mouth",
    "throat neck chin",
    "belly stomach tummy",
    "hip waist side",
    "heart chest",
    "arm forearm",
    "wrist watch cuff",
    "cheek face",
    "quiet silent silence hush",
    "big large huge",
    "small tiny little",
    "box container package object",
    "two both",
    "biceps muscle strong strength",
    "clap applause",
    "person somebody speaker",
    "shake swing wag",
    "point indicate",
)
BODY_WORDS = word_set(  # body parts, with more weight in a search, as a hand's place describes a gesture well
    "head temple forehead brow eye eyes ear nose cheek mouth lips chin neck throat shoulder shoulders chest heart "
    "belly stomach hip hips lap thigh wrist forearm elbow arm arms"
)
_TWO_HANDS_WORDS = ("both", "two", "hands")  # words that describe a gesture of both hands
_TOUCH_WORDS: Mapping[str, tuple[str, ...]] = {  # words that describe the touched part of the body
    "chest": ("chest", "touch"),
    "head": ("head", "touch"),
    "hand": ("hands", "touch"),
    "forearm": ("arm", "touch"),
    "upper_arm": ("arm", "touch"),
    "lap": ("lap", "touch"),
}


def content_words(query: str) -> tuple[str, ...]:
    """Return the distinct words of a query without function words.

    A query of function words alone keeps them.
    """
    words = tuple(dict.fromkeys(split_words(query)))
    return tuple(word for word in words if word not in _FUNCTION_WORDS) or words


def search_stem(word: str) -> str:
    """Return a word's stem, equal for inflections such as finger, fingers."""
    return word_stem(word.removesuffix("s") if word.endswith("ers") else word)


def is_function_word(word: str) -> bool:
    """Return whether a word says nothing about a gesture."""
    return word in _FUNCTION_WORDS


def related_words(word: str) -> tuple[str, ...]:
    """Return words for movements or places similar to those of a word."""
    return _RELATED_BY_STEM.get(search_stem(word), ())


def form_words(form: GestureForm) -> Iterable[str]:
    """Return words for a gesture's hands and the touched body parts."""
    if len(form.sides) > 1:
        yield from _TWO_HANDS_WORDS
    touched = {pose.touch for key in form.keys for pose in key.hands.values()}
    for part, words in _TOUCH_WORDS.items():
        if part in touched:
            yield from words


def _group_by_stem(groups: Sequence[str]) -> Mapping[str, tuple[str, ...]]:
    related: dict[str, tuple[str, ...]] = {}
    for group in map(str.split, groups):
        for word in group:
            others = (other for other in group if other != word)
            related[search_stem(word)] = (*related.get(search_stem(word), ()), *others)
    return related


_RELATED_BY_STEM = _group_by_stem(_RELATED_WORDS)
