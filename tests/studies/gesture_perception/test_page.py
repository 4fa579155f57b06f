"""Page of the study in a browser, and the answers that it writes."""

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.studies.gesture_perception.analysis import analyse_recognition
from kinesic.studies.gesture_perception.answers import ANSWER_COLUMNS, read_gesture_answers
from kinesic.studies.gesture_perception.design import Meaning, draw_questions
from kinesic.studies.gesture_perception.page import COMPARISON_COUNT, RECOGNITION_COUNT, write_gesture_page
from kinesic.studies.gesture_perception.stimuli import SampledMotion, StimulusPair

from ...chromium import Page, binary, opened

pytestmark = pytest.mark.realtime

CONDITIONS = ("whole_body=0", "power=-1")
HOSTILE = "</script><img src=x onerror=window.hacked=1>"


@pytest.fixture(scope="module")
def robot(known) -> Robot:
    return known.robot


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory, robot: Robot) -> Path:
    """Page of a study of thirty gestures with simple motions."""
    names = [f"gesture_{k}" for k in range(29)] + [HOSTILE]
    questions = draw_questions([Meaning(name, Sense((f"{name}!",), "emblem")) for name in names], 0)
    joint_count = len(robot.skeleton.names)
    motions = {
        name: SampledMotion(np.linspace(0, 0.1 + k / 100, 20)[:, None] * np.ones(joint_count))
        for k, name in enumerate(names)
    }
    pairs = [
        StimulusPair(
            name, condition, {"standard": motions[name], "changed": SampledMotion(np.zeros((15, joint_count)))}
        )
        for condition in CONDITIONS
        for name in names[:8]
    ]
    path = tmp_path_factory.mktemp("study") / "index.html"
    write_gesture_page(path, robot, questions, motions, pairs)
    return path


@contextmanager
def ready(study: Path) -> Iterator[Page]:
    """Open the page in a new browser profile, before the start."""
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    with opened(study.as_uri()) as page:
        page.call("Emulation.setDeviceMetricsOverride", width=320, height=240, deviceScaleFactor=1, mobile=False)
        page.until("document.readyState === 'complete' && typeof state === 'object'")
        if page.value("scene === null"):
            pytest.skip("this Chromium draws no WebGL 2")
        page.value("study.pace = 500")  # fast motions for a quick test
        yield page


@pytest.fixture
def page(study: Path) -> Iterator[Page]:
    with ready(study) as result:
        yield result


@pytest.fixture(scope="module")
def unbegun(study: Path) -> Iterator[Page]:
    """Shared page for tests that do not start the study."""
    with ready(study) as result:
        yield result


def choose(page: Page, choice: str) -> None:
    """Answer the question and continue."""
    page.until("document.querySelectorAll('fieldset').length === 1")
    assert page.value("document.getElementById('next').disabled")
    place = page.value("state.place")
    page.value(f"{choice}.click(), document.getElementById('next').click()")
    page.until(f"state.place > {place} || !document.getElementById('thanks').hidden")


def download_answers(page: Page, path: Path) -> Path:
    path.write_text(page.value("fetch(document.getElementById('file').href).then((file) => file.text())"), newline="")
    return path


RIGHT = 'document.querySelector(`input[value="${byId.get(state.order[state.place - 1].id).stimulus}"]`)'
STANDARD = "document.querySelector('input[value=standard]')"


def test_answers_of_a_perfect_participant_are_read_back(page: Page, tmp_path: Path):
    count = page.value("state.order.length")
    assert count == RECOGNITION_COUNT + COMPARISON_COUNT * len(CONDITIONS)
    page.click("#begin")
    with page.undrawn():
        for k in range(count):
            choose(page, RIGHT if k < RECOGNITION_COUNT else STANDARD)
    page.until("!document.getElementById('thanks').hidden")
    file = download_answers(page, tmp_path / "answers.csv")
    assert file.read_text().split("\n")[0] == ",".join(ANSWER_COLUMNS)
    answers = read_gesture_answers([file])
    result = analyse_recognition(answers.recognitions)
    assert result is not None
    assert result.overall.rate == 1.0
    assert len(result.gestures) == RECOGNITION_COUNT
    assert set(Counter(recognition.place for recognition in answers.recognitions).items()) == {(k, 4) for k in range(6)}
    for condition in CONDITIONS:
        own = [preference for preference in answers.preferences if preference.condition == condition]
        assert Counter(item.place for item in own) == {0: 3, 1: 3}, "the standard is first in half of the pairs"
        assert {item.chosen for item in own} == {"standard"}


def test_study_page_orders_answer_options_at_random(unbegun: Page):
    orders = {tuple(unbegun.value("drawn().map((item) => item.options.join())")) for _ in range(5)}
    assert len(orders) == 5


def test_study_page_draws_the_robot_and_plays_its_motion_once(page: Page):
    page.value("study.pace = 1")
    page.click("#begin")
    page.until("canvas.style.visibility === 'visible'")
    assert page.value("canvas.width") > 100
    page.until("document.querySelectorAll('fieldset').length === 1")
    assert page.value("found('stage').style.display") == "none"
    page.call("Page.reload")
    page.until("document.readyState === 'complete' && typeof state === 'object' && state.place === 2")


def test_gesture_study_page_ignores_invalid_stored_state(unbegun: Page):
    first = unbegun.value("JSON.stringify(state.order[0])")
    for order in ('[{"id": "nowhere", "options": []}]', "[null]", "[7]", f"[{first.replace('gesture_', 'x')}]"):
        kept = f'{{"participant": "ab", "order": {order}, "place": 0, "rows": []}}'
        assert not unbegun.value(f"sound({kept})"), order
    assert unbegun.value(f'sound({{"participant": "ab", "order": [{first}], "place": 0, "rows": []}})')


def test_study_page_escapes_gesture_names(unbegun: Page, study: Path):
    assert study.read_text().count("</script>") == 2
    unbegun.value("ask('chosen', 'which?', Object.entries(study.meanings), 'list')")
    assert HOSTILE in unbegun.value("document.getElementById('questions').textContent")
    assert unbegun.value("window.hacked ?? 0") == 0
    assert unbegun.value("document.images.length") == 0


def test_study_page_without_webgl_shows_a_message(page: Page):
    page.call("Page.enable")
    without = "HTMLCanvasElement.prototype.getContext = () => null; window.flat = true"
    page.call("Page.addScriptToEvaluateOnNewDocument", source=without)
    page.call("Page.reload")
    page.until("window.flat && document.readyState === 'complete' && typeof state === 'object'")
    assert page.value("document.getElementById('begin').disabled")
    assert not page.value("document.getElementById('unable').hidden")


def test_two_studies_store_answers_separately(study: Path, tmp_path: Path, robot: Robot):
    names = [f"gesture_{k}" for k in range(6)]
    questions = draw_questions([Meaning(name, Sense((f"{name}!",), "emblem")) for name in names], 0)
    other = tmp_path / "other.html"
    write_gesture_page(other, robot, questions, {name: SampledMotion(np.zeros((5, 22))) for name in names})
    kept = [path.read_text().split('"name": "')[1].split('"')[0] for path in (study, other)]
    assert len(set(kept)) == 2
    assert all(name.startswith("kinesic-gestures-") for name in kept)
