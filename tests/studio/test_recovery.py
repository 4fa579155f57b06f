"""Preservation of edits in reloads and crashes of the page."""

import random
from time import sleep

import pytest

from kinesic.serve.desk.archive import ARCHIVE_NAME

from ..chromium import opened
from .conftest import Studio

pytestmark = pytest.mark.realtime

DRAWN = False  # WebGL pictures are tested in test_stage.py
EMPTY = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">{}</bml>'
GESTURE = '<gesture id="g{0}" lexeme="offer" start="{0}"/>'
MAX_LOST_TIME = 2.0  # [s] largest age of edits that a crash may lose
QUESTION, LOADED = "Page.javascriptDialogOpening", "Page.loadEventFired"  # events of the browser


def type_text(studio: Studio, text: str) -> None:
    """Replace the document like typed text, without waiting for its plan."""
    area = "document.querySelector('#text')"
    studio.page.value(f"{area}.value = {text!r}; {area}.dispatchEvent(new Event('input')); 0")


def wait_for_studio(studio: Studio) -> None:
    studio.page.until("window.kinesicStudio !== undefined && kinesicStudio.state().connection === 'open'")


def reload(studio: Studio) -> None:
    """Reload the page, and confirm if the browser asks about unsaved changes."""
    studio.page.call("Page.enable")
    studio.page.value("setTimeout(() => location.reload()); 0")
    if studio.page.event(QUESTION, LOADED) == QUESTION:
        studio.page.call("Page.handleJavaScriptDialog", accept=True)
        studio.page.event(LOADED)
    wait_for_studio(studio)


def crash(studio: Studio) -> None:
    """Kill the page's process, and open the studio again in the same tab."""
    studio.page.call("Inspector.enable")
    studio.page.call("Page.enable")
    studio.page.post("Page.crash")
    studio.page.event("Inspector.targetCrashed")
    studio.page.call("Page.navigate", url=f"http://localhost:{studio.server.port}/")
    studio.page.event(LOADED)
    wait_for_studio(studio)


def test_studio_marks_and_backs_up_unsaved_changes_until_they_are_saved(studio: Studio):
    studio.write(EMPTY.format(GESTURE.format(1)))
    studio.page.until("document.title.startsWith('•')")
    studio.until("s.place === 'folder'")
    backups = list((studio.folder / ARCHIVE_NAME).glob("backup_*.txt"))
    assert [path.read_text().partition("\n")[2] for path in backups] == [studio.state("text")]
    studio.save_as("tea")
    studio.until("!s.unsaved && s.name === 'tea.bml'")
    assert studio.page.value("document.title").startswith("tea.bml")
    studio.page.until("!Object.keys(localStorage).some((key) => key.startsWith('kinesic.backup.'))")
    while list((studio.folder / ARCHIVE_NAME).glob("backup_*.txt")):
        sleep(0.02)


def test_studio_replaces_an_existing_document_only_after_confirmation_and_keeps_it_as_a_version(studio: Studio):
    (studio.folder / "other.bml").write_text("theirs")
    studio.write(EMPTY.format(GESTURE.format(2)))
    studio.save_as("other")
    studio.page.until("!document.querySelector('#save-question').hidden")
    assert (studio.folder / "other.bml").read_text() == "theirs"
    assert studio.page.value("document.querySelector('#save-ok').textContent") == "Replace"
    studio.page.click("#save-ok")
    studio.until("!s.unsaved && s.name === 'other.bml'")
    assert (studio.folder / "other.bml").read_text() == studio.state("text")
    option = "[...document.querySelectorAll('#versions option')]"
    studio.page.until(f"{option}.length === 1")
    menu = "document.querySelector('#examples')"
    studio.page.value(f"{menu}.value = {option}[0].value; {menu}.dispatchEvent(new Event('change')); 0")
    studio.until("s.text === 'theirs' && s.unsaved")
    studio.page.click("#undo")
    studio.until("!s.unsaved")


def test_reloaded_studio_page_shows_the_unsaved_text_again(studio: Studio):
    text = EMPTY.format(GESTURE.format(3))
    type_text(studio, text)
    reload(studio)
    assert studio.state("text") == text
    assert studio.state("unsaved")


def test_document_of_an_open_studio_tab_is_not_listed_for_recovery(studio: Studio):
    type_text(studio, EMPTY.format(GESTURE.format(4)))
    studio.until("s.place === 'folder'")
    with_tab = "navigator.locks.query().then(({held}) => held.map(({name}) => name))"
    (edited,) = [name for name in studio.page.value(with_tab) if name.startswith("kinesic.backup.")]
    assert studio.page.value(f"localStorage.getItem({edited!r}) !== null")
    (studio.folder / "listed.bml").write_text("x")
    menu = "document.querySelector('#examples')"
    studio.page.value(f"{menu}.dispatchEvent(new Event('pointerdown')); 0")
    studio.page.until("document.querySelector('#saved option[value=\"file:listed.bml\"]') !== null")
    assert studio.page.value("document.querySelectorAll('#unsaved option').length") == 0


def test_another_browser_recovers_unsaved_studio_text_from_the_backup_in_the_folder(studio: Studio):
    text = EMPTY.format(GESTURE.format(5))
    type_text(studio, text)
    studio.until("s.place === 'folder'")
    with opened(f"http://localhost:{studio.server.port}/", drawn=False) as page:
        page.until("window.kinesicStudio !== undefined && !document.querySelector('#recovery').hidden")
        page.click("#recover")
        page.until(f"kinesicStudio.state().text === {text!r}")


@pytest.mark.parametrize("count", [4, pytest.param(200, marks=pytest.mark.soak)])
def test_browser_crash_and_page_reload_lose_no_studio_edit(studio: Studio, count: int):
    """Expect edits older than two seconds after crashes, all after reloads."""
    chance = random.Random(1)
    for number in range(count):
        text = EMPTY.format(GESTURE.format(number))
        type_text(studio, text)
        if chance.random() < 0.5:
            reload(studio)
        else:
            sleep(MAX_LOST_TIME)
            crash(studio)
            studio.page.until("!document.querySelector('#recovery').hidden")
            studio.page.click("#recover")
        studio.until(f"s.text === {text!r}")
