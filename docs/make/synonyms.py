"""Write docs/reference/synonyms.md: all names of each gesture, and the classes with a default gesture."""

from collections.abc import Iterator
from pathlib import Path

from kinesic.expressivity.lexicon.lexicon import Lexicon

PAGE = Path(__file__).parents[1] / "reference/synonyms.md"
HEAD = """# Names of gestures

`docs/make/synonyms.py` writes this page from `kinesic/configs/gestures/synonyms.toml`: {count} additional names of
{gestures} gestures. The names come from the lexicons of Greta, SmartBody, EMBR, Asap, NAO and Reachy, from BML's
gesture types and McNeill's classes, and from everyday English. A name belongs to one gesture only, on which all
speakers of the language should agree.
[Gesture files](gesture-files.md#how-a-lexeme-finds-a-gesture) explains the search for a lexeme, and
[Write a gesture](../how-to/write-a-gesture.md#names-of-your-own) how to add names.

`kinesic gestures show LEXEME` prints the result for any lexeme.

## Classes

A lexeme that is no name, but contains a word of a class, selects a gesture of this class. The other words of the lexeme
choose the gesture: in `point_left`, `point` is the class, and `left` chooses. If they fit no gesture, the default
gesture of the class in the second column is made, and the report lists the behaviour as `substituted`.

Some phrases contain a word of a class in another sense. They do not select the class, and the last column lists them.
An unknown word before `point`, as in `match_point`, does not select the class either.

| class | gesture | words | but not in |
|---|---|---|---|
{classes}

## Synonyms
"""


def page(lexicon: Lexicon) -> str:
    """Return the page in Markdown."""
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
    yield "| gesture | movement | names |\n|---|---|---|"
    for form in sorted(lexicon.forms, key=lambda form: form.id):
        if names := lexicon.names_of(form.id):
            yield f"| `{form.id}` | {lexicon.sense(form).says} | {', '.join(names)} |"


if __name__ == "__main__":
    PAGE.write_text(page(Lexicon.load()), encoding="utf-8")
