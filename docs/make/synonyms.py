"""Writes docs/synonyms.md: every name that means a gesture, and the classes that one gesture stands for."""

from collections.abc import Iterator
from pathlib import Path

from kinesic.expressivity.lexicon.lexicon import Lexicon

PAGE = Path(__file__).parents[1] / "synonyms.md"
HEAD = """# Names of gestures

Written by `docs/make/synonyms.py` from `kinesic/configs/gestures/synonyms.toml`: {count} names, beside their own, of
{gestures} gestures: of the lexicons of Greta, SmartBody, EMBR, Asap, NAO and Reachy, of BML's gesture types and
McNeill's classes, and of everyday English. A name stands with one gesture only, which everybody who speaks the language
should accept. [my-gestures.md](my-gestures.md#how-a-lexeme-finds-a-gesture) says how a lexeme is looked up, and how to
add names.

`kinesic gestures show LEXEME` says what any lexeme becomes.

## Classes

A word of a class anywhere in a name finds the gesture of this class that the other words ask for (`point_left`:
`left`), and else the one gesture that stands for all of the class; the behaviour is then `substituted`.
A phrase in which the word says something else names no class, nor does a point behind an unknown word (`match_point`).

| class | gesture | words | but not in |
|---|---|---|---|
{classes}

## Synonyms
"""


def page(lexicon: Lexicon) -> str:
    """The page, in Markdown."""
    classes = "\n".join(
        f"| {each.name} | `{each.gesture}` | {_listed(each.words)} | {_listed(each.not_in)} |"
        for each in lexicon.classes
    )
    gestures = len({gesture for _, gesture in lexicon.synonyms})
    head = HEAD.format(count=len(lexicon.synonyms), gestures=gestures, classes=classes)
    return "\n".join([head, *_rows(lexicon), ""])


def _listed(phrases: tuple[tuple[str, ...], ...]) -> str:
    return ", ".join(" ".join(phrase) for phrase in phrases)


def _rows(lexicon: Lexicon) -> Iterator[str]:
    yield "| gesture | what is done | names that mean it |\n|---|---|---|"
    for form in sorted(lexicon.forms, key=lambda form: form.id):
        if names := lexicon.names_of(form.id):
            yield f"| `{form.id}` | {lexicon.sense(form).says} | {', '.join(names)} |"


if __name__ == "__main__":
    PAGE.write_text(page(Lexicon.load()), encoding="utf-8")
