"""Text mode of the studio: gestures chosen for a text and replaced by word."""

import re

from kinesic.session.documents import write_bml
from kinesic.session.setup import set_up

from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
EMPTY = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="new"></bml>'
TEXT = "No, I did not say that! There were three big boxes, and it is tea versus coffee today."
WORD = "[...document.querySelectorAll('#spoken button')].find(each => each.textContent.startsWith({!r}))"


def write_words(studio: Studio, text: str) -> None:
    """Type a text into the field, and let the studio choose its gestures."""
    studio.page.value(
        f"(f => {{ f.value = {text!r}; f.dispatchEvent(new Event('input')) }})(document.querySelector('#plain'))"
    )
    studio.page.click("#plain-make")


def perform(studio: Studio, text: str, replaced: str = EMPTY) -> None:
    """Type a text into a new document, and let the studio choose gestures."""
    studio.write(replaced)
    studio.until("s.draft?.block === 'new'")
    write_words(studio, text)
    studio.until("s.draft?.block === 'said' && document.querySelectorAll('#spoken button').length > 0")


def shown(studio: Studio) -> dict[str, str]:
    """Return the shown gestures by word."""
    pairs = (
        "[...document.querySelectorAll('#spoken button')].filter(each => each.querySelector('.shown'))"
        ".map(each => [each.firstChild.textContent, each.querySelector('.shown').textContent])"
    )
    return dict(studio.page.value(pairs))


def choose(studio: Studio, word: str) -> list[list[str]]:
    """Click on a word, and return names and reasons of its alternatives."""
    studio.page.value(f"{WORD.format(word)}.click()")
    studio.page.until("document.querySelectorAll('#alternatives-list button').length > 3")
    rows = "[...document.querySelectorAll('#alternatives-list button')].map(each => each.querySelector('b, .why'))"
    names = studio.page.value(f"{rows}.map(each => each.textContent)")
    reasons = studio.page.value("[...document.querySelectorAll('#alternatives-list .why')].map(e => e.textContent)")
    return [list(pair) for pair in zip(names, reasons, strict=True)]


def test_text_typed_in_the_studio_becomes_the_document_of_the_say_command(studio: Studio):
    perform(studio, TEXT)
    assert studio.state("text") == write_bml(TEXT, set_up())
    assert studio.state("name") == "talk.bml"
    assert studio.state("unsaved"), "a reload must not lose it"
    assert shown(studio) == {"No,": "no low", "versus": "contrast left right"}
    assert studio.page.value("document.querySelector('#spoken-count').textContent") == "18 words, 2 gestures"


def test_studio_shows_the_reason_and_ranked_alternatives_of_the_gesture_of_a_word(studio: Studio):
    perform(studio, TEXT)
    alternatives = choose(studio, "No,")
    (reason,) = re.search(
        r'lexeme="no_low".*? kinesic:reason="([^"]*) [(]negation, .*?[)]"', write_bml(TEXT, set_up())
    ).groups()
    assert studio.page.value("document.querySelector('#alternatives-reason').textContent") == reason
    assert alternatives[0] == ["no low", reason], "without the score"
    assert ["refuse push", "shows the same intent: negation"] in alternatives
    drawn = sum(why != "your own gesture" for _, why in alternatives)  # other tests save gestures on the same page
    studio.page.until(f"document.querySelectorAll('#alternatives-list .figure').length === {drawn}")
    hover = "new PointerEvent('pointerover', {bubbles: true})"
    studio.page.value(f"document.querySelector('#alternatives-list button').dispatchEvent({hover})")
    assert studio.page.value("document.querySelector('#figure-preview').textContent") == "no low"
    assert (
        studio.page.value("document.querySelector('#alternatives-list [aria-pressed=true] b').textContent") == "no low"
    )
    planned = studio.state("planned")
    push = (
        "[...document.querySelectorAll('#alternatives-list button')].find(e => e.textContent.startsWith('refuse push'))"
    )
    studio.page.value(f"{push}.click()")
    studio.until(f"s.planned > {planned}")
    assert shown(studio)["No,"] == "refuse push"
    assert "chosen: shows the same intent: negation" in studio.state("text")
    assert {item["outcome"] for item in studio.state("draft")["behaviours"] if item["type"] == "head"} == {"realised"}
    studio.page.click("#undo")
    studio.until(f"s.planned > {planned} + 1")
    assert shown(studio)["No,"] == "no low"
    gestures = [item for item in studio.state("draft")["behaviours"] if item["type"] == "gesture"]
    other = next(item["id"] for item in gestures if item["label"] != "no_low")
    studio.page.value(f"document.querySelector('.block[data-block=\"{other}\"]').click()")
    chosen = "document.querySelector('#spoken > [aria-pressed=true]').textContent"
    studio.page.until(f"!{chosen}.startsWith('No,')")  # the word of the block that is selected in the timeline


def test_gesture_is_added_to_a_word_in_the_studio_and_removed_again(studio: Studio):
    perform(studio, TEXT)
    before = studio.state("text")
    assert choose(studio, "coffee")
    planned = studio.state("planned")
    studio.page.value("document.querySelector('#alternatives-list li:last-child button').click()")
    studio.until(f"s.planned > {planned}")
    assert shown(studio)["coffee"].startswith("beat")
    assert not studio.page.value("document.querySelector('#inspector').hidden"), "the new gesture is selected"
    studio.page.until("!document.querySelector('#alternatives-remove').hidden")
    planned = studio.state("planned")
    studio.page.click("#alternatives-remove")
    studio.until(f"s.planned > {planned}")
    assert "coffee" not in shown(studio)
    assert studio.state("text").count("<gesture") == before.count("<gesture")


def test_style_of_a_text_is_written_into_its_document_by_the_studio(studio: Studio):
    styled = (
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" kinesic:style="joyful" '
    )
    perform(studio, f"{TEXT} Joy.", f'{styled}id="new"></bml>')
    assert 'kinesic:style="joyful"' in studio.state("text").partition(">")[0]


def test_gesture_and_nod_added_in_the_studio_stay_on_their_words_when_the_text_changes(studio: Studio):
    perform(studio, TEXT)
    studio.page.click("[data-spoken='17']")
    planned, menu = studio.state("planned"), "document.querySelector('#add')"
    studio.page.value(f"{menu}.value = 'Head/nod'; {menu}.dispatchEvent(new Event('change')); 0")
    studio.until(f"s.planned > {planned}")
    choose(studio, "coffee")
    planned = studio.state("planned")
    studio.page.value("document.querySelector('#alternatives-list li:last-child button').click()")
    studio.until(f"s.planned > {planned}")
    picked = shown(studio)["coffee"]
    write_words(studio, f"Well. {TEXT}")
    studio.until("s.text.includes('>Well') && s.text === s.plannedText")
    assert shown(studio)["coffee"] == picked
    marked = "[...document.querySelectorAll('#spoken .picked')].map(each => each.parentNode.firstChild.textContent)"
    assert studio.page.value(marked) == ["coffee"]
    coffee = re.search(r'<sync id="(\w+)"/>today', studio.state("text"))[1]
    assert re.search(rf'<head id="nod" lexeme="NOD" start="s:{coffee}', studio.state("text"))
    status = studio.page.value("document.querySelector('#plain-status').textContent")
    assert "The gesture that you picked stays. The movement that you added yourself stays." in status


def test_text_without_words_typed_in_the_studio_is_refused_and_changes_nothing(studio: Studio):
    perform(studio, TEXT)
    before = studio.state("text")
    studio.page.value(
        "(f => { f.value = '...'; f.dispatchEvent(new Event('input')) })(document.querySelector('#plain'))"
    )
    studio.page.click("#plain-make")
    studio.page.until("document.querySelector('#plain-status').textContent.includes('no words')")
    assert studio.state("text") == before


def test_spoken_words_and_bml_source_are_two_studio_tabs_reached_by_arrow_keys(studio: Studio):
    perform(studio, TEXT)
    page = studio.page
    assert not page.value("document.querySelector('#pane-source').checkVisibility()")
    page.value("document.querySelector('#tab-words').focus()")
    page.press("ArrowRight", 39)
    assert page.value("document.querySelector('#pane-source').checkVisibility()")
    assert page.value("document.activeElement.id") == "tab-source"
    page.press("ArrowLeft", 37)
    assert page.value("document.querySelector('#pane-words').checkVisibility()")
    page.value("document.querySelector('[data-spoken=\"0\"]').focus()")
    page.press("ArrowRight", 39)
    assert page.value("document.activeElement.dataset.spoken") == "1"
