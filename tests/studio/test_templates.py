"""Templates of the studio: complete documents that perform as written."""

from pathlib import Path

import pytest

from kinesic import Performer
from kinesic.studio.page import TEMPLATE_FOLDER

from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
TEMPLATES = sorted(TEMPLATE_FOLDER.glob("*.bml"))
NAMES = ["empty", "greeting", "story", "explanation", "refusal", "dialogue"]
MAX_STROKE_ERROR = 0.02  # [s] difference between the requested and the planned time of a stroke


@pytest.fixture(scope="module", params=["upper22 auto", "upper36 durations"])
def performer(request: pytest.FixtureRequest) -> Performer:
    """Performer of a robot whose voice is the best installed one, or silent."""
    robot, voice = request.param.split()
    return Performer(robot=robot, voice=voice)


@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.stem)
def test_studio_template_is_planned_without_warnings_and_with_strokes_on_time(performer: Performer, path: Path):
    plan = performer.plan(path.read_text(encoding="utf-8"))
    assert plan.notices == ()
    assert {outcome.kind for outcome in plan.keyframes.outcomes.values()} <= {"realised"}
    errors = [abs(sync.planned - sync.requested) for sync in plan.syncs if sync.sync == "stroke"]
    assert max(errors, default=0.0) <= MAX_STROKE_ERROR
    assert (len(errors) >= 3) == (path.stem != "0_empty")


def test_new_document_in_the_studio_may_start_from_each_template(studio: Studio):
    options = "[...document.querySelectorAll('#new option')].map(each => each.value)"
    assert studio.page.value(options) == [f"template:{name}" for name in NAMES]
    menu = "document.querySelector('#examples')"
    for path, name in zip(TEMPLATES, NAMES, strict=True):
        planned = studio.state("planned")
        studio.page.value(f"{menu}.value = 'template:{name}'; {menu}.dispatchEvent(new Event('change')); 0")
        studio.until(f"s.planned > {planned} && s.name === '{name}.bml'")
        assert studio.state("text") == path.read_text(encoding="utf-8")
        assert not studio.state("unsaved")
        assert studio.state("draft")["notices"] == []
