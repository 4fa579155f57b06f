"""Styles in the browser: sliders, user-defined styles and previews."""

from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, Style

from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
WORDS = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">'
    '<speech id="s"><text>Say <sync id="m1"/>one and then <sync id="m2"/>another.</text></speech>'
    '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m1"/></bml>'
)


def begin(studio: Studio) -> None:
    """Select the gesture of a document."""
    studio.write(WORDS)
    studio.until("s.draft?.block === 'doc'")
    if studio.state("selected") != ["g"]:
        studio.page.click('[data-block="g"]')
    studio.page.until("document.querySelector('#own-style').options.length > 7")


def select(studio: Studio, value: str) -> None:
    """Choose an entry of the menu of styles and wait for the plan."""
    planned, menu = studio.state("planned"), "document.querySelector('#own-style')"
    studio.page.value(f"{menu}.value = {value!r}; {menu}.dispatchEvent(new Event('change')); 0")
    studio.until(f"s.planned > {planned}")


def slide(studio: Studio, name: str, value: float) -> None:
    planned, slider = studio.state("planned"), f"document.querySelector('[name={name}]')"
    studio.page.value(f"{slider}.value = '{value}', {slider}.dispatchEvent(new Event('change'))")
    studio.until(f"s.planned > {planned} && s.plannedText === s.text")


def sliders(studio: Studio) -> dict[str, float]:
    values = "[...document.querySelectorAll('#sliders input')].map(each => [each.name, Number(each.value)])"
    return dict(studio.page.value(values))


def marked(studio: Studio, mark: str) -> set[str]:
    """Return the names of the sliders marked as changed."""
    names = f"[...document.querySelectorAll('#sliders .{mark} input')].map(each => each.name)"
    return set(studio.page.value(names))


def save_style(studio: Studio, name: str) -> str:
    """Save the slider values as a style, and return the message."""
    form = "document.querySelector('#style-form')"
    studio.page.value("document.querySelector('#style-status').textContent = ''")
    studio.page.value(
        f"(f => {{ f.value = {name!r}; f.dispatchEvent(new Event('input')) }})(document.querySelector('#style-name'));"
        f"{form}.requestSubmit()"
    )
    studio.page.until("document.querySelector('#style-status').textContent !== ''")
    return studio.page.value("document.querySelector('#style-status').textContent")


def test_studio_sliders_show_the_style_and_mark_values_that_differ_from_neutral(studio: Studio):
    begin(studio)
    assert set(sliders(studio).values()) == {0.0}
    assert not marked(studio, "differs")
    select(studio, "joyful")
    joyful = Style.load("joyful").numbers()["gesture"]
    assert sliders(studio) == joyful
    assert marked(studio, "differs") == {name for name, value in joyful.items() if value}
    assert not marked(studio, "set")
    slide(studio, "power", 0.0)
    assert marked(studio, "set") == {"power"}
    assert "power" not in marked(studio, "differs")
    planned = studio.state("planned")
    studio.page.click("[aria-label='force as the style']")
    studio.until(f"s.planned > {planned}")
    assert sliders(studio)["power"] == joyful["power"]
    assert "kinesic:power" not in studio.state("text")
    select(studio, "")


def test_studio_sliders_show_the_expressivity_that_a_behaviour_inherits_from_its_block(studio: Studio):
    begin(studio)
    declared = 'id="doc" xmlns:kinesic="urn:kinesic" kinesic:style="calm" kinesic:power="0.75"'
    studio.write(WORDS.replace('id="doc"', declared))
    studio.page.until("document.querySelector('[name=power]').value === '0.75'")
    calm = Style.load("calm").numbers()["gesture"]
    assert sliders(studio) == {**calm, "power": 0.75}
    assert not marked(studio, "set")


def test_style_chosen_in_the_studio_for_several_selected_behaviours_is_written_to_each(studio: Studio):
    begin(studio)
    two = WORDS.replace("</bml>", '<gesture id="h" lexeme="beat" mode="LEFT_HAND" stroke="s:m2"/></bml>')
    studio.write(two)
    studio.until("s.draft.behaviours.length === 3")
    studio.page.value("kinesicStudio.tracks.chooseAll(['g', 'h'], false); 0")
    assert studio.page.value("document.querySelector('#chosen').textContent") == "2 selected"
    assert not studio.page.value("document.querySelector('#lexeme-line').checkVisibility()")
    select(studio, "shy")
    assert studio.state("text").count('kinesic:style="shy"') == 2
    assert "kinesic:style" not in studio.state("text").partition(">")[0]
    studio.page.click("#undo")
    assert studio.state("text") == two


def test_style_chosen_in_the_studio_without_a_selection_applies_to_the_whole_performance(studio: Studio):
    begin(studio)
    usual = "document.querySelector('#usual-style').checkVisibility()"
    assert not studio.page.value(usual)
    studio.page.value("kinesicStudio.tracks.chooseAll([], false); 0")
    assert studio.page.value("document.querySelector('#chosen').textContent") == "Whole performance"
    assert studio.page.value(usual), "all choices of styles are in one place"
    select(studio, "calm")
    assert 'kinesic:style="calm"' in studio.state("text").partition(">")[0]
    studio.page.click("#undo")
    assert studio.state("text") == WORDS


def test_user_style_of_the_studio_is_saved_listed_and_written_into_the_document_as_numbers(studio: Studio):
    begin(studio)
    select(studio, "joyful")
    slide(studio, "power", -0.5)
    assert "brisk" in save_style(studio, "brisk")
    saved, base = Style.load(studio.folder / "brisk.toml"), Style.load("joyful")
    assert saved.numbers()["gesture"] == {**base.numbers()["gesture"], "power": -0.5}
    assert (saved.standing, saved.prefers, saved.numbers()["face"]) == (
        base.standing,
        base.prefers,
        {**base.numbers()["face"], "power": -0.5},
    )
    begin(studio)
    select(studio, "own:brisk")
    assert sliders(studio) == saved.numbers()["gesture"]
    text = studio.state("text")
    assert "kinesic:style" not in text
    written = {name for name in EXPRESSIVITY_RANGES if f'kinesic:{name}="' in text}
    assert written == {name for name, value in saved.numbers()["gesture"].items() if value}
    studio.page.click("#undo")
    assert studio.state("text") == WORDS


def test_studio_replaces_an_existing_style_file_only_after_confirmation(studio: Studio):
    begin(studio)
    assert "Saved" in save_style(studio, "twice")
    first = (studio.folder / "twice.toml").read_text()
    slide(studio, "tension", 0.5)
    assert "Replace it?" in save_style(studio, "twice")
    assert (studio.folder / "twice.toml").read_text() == first
    studio.page.value("document.querySelector('#style-form').requestSubmit()")
    studio.page.until("document.querySelector('#style-status').textContent.startsWith('Saved')")
    assert Style.load(studio.folder / "twice.toml").gesture.tension == 0.5
    assert "built-in" in save_style(studio, "joyful")


def test_studio_previews_an_expressivity_change_over_the_time_of_the_selected_behaviour(studio: Studio):
    begin(studio)
    studio.page.value("document.querySelector('#play-changes').checked = true")
    studio.page.value("kinesicStudio.playback.player.seek(0); 0")
    times = "window.played = []; kinesicStudio.styles.preview.at = (at => t => { played.push(t); at(t) })"
    studio.page.value(f"{times}(kinesicStudio.styles.preview.at.bind(kinesicStudio.styles.preview)); 0")
    slide(studio, "spatial", 0.8)
    studio.page.until("kinesicStudio.view.before !== null || played.length > 5")
    studio.page.until("!kinesicStudio.playback.player.playing && kinesicStudio.view.before === null")
    syncs = [sync["planned"] for sync in studio.state("draft")["syncs"] if sync["behaviour"] == "g"]
    played = studio.page.value("played")
    assert abs(min(played[1:]) - max(0.0, min(syncs) - 0.2)) < 0.05
    assert max(syncs) - 0.01 <= studio.state("time") <= max(syncs) + 0.6
    studio.page.value("document.querySelector('#play-changes').checked = false; played.length = 0")
    slide(studio, "spatial", 0.1)
    assert not studio.page.value("kinesicStudio.playback.player.playing")
