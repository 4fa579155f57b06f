"""Write docs/reference/synonyms.md: all names of each gesture, and the classes with a default gesture."""

from collections.abc import Iterator
from pathlib import Path

from kinesic.expressivity.lexicon.lexicon import Lexicon

PAGE = Path(__file__).parents[1] / "reference/synonyms.md"
HEAD = """# Names of gestures

A document may also request a gesture by a name other than its own, such as `hello` for `greet_wave`. This page lists
{count} additional names of {gestures} gestures. They come from the lexicons of Greta, SmartBody, EMBR, Asap, NAO and
Reachy, from BML's gesture types and McNeill's classes, and from everyday English. Each name belongs to one gesture
only, on which all speakers of the language should agree.

To see which gesture a name finds, run `kinesic gestures show LEXEME`.
[Gesture files](gesture-files.md#how-a-lexeme-finds-a-gesture) explains the search, and
[Write a gesture](../how-to/write-a-gesture.md#names-of-your-own) shows how to add names. The list is in
`kinesic/configs/gestures/synonyms.toml`.

## Classes

If a lexeme is not in the list, but contains a word of a class, it selects a gesture of this class. The other words of
the lexeme choose the gesture: in `point_left`, `point` is the class, and `left` chooses. If they fit no gesture, the
robot makes the default gesture of the class (second column), and the report lists the behaviour as `substituted`.

Some phrases contain a word of a class in another sense. They do not select the class, and the last column lists them.
Neither does `point` after an unknown word, as in `match_point`.

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
