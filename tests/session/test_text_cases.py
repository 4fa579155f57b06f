"""Regression tests of texts and documents that were once performed incorrectly."""

import os
from collections.abc import Iterable
from pathlib import Path

import pytest

from kinesic.bml.actions import Gesture, Speech
from kinesic.body.utterance import Script
from kinesic.intent.author import plan_behaviours
from kinesic.planning.plan import Plan
from kinesic.session.documents import read_block, write_text
from kinesic.session.plan import plan_document
from kinesic.session.setup import set_up
from kinesic.speech.espeak_pool import espeak_fault
from tests.speech.heard import heard_consonants

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
CASE_FOLDER = CORPUS_FOLDER.parent / "cases" / "text"
REFUSAL_GESTURES = {"no_low", "no_wag", "refuse_sweep", "refuse_push", "crossed_out", "set_aside"}
JOY_GESTURES = {"joy", "joy_bounce", "joy_cheer", "smile"}
SETUP = set_up()

pytestmark = pytest.mark.skipif(not CASE_FOLDER.is_dir(), reason=f"no cases at {CASE_FOLDER} (KINESIC_CORPUS)")


def read(name: str) -> str:
    return (CASE_FOLDER / name).read_text()


def lexemes(text: str, channels: Iterable[str] = ("gesture", "head", "face")) -> list[str]:
    """Return the lexemes of a text in the order of their strokes."""
    _, selection = plan_behaviours(text, SETUP.lexicon, SETUP.style)
    return [each.lexeme for each in selection.behaviours if each.channel in channels]


def words(text: str) -> list[str]:
    passage, _ = plan_behaviours(text, SETUP.lexicon, SETUP.style)
    return [word.text for word in passage.words]


def planned(name: str) -> Plan:
    return plan_document(CASE_FOLDER / name, SETUP)


def spoken(plan: Plan) -> list[str]:
    return [each.action.script.text for each in plan.timeline.block.behaviours if isinstance(each.action, Speech)]


def test_stage_directions_in_a_text_are_performed_and_not_spoken():
    text = read("05_stage.txt")
    assert words(text) == ["Hi", "there", "That", "is", "funny", "Yes"]
    shown = lexemes(text)
    assert {"greet_wave", "laugh", "NOD"} <= set(shown)
    assert words("He said *no* to me.") == ["He", "said", "no", "to", "me"]


def test_animation_tags_of_a_nao_text_are_performed_and_not_spoken():
    text = read("07_nao.txt")
    assert words(text) == ["Hello", "Nice", "to", "meet", "you"]
    assert "greet_wave" in lexemes(text)


def test_text_in_think_tags_is_not_spoken():
    assert words(read("09_think.txt")) == ["Hello"]


def test_markdown_is_spoken_without_markup_and_with_pauses():
    text = read("10_markdown.txt")
    assert words(text) == ["Plan", "We", "need", "Bread", "a", "knife"]
    assert write_text(text, SETUP).bml.count("<break") >= 3
    assert not {"count_one", "count_two"} & set(lexemes(text))


def test_acronyms_us_and_who_are_not_read_as_pronoun_and_question_word():
    text = read("13_us.txt")
    passage, _ = plan_behaviours(text, SETUP.lexicon, SETUP.style)
    assert passage.kinds == ("statement",)
    assert not {"us", "who"} & set(words(text))
    assert not {"we", "ask_open"} & set(lexemes(text))


def test_negative_idioms_of_agreement_get_a_nod_and_a_shrug_but_no_refusal():
    shown = lexemes(read("15_agree.txt"))
    assert "NOD" in shown
    assert "shrug_small" in shown or "doubt_shrug" in shown
    assert not {*REFUSAL_GESTURES, "SHAKE", "LOWER_BROWS"} & set(shown)


def test_phrase_no_idea_gets_a_shrug_and_no_refusal_gesture():
    assert {"shrug_small", "doubt_shrug"} & set(lexemes(read("17_idea.txt")))
    assert not REFUSAL_GESTURES & set(lexemes(read("17_idea.txt")))


def test_emotion_words_in_questions_wishes_and_homographs_get_no_emotional_gestures():
    text = read("18_feeling.txt")
    assert not {*JOY_GESTURES, "wipe_brow", "relief", "disgust"} & set(lexemes(text))
    assert "kinesic:style" not in write_text(text, SETUP).bml


def test_fml_document_without_bml_yields_gestures_and_facial_expressions():
    block = read_block((CASE_FOLDER / "20_fml_alone.xml").read_bytes(), SETUP)
    assert {"gesture", "faceLexeme"} <= {each.type for each in block.behaviours}


def test_marks_and_phonemes_of_a_recording_skip_its_silence():
    plan = planned("22_recording.bml")
    (utterance,) = plan.utterances.values()
    times = {mark: round(time, 2) for mark, time in utterance.marks.items()}
    assert times == {"w0": 0.3, "w1": 2.8, "w2": 3.1}
    starts = [phoneme.start for phoneme in utterance.phonemes]
    assert not [start for start in starts if 0.9 < start < 2.79]  # the recording is silent there


def test_text_of_an_ssml_document_is_spoken():
    assert spoken(planned("24_speak.xml")) == ["Hello there."]


def test_text_file_in_utf_16_is_decoded():
    assert spoken(planned("26_utf16.txt")) == ["Hello, my friend!"]


def test_json_document_in_a_markdown_code_fence_is_planned():
    plan = planned("27_fence.json")
    assert [each.type for each in plan.timeline.block.behaviours] == ["head"]


def test_robot_without_fingers_uses_the_left_hand_if_the_document_names_it():
    plan = planned("28_left.json")
    assert plan.keyframes.uses["g"] & {"l_hand", "r_hand"} == {"l_hand"}
    assert isinstance(plan.timeline.block.behaviours[0].action, Gesture)


def test_denials_in_successive_turns_get_different_gestures():
    memory, shown = write_text("", SETUP).memory, list[str]()
    for line in read("30_turns.txt").splitlines():
        written = write_text(line, SETUP, memory)
        memory = written.memory
        shown.append(memory.gestures[-1].form)
    assert len(set(shown)) == len(shown) == 4


@pytest.mark.skipif(bool(espeak_fault()), reason=espeak_fault())
@pytest.mark.parametrize(
    ("name", "heard"),
    [
        ("01_dot_caps.txt", "I want it now"),
        ("03_dot_sync.bml", "He is here"),
        ("13_us.txt", "I live in the you ess and work for the double you aitch oh"),
    ],
)
def test_speech_omits_punctuation_names_and_spells_out_acronyms(name: str, heard: str):
    plan = plan_document(CASE_FOLDER / name, SETUP)
    (speech,) = (each.action for each in plan.timeline.block.behaviours if isinstance(each.action, Speech))
    assert heard_consonants(speech.script) == heard_consonants(Script(heard))


@pytest.mark.soak
def test_text_of_2100_words_is_split_into_several_speeches():
    text = "The garden needs water today.\n" * 420
    bml = write_text(text, SETUP).bml
    assert bml.count("<speech ") > 5
    assert bml.count("garden") >= 420
