"""The page in a browser, and what it writes."""

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.studies.gesture_perception.analysis import analyse_recognition
from kinesic.studies.gesture_perception.answers import COLUMNS, read_gesture_answers
from kinesic.studies.gesture_perception.design import Meaning, draw_questions
from kinesic.studies.gesture_perception.page import COMPARISONS, RECOGNITIONS, write_gesture_page
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
    """The page of a study of thirty gestures, each of which turns one hinge a little."""
    names = [f"gesture_{k}" for k in range(29)] + [HOSTILE]
    questions = draw_questions([Meaning(name, Sense((f"{name}!",), "emblem")) for name in names], 0)
    hinges = len(robot.skeleton.names)
    motions = {
        name: SampledMotion(np.linspace(0, 0.1 + k / 100, 20)[:, None] * np.ones(hinges))
        for k, name in enumerate(names)
    }
    pairs = [
        StimulusPair(name, condition, {"standard": motions[name], "changed": SampledMotion(np.zeros((15, hinges)))})
        for condition in CONDITIONS
        for name in names[:8]
    ]
    path = tmp_path_factory.mktemp("study") / "index.html"
    write_gesture_page(path, robot, questions, motions, pairs)
    return path


@contextmanager
def ready(study: Path) -> Iterator[Page]:
    """A page with a profile of its own, on which nobody has begun."""
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    with opened(study.as_uri()) as page:
        page.call("Emulation.setDeviceMetricsOverride", width=320, height=240, deviceScaleFactor=1, mobile=False)
        page.until("document.readyState === 'complete' && typeof state === 'object'")
        if page.value("scene === null"):
            pytest.skip("this Chromium draws no WebGL 2")
        page.value("study.pace = 500")  # the speed of motions is not the matter here
        yield page


@pytest.fixture
def page(study: Path) -> Iterator[Page]:
    with ready(study) as found:
        yield found


@pytest.fixture(scope="module")
def unbegun(study: Path) -> Iterator[Page]:
    """For tests that do not begin."""
    with ready(study) as found:
        yield found


def choose(page: Page, choice: str) -> None:
    """Answers what is asked, and goes on."""
    page.until("document.querySelectorAll('fieldset').length === 1")
    assert page.value("document.getElementById('next').disabled")
    place = page.value("state.place")
    page.value(f"{choice}.click(), document.getElementById('next').click()")
    page.until(f"state.place > {place} || !document.getElementById('thanks').hidden")


def written(page: Page, path: Path) -> Path:
    path.write_text(page.value("fetch(document.getElementById('file').href).then((file) => file.text())"), newline="")
    return path


RIGHT = 'document.querySelector(`input[value="${byId.get(state.order[state.place - 1].id).stimulus}"]`)'
STANDARD = "document.querySelector('input[value=standard]')"


def test_a_participant_who_knows_all_is_read_back_as_such(page: Page, tmp_path: Path):
    count = page.value("state.order.length")
    assert count == RECOGNITIONS + COMPARISONS * len(CONDITIONS)
    page.click("#begin")
    with page.undrawn():
        for k in range(count):
            choose(page, RIGHT if k < RECOGNITIONS else STANDARD)
    page.until("!document.getElementById('thanks').hidden")
    file = written(page, tmp_path / "answers.csv")
    assert file.read_text().split("\n")[0] == ",".join(COLUMNS)
    answers = read_gesture_answers([file])
    result = analyse_recognition(answers.recognitions)
    assert result is not None
    assert result.overall.rate == 1.0
    assert len(result.gestures) == RECOGNITIONS
    assert set(Counter(each.place for each in answers.recognitions).items()) == {(k, 4) for k in range(6)}
    for condition in CONDITIONS:
        own = [each for each in answers.preferences if each.condition == condition]
        assert Counter(each.place for each in own) == {0: 3, 1: 3}, "the standard comes first in half of the pairs"
        assert {each.chosen for each in own} == {"standard"}


def test_orders_are_those_of_chance(unbegun: Page):
    orders = {tuple(unbegun.value("drawn().map((item) => item.options.join())")) for _ in range(5)}
    assert len(orders) == 5


def test_the_robot_is_drawn_and_moves_once(page: Page):
    page.value("study.pace = 1")
    page.click("#begin")
    page.until("canvas.style.visibility === 'visible'")
    assert page.value("canvas.width") > 100
    page.until("document.querySelectorAll('fieldset').length === 1")
    assert page.value("found('stage').style.display") == "none"
    page.call("Page.reload")
    page.until("document.readyState === 'complete' && typeof state === 'object' && state.place === 2")


def test_what_we_did_not_write_ourselves_is_not_believed(unbegun: Page):
    first = unbegun.value("JSON.stringify(state.order[0])")
    for order in ('[{"id": "nowhere", "options": []}]', "[null]", "[7]", f"[{first.replace('gesture_', 'x')}]"):
        kept = f'{{"participant": "ab", "order": {order}, "place": 0, "rows": []}}'
        assert not unbegun.value(f"sound({kept})"), order
    assert unbegun.value(f'sound({{"participant": "ab", "order": [{first}], "place": 0, "rows": []}})')


def test_names_of_gestures_are_no_markup(unbegun: Page, study: Path):
    assert study.read_text().count("</script>") == 2
    unbegun.value("ask('chosen', 'which?', Object.entries(study.meanings), 'list')")
    assert HOSTILE in unbegun.value("document.getElementById('questions').textContent")
    assert unbegun.value("window.hacked ?? 0") == 0
    assert unbegun.value("document.images.length") == 0


def test_a_browser_that_cannot_draw_says_so(page: Page):
    page.call("Page.enable")
    without = "HTMLCanvasElement.prototype.getContext = () => null; window.flat = true"
    page.call("Page.addScriptToEvaluateOnNewDocument", source=without)
    page.call("Page.reload")
    page.until("window.flat && document.readyState === 'complete' && typeof state === 'object'")
    assert page.value("document.getElementById('begin').disabled")
    assert not page.value("document.getElementById('unable').hidden")


def test_two_studies_keep_answers_apart(study: Path, tmp_path: Path, robot: Robot):
    names = [f"gesture_{k}" for k in range(6)]
    questions = draw_questions([Meaning(name, Sense((f"{name}!",), "emblem")) for name in names], 0)
    other = tmp_path / "other.html"
    write_gesture_page(other, robot, questions, {name: SampledMotion(np.zeros((5, 22))) for name in names})
    kept = [path.read_text().split('"name": "')[1].split('"')[0] for path in (study, other)]
    assert len(set(kept)) == 2
    assert all(name.startswith("kinesic-gestures-") for name in kept)
