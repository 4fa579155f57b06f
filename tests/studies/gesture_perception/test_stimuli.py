"""What is shown is what is planned, and what is compared differs."""

import base64

import numpy as np
import pytest

from kinesic.bench.naturalness.lexicon import measure_gesture
from kinesic.body.config import ConfigError
from kinesic.studies.gesture_perception.stimuli import (
    MOTION_RATE,
    SEEN,
    SampledMotion,
    changed_setup,
    gesture_documents,
    motion_data,
    plan_motions,
    plan_pairs,
)
from kinesic.studies.gestures.isolated import plan_gesture, write_document

NAMES = ("doubt_shrug", "stop", "offer")


@pytest.fixture(scope="module")
def motions(known) -> dict[str, SampledMotion]:
    return plan_motions(gesture_documents(NAMES, known.lexicon), known)


@pytest.fixture(scope="module")
def documents(known) -> dict[str, str]:
    return gesture_documents(NAMES, known.lexicon)


def test_a_motion_is_the_plans(known, motions: dict[str, SampledMotion]):
    assert tuple(motions) == NAMES
    plan = plan_gesture(known.lexicon.find("stop").form, known)
    angles = motions["stop"].angles
    assert len(angles) - 2 < plan.duration * MOTION_RATE <= len(angles) - 1
    assert angles[60] == pytest.approx(plan.trajectory.at(60 / MOTION_RATE).angles, abs=1e-9)


def test_the_page_gets_it_to_a_hair(motions: dict[str, SampledMotion]):
    (data,) = motion_data([motions["offer"]])
    angles = motions["offer"].angles
    rows = data["step"] * np.frombuffer(base64.b64decode(data["angles"]), "<i2").reshape(data["frames"], -1)
    assert rows == pytest.approx(angles, abs=data["step"])
    assert data["step"] < 2e-4
    assert data["end"] == (len(angles) - 1) / MOTION_RATE


def test_a_gesture_that_the_robot_cannot_perform_is_told_and_left_out(known):
    told: list[str] = []
    documents = gesture_documents(NAMES[:1], known.lexicon) | {"nothing": write_document("gobbledygook")}
    assert list(plan_motions(documents, known, told.append)) == ["doubt_shrug"]
    (why,) = told
    assert why.startswith("nothing is left out, upper22 cannot perform it: ")
    assert "gobbledygook" in why


def test_pairs_differ_by_the_setting_alone(known, documents, motions: dict[str, SampledMotion]):
    (pair,) = plan_pairs(documents, motions, known, "whole_body=0", 1)
    assert (pair.stimulus, pair.condition) == ("doubt_shrug", "whole_body=0")
    assert pair.motions["standard"] is motions["doubt_shrug"]
    changed = plan_gesture(known.lexicon.find("doubt_shrug").form, changed_setup(known, "whole_body=0"))
    assert pair.motions["changed"].angles[80] == pytest.approx(changed.trajectory.at(80 / MOTION_RATE).angles, abs=1e-9)
    assert np.abs(pair.motions["changed"].angles[:80] - pair.motions["standard"].angles[:80]).max() > SEEN


def test_the_profile_of_effort_can_be_taken_away(known, documents, motions: dict[str, SampledMotion]):
    pairs = plan_pairs(documents, motions, known, "effort=0", 3)
    assert {pair.stimulus for pair in pairs} == set(NAMES)
    form, plain = known.lexicon.find("offer").form, changed_setup(known, "effort=0")
    hands = [measure_gesture(form, setup).hand for setup in (plain, known)]
    assert hands[0].flow < 0.15 < 0.3 < hands[1].flow
    assert hands[0].stroke_speed < 0.7 * hands[1].stroke_speed
    assert hands[0].return_speed > 1.5 * hands[1].return_speed


def test_pairs_begin_where_they_are_told(known, documents, motions: dict[str, SampledMotion]):
    pairs = plan_pairs(documents, motions, known, "power=-1", 2, first=5)
    assert [pair.stimulus for pair in pairs] == ["offer", "doubt_shrug"]


def test_what_nobody_would_see_is_no_pair(known, documents, motions: dict[str, SampledMotion]):
    assert plan_pairs(documents, motions, known, "power=0", 2) == []
    assert plan_pairs(documents, motions, known, "repetition=0", 2) == []


def test_texts_have_captions_and_pauses_to_idle_in(known):
    text = (
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><speech id="s" start="0"><text>Good morning!'
        '</text></speech><gesture id="g" lexeme="offer" stroke="9"/></bml>'
    )
    motions = plan_motions({"morning": text}, known)
    assert " ".join(said.text for said in motions["morning"].words) == "Good morning!"
    (pair,) = plan_pairs({"morning": text}, motions, known, "idle=2", 1)
    assert pair.motions["changed"].words == motions["morning"].words


@pytest.mark.parametrize(
    ("condition", "what"),
    [("powerr=0", "no powerr"), ("power=7", "outside"), ("idle=calm", "such as idle=0"), ("variation=3", "to 2")],
)
def test_wrong_settings_are_told(known, condition: str, what: str):
    with pytest.raises(ConfigError, match=what):
        changed_setup(known, condition)


def test_motions_differ_by_a_hinge_or_by_their_end():
    still = SampledMotion(np.zeros((50, 3)))
    assert not still.differs(SampledMotion(np.full((50, 3), 0.9 * SEEN)))
    assert still.differs(SampledMotion(np.full((50, 3), 1.1 * SEEN)))
    assert not still.differs(SampledMotion(np.zeros((55, 3))))
    assert still.differs(SampledMotion(np.zeros((65, 3))))
