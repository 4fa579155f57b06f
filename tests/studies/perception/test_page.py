"""Page of the study in a browser, and the answers that it writes."""

import csv
import json
import re
from pathlib import Path

import pytest
from PIL import Image

from kinesic.body.config import ConfigError
from kinesic.studies.perception.answers import ANSWER_COLUMNS, read_answers
from kinesic.studies.perception.design import list_stimuli
from kinesic.studies.perception.page import file_of, write_study_page

from ...chromium import Page, binary, opened

pytestmark = pytest.mark.realtime


@pytest.fixture
def page(tmp_path: Path):
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    (tmp_path / "stimuli").mkdir()
    for stimulus in list_stimuli():
        Image.new("RGB", (8, 8)).save(tmp_path / "stimuli" / file_of(stimulus))
    path = tmp_path / "index.html"
    write_study_page(path)
    path.write_text(path.read_text().replace('"seconds": 2.2', '"seconds": 0.05'))  # short films for a quick test
    with opened(path.as_uri()) as page:
        page.until("document.readyState === 'complete' && typeof state === 'object'")
        yield page


def answer(page: Page, points: int = 4) -> None:
    """Answer all questions about the shown face and continue."""
    page.until("document.querySelectorAll('fieldset').length === 5")
    assert page.value("document.getElementById('next').disabled")
    for k in range(5):
        page.click(f"fieldset:nth-of-type({k + 1}) label:nth-of-type({points})")
    place = page.value("state.place")
    page.click("#next")
    page.until(f"state.place > {place} || !document.getElementById('thanks').hidden")


def download_answers(page: Page) -> str:
    return page.value("fetch(document.getElementById('file').href).then((file) => file.text())")


def test_participant_can_stop_the_face_study_early(page: Page, tmp_path: Path):
    page.value("document.getElementById('age').value = '34'")
    page.click("#begin")
    for points in (4, 2, 5):
        answer(page, points)
    page.until("document.querySelectorAll('fieldset').length === 5")
    page.click("#stop")
    page.until("!document.getElementById('thanks').hidden")
    rows = download_answers(page).split("\r\n")
    assert rows[0] == ",".join(ANSWER_COLUMNS)
    assert len(rows) == 3 + 2
    assert [row.split(",")[ANSWER_COLUMNS.index("realism")] for row in rows[1:4]] == ["4", "2", "5"]
    assert len({row.split(",")[ANSWER_COLUMNS.index("stimulus")] for row in rows[1:4]}) == 3
    assert {row.split(",")[ANSWER_COLUMNS.index("age")] for row in rows[1:4]} == {"34"}


def test_answers_of_all_32_faces_are_read_back(page: Page, tmp_path: Path):
    order = page.value("state.order")
    assert len(order) == len(set(order)) == 32
    known = {stimulus.code: stimulus for stimulus in list_stimuli()}
    cells = [(known[name].action.region, known[name].presentation) for name in order]
    assert {cells.count(cell) for cell in cells} == {8}
    page.click("#begin")
    for _ in order:
        page.until("document.querySelectorAll('fieldset').length === 5")
        page.value("document.querySelectorAll('label:nth-of-type(3) input').forEach((choice) => choice.click())")
        page.value("document.getElementById('next').click()")
    page.until("!document.getElementById('thanks').hidden")
    path = tmp_path / "answers.csv"
    path.write_text(download_answers(page), newline="")
    asked = [known[name] for name in order if known[name].action.label]
    assert len(read_answers([path])) == len(asked)


FOREIGN = (
    '{"participant": "../../x<script>", "order": [], "place": 0, "rows": []}',
    '{"participant": "=1+1,\\n", "order": [], "place": 0, "rows": []}',
    '{"participant": "ab", "order": ["nowhere"], "place": 0, "rows": []}',
    '{"participant": "ab", "order": [], "place": 1e9, "rows": []}',
    '{"participant": "ab", "order": [], "place": 0, "rows": [{"realism": {}}]}',
    "[1, 2",
    "7",
)


def test_face_study_page_ignores_invalid_stored_state(page: Page):
    for kept in FOREIGN:
        page.value(f"localStorage.setItem('kinesic-study', {json.dumps(kept)}); window.before = true")
        page.call("Page.reload")
        page.until("!window.before && document.readyState === 'complete' && typeof state === 'object'")
        page.until("state.order?.length === 32")
        assert re.fullmatch("[0-9a-f]{1,8}", page.value("state.participant")), kept
        assert page.value("state.place") == 0, kept


def test_hostile_values_break_neither_answer_rows_nor_page(page: Page, tmp_path: Path):
    page.click("#begin")
    answer(page)
    page.until("document.querySelectorAll('fieldset').length === 5")
    hostile = '</script><img src=x onerror="window.hacked=1">,"\r\n=1+1'
    page.value(f"state.participant = {json.dumps(hostile)}; state.rows[0].participant = {json.dumps('=' + hostile)}")
    page.click("#stop")
    page.until("!document.getElementById('thanks').hidden")
    path = tmp_path / "answers.csv"
    path.write_text(download_answers(page), newline="")
    with path.open(newline="") as lines:
        (row,) = csv.DictReader(lines)
    assert row["participant"] == "'=" + hostile
    assert row["place"] == "1"
    assert page.value("window.hacked ?? 0") == 0
    assert page.value("document.querySelectorAll('script').length") == 2


def test_study_page_runs_only_its_own_scripts(page: Page):
    page.value("document.body.insertAdjacentHTML('beforeend', '<img src=x: onerror=\"window.hacked=1\">')")
    page.value("document.body.append(Object.assign(document.createElement('script'), {text: 'window.hacked = 2'}))")
    page.until("document.querySelector('img[onerror]').complete")
    assert page.value("window.hacked ?? 0") == 0


@pytest.mark.parametrize(
    "url", ["javascript:alert(1)", "file:///etc/passwd", "//example.org", "https://a b/", "https://a;script-src *", "x"]
)
def test_answer_server_url_must_be_http(url: str, tmp_path: Path):
    with pytest.raises(ConfigError, match="must be a URL such as https://"):
        write_study_page(tmp_path / "index.html", post_to=url)


def test_content_policy_of_a_study_page_allows_connections_only_to_its_answer_server(tmp_path: Path):
    write_study_page(tmp_path / "index.html", post_to="https://example.org:8443/answers?a=';x</script>")
    page = (tmp_path / "index.html").read_text()
    assert 'connect-src blob: https://example.org:8443"' in page
    assert page.count("</script>") == 2


def test_stimulus_film_plays_once_even_after_a_reload(page: Page):
    moving = page.value("state.order.find((id) => byId.get(id).presentation === 'animation')")
    page.value(f"(() => {{ state.order = [{moving!r}, ...state.order.filter((id) => id !== {moving!r})]; keep(); }})()")
    page.click("#begin")
    page.until("document.querySelectorAll('fieldset').length === 5")
    assert page.value("document.querySelectorAll('#stage img').length") == 0
    page.call("Page.reload")
    page.until("document.readyState === 'complete' && typeof state === 'object' && state.place === 2")
    assert page.value("document.getElementById('questions').dataset.stimulus") != moving


HEADER_LINE = ",".join(ANSWER_COLUMNS)
ANSWER_LINE = "p,1,s,female,4,upper,high,with,image,1,4,2,,,,3,3,1.0,30"


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (HEADER_LINE.replace("naturalness", "natural") + "\n" + ANSWER_LINE, "no column naturalness"),
        (
            HEADER_LINE + "\n" + ANSWER_LINE.replace(",3,3,", ",3,9,"),
            "realism is '9', must be a whole number from 1 to 5",
        ),
        (HEADER_LINE + "\n" + ANSWER_LINE.replace("high", "huge"), "strength is 'huge', must be one of low, high"),
        (HEADER_LINE + "\n" + ANSWER_LINE.replace(",1,4,2,", ",1,,2,"), "no answer in column 4"),
        (HEADER_LINE + "\n", "no answer for any of"),
        ("", "no column participant; the file is empty"),
        (HEADER_LINE + "\n" + ANSWER_LINE[:-11], "must have 19 values, like the first line"),
        (HEADER_LINE + "\n" + ANSWER_LINE + ",1", "must have 19 values, like the first line"),
        (HEADER_LINE + "\n" + ANSWER_LINE.replace(",3,3,", ",3,\u0663,"), "must be a whole number"),
        (HEADER_LINE + "\n" + ANSWER_LINE.replace(",3,3,", f",3,{'9' * 5000},"), "must be a whole number"),
        (HEADER_LINE + "\n" + ANSWER_LINE[:-2] + "7", "age is '7', must be a whole number from 10 to 119"),
        (HEADER_LINE + "\n" + ANSWER_LINE.replace("p,1", f"{'p' * 200_000},1"), "is not CSV: field larger"),
    ],
)
def test_invalid_study_answers_are_refused(text: str, what: str, tmp_path: Path):
    path = tmp_path / "answers.csv"
    path.write_text(text)
    with pytest.raises(ConfigError, match=what):
        read_answers([path])


def test_missing_answer_file_is_refused(tmp_path: Path):
    with pytest.raises(ConfigError, match=r"nowhere\.csv: No such file"):
        read_answers([tmp_path / "nowhere.csv"])
