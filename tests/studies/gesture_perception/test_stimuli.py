"""Motions of stimuli and pairs."""

import base64

import numpy as np
import pytest

from kinesic.bench.naturalness.lexicon import measure_gesture
from kinesic.body.config import ConfigError
from kinesic.studies.gesture_perception.stimuli import (
    MIN_VISIBLE_DIFFERENCE,
    MOTION_RATE,
    SampledMotion,
    changed_setup,
    gesture_documents,
    motion_data,
    plan_motions,
    plan_pairs,
)
from kinesic.studies.gestures.isolated import plan_gesture, write_isolated_gesture

NAMES = ("doubt_shrug", "stop", "offer")


@pytest.fixture(scope="module")
def motions(known) -> dict[str, SampledMotion]:
    return plan_motions(gesture_documents(NAMES, known.lexicon), known)


@pytest.fixture(scope="module")
def documents(known) -> dict[str, str]:
    return gesture_documents(NAMES, known.lexicon)


def test_stimulus_motion_equals_the_planned_trajectory(known, motions: dict[str, SampledMotion]):
    assert tuple(motions) == NAMES
    plan = plan_gesture(known.lexicon.find("stop").form, known)
    angles = motions["stop"].angles
    assert len(angles) - 2 < plan.duration * MOTION_RATE <= len(angles) - 1
    assert angles[60] == pytest.approx(plan.trajectory.at(60 / MOTION_RATE).angles, abs=1e-9)


def test_motions_in_page_data_have_small_quantization_error(motions: dict[str, SampledMotion]):
    (data,) = motion_data([motions["offer"]])
    angles = motions["offer"].angles
    rows = data["step"] * np.frombuffer(base64.b64decode(data["angles"]), "<i2").reshape(data["frames"], -1)
    assert rows == pytest.approx(angles, abs=data["step"])
    assert data["step"] < 2e-4
    assert data["end"] == (len(angles) - 1) / MOTION_RATE


def test_impossible_gesture_is_reported_and_skipped(known):
    results: list[str] = []
    documents = gesture_documents(NAMES[:1], known.lexicon) | {"nothing": write_isolated_gesture("gobbledygook")}
    assert list(plan_motions(documents, known, results.append)) == ["doubt_shrug"]
    (why,) = results
    assert why.startswith("nothing is left out, upper22 cannot perform it: ")
    assert "gobbledygook" in why


def test_motion_pairs_differ_only_by_the_changed_setting(known, documents, motions: dict[str, SampledMotion]):
    (pair,) = plan_pairs(documents, motions, known, "whole_body=0", 1)
    assert (pair.stimulus, pair.condition) == ("doubt_shrug", "whole_body=0")
    assert pair.motions["standard"] is motions["doubt_shrug"]
    changed = plan_gesture(known.lexicon.find("doubt_shrug").form, changed_setup(known, "whole_body=0"))
    assert pair.motions["changed"].angles[80] == pytest.approx(changed.trajectory.at(80 / MOTION_RATE).angles, abs=1e-9)
    assert (
        np.abs(pair.motions["changed"].angles[:80] - pair.motions["standard"].angles[:80]).max()
        > MIN_VISIBLE_DIFFERENCE
    )


def test_effort_profile_of_stimuli_can_be_disabled(known, documents, motions: dict[str, SampledMotion]):
    pairs = plan_pairs(documents, motions, known, "effort=0", 3)
    assert {pair.stimulus for pair in pairs} == set(NAMES)
    form, plain = known.lexicon.find("offer").form, changed_setup(known, "effort=0")
    hands = [measure_gesture(form, setup).hand for setup in (plain, known)]
    assert hands[0].flow < 0.15 < 0.3 < hands[1].flow
    assert hands[0].stroke_speed < 0.7 * hands[1].stroke_speed
    assert hands[0].return_speed > 1.5 * hands[1].return_speed


def test_motion_pair_planning_starts_at_the_given_document_index(known, documents, motions: dict[str, SampledMotion]):
    pairs = plan_pairs(documents, motions, known, "power=-1", 2, first=5)
    assert [pair.stimulus for pair in pairs] == ["offer", "doubt_shrug"]


def test_two_visually_equal_motions_give_no_stimulus_pair(known, documents, motions: dict[str, SampledMotion]):
    assert plan_pairs(documents, motions, known, "power=0", 2) == []
    assert plan_pairs(documents, motions, known, "repetition=0", 2) == []


def test_study_motion_with_speech_has_the_same_captions_with_more_idle_motion(known):
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
def test_invalid_study_settings_are_refused(known, condition: str, what: str):
    with pytest.raises(ConfigError, match=what):
        changed_setup(known, condition)


def test_motions_of_a_stimulus_pair_differ_visibly_by_joint_angles_or_duration():
    still = SampledMotion(np.zeros((50, 3)))
    assert not still.differs(SampledMotion(np.full((50, 3), 0.9 * MIN_VISIBLE_DIFFERENCE)))
    assert still.differs(SampledMotion(np.full((50, 3), 1.1 * MIN_VISIBLE_DIFFERENCE)))
    assert not still.differs(SampledMotion(np.zeros((55, 3))))
    assert still.differs(SampledMotion(np.zeros((65, 3))))
