"""Page in a browser with the real server: text, timeline, stage and stop."""

import json
from pathlib import Path
from time import monotonic, sleep

import pytest
from websockets.sync.client import ClientConnection, connect

from kinesic import Performer

from ..chromium import MAX_WAIT
from .conftest import Studio

pytestmark = pytest.mark.realtime

DRAWN = False  # WebGL pictures are tested in test_stage.py
WORDS = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">'
    '<speech id="s"><text>Say <sync id="m1"/>one and then <sync id="m2"/>another.</text></speech>'
    '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m1"/></bml>'
)
DECLARED = ' xmlns:kinesic="urn:kinesic"'  # declaration of the prefix of kinesic's attributes
ESCAPE = 27
REQUEST_DELAY = 180  # [ms] time after typing, shortly after the page's plan request at 150 ms


def middle(studio: Studio, selector: str) -> tuple[float, float]:
    area = f"document.querySelector({selector!r}).getBoundingClientRect()"
    x, y = studio.page.value(f"(r => [r.x + r.width / 2, r.y + r.height / 2])({area})")
    return x, y


def rests(client: ClientConnection) -> None:
    """Wait until the robot rests."""
    end = monotonic() + MAX_WAIT
    while '"resting"' not in status(client):
        assert monotonic() < end
        sleep(0.05)


def status(client: ClientConnection) -> str:
    client.send('{"do": "status"}')
    while '"status"' not in (message := client.recv(MAX_WAIT)):
        pass
    return message


def test_studio_page_opens_with_a_planned_example_document_and_its_words(studio: Studio):
    studio.until("s.connection === 'open' && s.drawn > 0 && !s.flat")
    rows = "[...document.querySelectorAll('[data-block]')].map(block => block.dataset.block)"
    draft = studio.state("draft")
    moving = {item["behaviour"] for item in draft["syncs"]}
    assert moving <= set(studio.page.value(rows))
    assert len(studio.page.value("[...document.querySelectorAll('.word')].map(word => word.textContent)")) > 20
    assert studio.page.value("document.querySelector('#examples').options.length") > 8


def test_studio_shows_a_document_error_with_line_and_column_until_it_is_corrected(studio: Studio):
    studio.write(WORDS.replace("<gesture", "\n  <gesture").replace("s:m1", "nowhere:end"))
    fault = studio.page.value("document.querySelector('#fault').textContent")
    assert fault.startswith("2:")
    assert "nowhere" in fault
    assert studio.page.value("document.querySelector('#gutter .wrong').textContent") == "2"
    studio.write(WORDS)
    assert studio.page.value("document.querySelector('#fault').hidden")


def test_stroke_dragged_onto_a_word_in_the_studio_is_synchronised_with_it_and_can_be_undone(studio: Studio):
    studio.write(WORDS)
    word = studio.page.value("[...document.querySelectorAll('.word')].findIndex(word => word.textContent === 'then')")
    planned, onto = studio.state("planned"), middle(studio, f'[data-word="{word}"]')
    studio.page.drag(middle(studio, '[data-stroke="g"]'), (onto[0] - 9, onto[1] + 3), onto)
    studio.until(f"s.planned > {planned}")
    marked = WORDS.replace("then", '<sync id="m3"/>then').replace("s:m1", "s:m3")
    assert studio.state("text") == marked
    sync = next(s for s in studio.state("draft")["syncs"] if s["behaviour"] == "g" and s["sync"] == "stroke")
    words = {piece["mark"]: piece["start"] for piece in studio.state("draft")["words"]}
    assert abs(sync["asked"] - words["m3"]) < 1e-3
    studio.page.click("#undo")
    assert studio.state("text") == WORDS
    studio.page.click("#redo")
    assert studio.state("text") == marked


def test_studio_shows_the_speech_waveform_and_plays_by_the_clock_of_the_speech(studio: Studio):
    studio.write(WORDS)
    if not studio.page.value("document.querySelector('.sound svg') !== null"):
        pytest.skip("no voice is heard here: espeak is not installed")
    outline = studio.page.value("document.querySelector('.sound path').getAttribute('d')")
    assert len(outline.split("L")) > 2 * 50 * 0.9 * studio.state("draft")["words"][-1]["end"]
    studio.page.click("#play")
    studio.until("s.heard !== null && s.heard > 0 && Math.abs(s.time - s.heard) < 0.25")
    studio.page.click("#play")
    assert studio.state("heard") is None
    studio.page.click("#voice")
    studio.page.click("#play")
    studio.until("s.time > 0.1")
    assert studio.state("heard") is None
    studio.page.click("#play")
    studio.page.click("#voice")


def exported(studio: Studio, folder: Path, name: str) -> Path:
    """Return the downloaded CSV export of the page's document."""
    folder.mkdir()
    studio.page.call(
        "Browser.setDownloadBehavior",
        behavior="allow",
        downloadPath=str(folder),
        browserContextId=studio.page.context,
    )
    menu = "document.querySelector('#export')"
    studio.page.value(f"{menu}.value = 'csv', {menu}.dispatchEvent(new Event('change'))")
    end, file = monotonic() + MAX_WAIT, folder / name
    while not file.exists():
        assert monotonic() < end, f"not downloaded: {name}, but {list(folder.iterdir())}"
        sleep(0.05)
    return file


def test_studio_exports_a_performance_as_a_download(studio: Studio, tmp_path: Path):
    studio.write(WORDS)
    rows = exported(studio, tmp_path / "downloads", "doc.csv").read_text().splitlines()
    assert rows[0].startswith("time_s,")
    assert float(rows[-1].split(",")[0]) == pytest.approx(studio.state("draft")["duration"], abs=0.5), "it ends at rest"


def test_studio_export_of_a_hostile_document_id_writes_only_to_the_downloads(studio: Studio, tmp_path: Path):
    """Use ids that are paths of other files, or of links."""
    letter = tmp_path / "mine" / "dear.csv"
    letter.parent.mkdir()
    letter.write_text("dear")
    (tmp_path / "mine" / "link.csv").symlink_to(letter)
    before = sorted(studio.folder.iterdir())
    for name in ("dear", "link"):
        studio.write(WORDS.replace('id="doc"', f'id="{letter.with_name(name)}"'))
        plain = str(letter.with_name(name)).strip("/").replace("/", "_")[:64].rstrip("_-")
        file = exported(studio, tmp_path / f"downloads-{name}", f"{plain}.csv")
        assert file.read_text().startswith("time_s,")
        assert letter.read_text() == "dear"
        assert sorted(path.name for path in letter.parent.iterdir()) == ["dear.csv", "link.csv"]
    assert sorted(studio.folder.iterdir()) == before


def test_studio_slider_writes_the_expressivity_of_the_selected_behaviour_into_the_document(studio: Studio):
    studio.write(WORDS)
    studio.page.click('[data-block="g"]')
    planned, slider = studio.state("planned"), "document.querySelector('[name=spatial]')"
    studio.page.value(f"{slider}.value = '0.5', {slider}.dispatchEvent(new Event('change'))")
    studio.until(f"s.planned > {planned}")
    assert studio.state("text") == WORDS.replace('"s:m1"', '"s:m1" kinesic:spatial="0.5"').replace(
        'id="doc"', f'id="doc"{DECLARED}'
    )
    studio.page.click('[data-block="g"]')
    assert not studio.page.value("document.querySelector('#inspector').hidden"), "a further click keeps it selected"
    studio.page.click('[data-lane="face"]')
    assert studio.state("selected") == []


def test_studio_slider_writes_the_expressivity_of_the_whole_block_into_the_document(studio: Studio):
    words = WORDS.replace('id="g"', 'id="doc"')  # a behaviour may have the id of the block
    studio.write(words)
    studio.page.click("#choose-block")
    assert studio.page.value("document.querySelector('#chosen').textContent") == "Whole performance"
    planned, slider = studio.state("planned"), "document.querySelector('[name=power]')"
    studio.page.value(f"{slider}.value = '-0.5', {slider}.dispatchEvent(new Event('change'))")
    studio.until(f"s.planned > {planned}")
    assert studio.state("text") == words.replace('id="doc"', f'id="doc"{DECLARED} kinesic:power="-0.5"', 1)
    assert studio.page.value("document.querySelector('#fault').hidden")


def test_escape_key_in_the_studio_stops_the_robot_until_resume(studio: Studio):
    studio.write(WORDS)
    studio.page.click("#perform")
    studio.until("s.report.planned.some((angle, k) => Math.abs(angle - s.report.angles[k]) > 0) && s.mode === 'robot'")
    studio.page.press("Escape", ESCAPE)
    studio.until("s.stopped")
    with connect(f"ws://localhost:{studio.server.port}/") as other:
        other.send('{"do": "status"}')
        assert json.loads(other.recv(10))["state"] == "stopped"
    assert studio.page.value("document.querySelector('#perform').disabled")
    studio.page.click("#resume")
    studio.until("!s.stopped && !document.querySelector('#perform').disabled")


def test_emergency_stop_in_the_studio_does_not_wait_for_a_long_plan(studio: Studio):
    beats = "".join(
        f'<gesture id="g{k}" lexeme="BEAT" mode="{("LEFT", "RIGHT")[k % 2]}_HAND" stroke="{2 + 3 * k}"/>'
        for k in range(40)
    )
    long = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="long">{beats}</bml>'
    planned, area = studio.state("planned"), "document.querySelector('#text')"
    typed = f"{area}.value = {long!r}; {area}.dispatchEvent(new Event('input'));"
    stopped = "s => s.stopped ? done(s.planned) : requestAnimationFrame(() => look(kinesicStudio.state()))"
    stop = f"document.querySelector('#stop').click(); const look = {stopped}; look(kinesicStudio.state())"
    then = studio.page.value(f"new Promise(done => {{ {typed} setTimeout(() => {{ {stop} }}, {REQUEST_DELAY}) }})")
    assert then == planned, "the plan is not there yet"
    studio.page.click("#resume")
    studio.until(f"s.planned > {planned} && !s.stopped")
    assert studio.page.value("document.querySelectorAll('[data-stroke]').length") == 40
    assert studio.state("draft")["duration"] > 115.0


def test_studio_shows_motion_that_another_client_requested(studio: Studio):
    studio.page.click("#mode-robot")
    studio.until("s.report !== null")
    rest = studio.state("report")["planned"]
    with connect(f"ws://localhost:{studio.server.port}/") as other:
        other.send(WORDS.replace('"doc"', '"theirs"'))
        studio.page.until(f"kinesicStudio.state().report.planned.some((angle, k) => Math.abs(angle - {rest}[k]) > 0.2)")


def test_gesture_is_copied_edited_saved_and_performed_in_the_studio(studio: Studio):
    page, search = studio.page, "document.querySelector('#search')"
    page.value("document.querySelector('#lexicon').open = true")
    page.value(f"{search}.value = 'idea bowl', {search}.dispatchEvent(new Event('input'))")
    page.until("document.querySelectorAll('#found b').length > 1")  # the server's list; the page alone finds one
    assert page.value("document.querySelector('#found b').textContent") == "conduit"
    page.click("[aria-label='Edit a copy of conduit']")
    studio.until("s.draft?.gesture === 'my_conduit'")
    page.click("#keys .group button:nth-child(2)")
    hand = studio.state("left")
    page.drag((hand["x"], hand["y"]), (hand["x"] + 10, hand["y"] - 15), (hand["x"] + 20, hand["y"] - 30))
    studio.until("s.past === 1 && s.draft.keys[1].both.at[1] > 0.24")  # higher than before
    assert studio.state("draft")["keys"][0]["both"]["at"] == [0.16, 0.14, 0.38]
    studio.save_as("mine")
    page.until("document.querySelector('#file').textContent === 'mine.toml'")
    text = WORDS.replace('lexeme="offer" mode="RIGHT_HAND"', 'lexeme="my_conduit"')
    plan = Performer(lexicon=studio.folder / "mine.toml").plan(text)
    assert plan.keyframes.outcomes["g"].kind == "realised"
    page.click("#perform")
    studio.until("s.mode === 'robot' && s.report.planned.some((angle, k) => Math.abs(angle) > 0.5)")
    page.click("#undo")
    studio.until("s.past === 0 && s.text.includes('[0.18, 0.24, 0.76]')")
    page.value(
        "(m => { m.value = 'example:one_gesture'; m.dispatchEvent(new Event('change')) })"
        "(document.querySelector('#examples'))"
    )
    studio.until("s.draft?.block === 'one'")
    studio.write(text)  # the saved gesture is available at once
    studio.until("s.draft?.block === 'doc' && s.draft.notices.length === 0")
    assert {item["outcome"] for item in studio.state("draft")["behaviours"]} == {"realised"}
    with connect(f"ws://localhost:{studio.server.port}/") as other:
        other.send('{"do": "interrupt"}')
        rests(other)
        other.send(text.replace('"doc"', '"with"'))
        results = [other.recv(30)]
        while "blockProgress" not in results[-1]:  # all warnings come before the start
            results.append(other.recv(30))
    assert not [item for item in results if "warningFeedback" in item]


def test_studio_saves_a_document_unchanged_and_lists_it_among_saved_files(studio: Studio):
    studio.write(WORDS)
    studio.save_as("mine")
    studio.page.until("document.querySelector('#file').textContent === 'mine.bml'")
    assert (studio.folder / "mine.bml").read_text() == WORDS
    studio.page.until("[...document.querySelectorAll('#saved option')].some(each => each.value === 'file:mine.bml')")


def test_javascript_heap_grows_by_less_than_4_mb_in_1_5_s_of_looped_studio_playback(studio: Studio):
    """Run a short form of the soak test in test_long.py."""
    studio.write(WORDS)
    studio.page.click("#loop")
    studio.page.click("#play")
    before = studio.heap()
    studio.rest(1.5)
    assert studio.heap() - before < 4e6
    studio.page.click("#play")
    studio.page.click("#loop")


def test_studio_runs_no_code_in_hostile_names_and_ignores_broken_server_answers(studio: Studio):
    evil = '<img src="x" onerror="hacked = true"><script>hacked = true</script>'
    escaped = evil.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    studio.write(WORDS.replace("another", escaped).replace('lexeme="offer"', f'lexeme="{escaped}"'))
    studio.until("s.draft.notices.length > 0 || !document.querySelector('#fault').hidden")
    for name in ("search", "lexeme", "token"):
        item = "['input', 'change'].forEach(kind => e.dispatchEvent(new Event(kind)))"
        studio.page.value(f"(e => {{ e.value = {evil!r}; {item} }})(document.querySelector('#{name}'))")
    for item in (
        '{"told": "body"}',
        '{"told": "body", "angles": [1], "planned": "x", "servos": 7}',
        '{"told": "reach", "id": "x"}',
        "{",
        '{"told": null}',
        f"<warningFeedback>{escaped}</warningFeedback>",
        "\0",
    ):
        studio.page.value(f"kinesicStudio.robot.wire.hear({item!r})")
    studio.page.value("kinesicStudio.robot.wire.waiting.forEach(answered => answered({told: 'plan', angles: 5}))")
    studio.write("\n" * 11_000)
    assert studio.page.value("document.querySelectorAll('#gutter li').length") == 10_000
    studio.page.click("#mode-robot")
    studio.until("s.report !== null && s.report.planned.length === s.report.angles.length")
    assert studio.page.value("document.querySelectorAll('img, main script').length") == 0
    assert studio.page.value("window.hacked === undefined")
    studio.page.click("#mode-plan")
    studio.page.value("document.querySelector('#search').value = ''")
    studio.write(WORDS)
    assert studio.page.value("document.querySelector('#fault').hidden")


def test_every_behaviour_added_from_the_studio_palette_is_performed(studio: Studio):
    studio.write('<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="new"></bml>')
    page, line = studio.page, "document.querySelector('#line')"
    page.value(f"{line}.value = 'Hello & welcome.'; document.querySelector('#say-line').requestSubmit(); 0")
    values = page.value("[...document.querySelectorAll('#add option')].map(each => each.value).filter(each => each)")
    menu = "document.querySelector('#add')"
    for number, value in enumerate(values):
        page.value(f"kinesicStudio.playback.player.duration = 99; kinesicStudio.playback.player.seek({3 * number}); 0")
        page.value(f"{menu}.value = {value!r}; {menu}.dispatchEvent(new Event('change')); 0")
    count = 1 + len(values)
    studio.until(f"s.draft.behaviours.length === {count} || !document.querySelector('#fault').hidden")
    outcomes = {item["id"]: (item["outcome"], item["why"]) for item in studio.state("draft")["behaviours"]}
    assert {outcome for outcome, _ in outcomes.values()} == {"realised"}, outcomes
    assert "Hello &amp; welcome." in studio.state("text")
