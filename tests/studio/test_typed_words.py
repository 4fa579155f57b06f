"""Words typed in the studio are counted, marked, performed, saved and backed up before gestures are chosen."""

from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
DOCUMENT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}"></bml>'
FIRST = "No, I did not say that! It is tea versus coffee today."
SECOND = "Look at these three big boxes over there."
PENDING = "8 new words are not yet in the performance"


def content(studio: Studio, name: str) -> object:
    return studio.page.value(f"document.querySelector('#{name}').textContent")


def type_words(studio: Studio, text: str) -> None:
    studio.page.value(
        f"(f => {{ f.value = {text!r}; f.dispatchEvent(new Event('input')) }})(document.querySelector('#plain'))"
    )


def show_first(studio: Studio, name: str) -> None:
    """Show a new document, and choose the gestures of its words."""
    studio.write(DOCUMENT.format(name))
    studio.until(f"s.draft?.block === {name!r}")
    type_words(studio, FIRST)
    studio.page.click("#plain-make")
    studio.until("s.draft?.block === 'said' && document.querySelectorAll('#spoken button').length > 0")


def open_entry(studio: Studio, group: str, beginning: str) -> None:
    """Choose the entry of the menu Open whose label begins with a text."""
    menu = "document.querySelector('#examples')"
    studio.page.value(f"{menu}.dispatchEvent(new Event('pointerdown')); 0")
    options = f"[...document.querySelectorAll('#{group} option')]"
    entry = f"{options}.find(({{label}}) => label.startsWith({beginning!r}))"
    studio.page.until(f"{entry} !== undefined")
    studio.page.value(f"{menu}.value = {entry}.value; {menu}.dispatchEvent(new Event('change')); 0")


def test_studio_counts_and_names_typed_words_that_have_no_gestures_yet(studio: Studio):
    show_first(studio, "counted")
    assert content(studio, "plain-count") == "12 words, about 4 s"
    assert content(studio, "plain-pending") == ""
    type_words(studio, SECOND)
    assert content(studio, "plain-count") == "8 words, about 3 s"
    assert content(studio, "plain-pending") == PENDING
    studio.page.click("#plain-make")
    studio.until("s.draft?.words.some(({text}) => text.includes('boxes'))")
    studio.page.until("document.querySelector('#plain-pending').textContent === ''")


def test_perform_button_of_the_studio_first_chooses_gestures_for_newly_typed_words(studio: Studio):
    show_first(studio, "performed")
    studio.until("s.connection === 'open' && !s.stopped")
    type_words(studio, SECOND)
    studio.page.click("#perform")
    studio.until("s.text.includes('boxes') && s.performs")
    assert "coffee" not in studio.state("text")
    assert content(studio, "plain-pending") == ""


def test_stop_button_of_the_studio_cancels_a_performance_that_still_waits_for_its_gestures(studio: Studio):
    show_first(studio, "withdrawn")
    studio.until("!s.performs")
    type_words(studio, SECOND)
    studio.page.value("['perform', 'stop'].forEach((name) => document.querySelector(`#${name}`).click())")
    studio.until("s.text.includes('boxes') && s.stopped")
    studio.page.click("#resume")
    studio.rest(1.0)
    assert not studio.state("performs")


def test_save_button_of_the_studio_first_chooses_gestures_for_newly_typed_words(studio: Studio):
    show_first(studio, "saved")
    studio.save_as("typed")
    studio.until("!s.unsaved && s.name === 'typed.bml'")
    type_words(studio, SECOND)
    assert studio.state("unsaved")
    assert studio.page.value("document.title").startswith("•")
    studio.page.click("#save")
    studio.until("!s.unsaved")
    assert "boxes" in (studio.folder / "typed.bml").read_text()


def test_words_typed_in_the_studio_are_recovered_from_the_backup_after_another_document_was_opened(studio: Studio):
    show_first(studio, "left")
    studio.save_as("left")
    studio.until("!s.unsaved && s.name === 'left.bml'")
    type_words(studio, SECOND)
    open_entry(studio, "built-in", "")
    studio.until("s.name !== 'left.bml' && !s.unsaved")
    open_entry(studio, "unsaved", "left.bml")
    studio.until("s.name === 'left.bml' && s.unsaved")
    assert studio.page.value("document.querySelector('#plain').value") == SECOND
    studio.page.until(f"document.querySelector('#plain-pending').textContent === {PENDING!r}")
    assert "coffee" in studio.state("text")


def test_click_on_a_word_in_the_studio_scrolls_to_its_list_of_gestures(studio: Studio):
    show_first(studio, "scrolled")
    pane = "document.querySelector('#pane-words')"
    studio.page.value(f"document.querySelector('#document').style.height = '330px'; {pane}.scrollTop = 0")
    studio.page.value("document.querySelector('#spoken button').click()")
    studio.page.until("document.querySelectorAll('#alternatives-list button').length > 3")
    place = "document.querySelector({!r}).getBoundingClientRect()"
    title, edges = place.format("#alternatives-title"), place.format("#pane-words")
    studio.page.until(f"{title}.top >= {edges}.top && {title}.bottom <= {edges}.bottom")
    first = place.format("#alternatives-list button")
    assert studio.page.value(f"{first}.bottom <= {edges}.bottom")
    studio.page.value("document.querySelector('#document').style.height = ''")
