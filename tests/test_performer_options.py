"""Options and document sources of a performer."""

import subprocess
import sys
from pathlib import Path

import pytest

import kinesic
from kinesic.body.config import CONFIGS
from kinesic.expressivity.idle import Idling
from kinesic.expressivity.variation import Variation
from kinesic.session.options import INTERACTIVE_DEFAULTS, PlanningOptions

NOD = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<head id="nod" lexeme="NOD" stroke="0.8"/><gesture id="odd" lexeme="xyzzy" stroke="1"/></bml>'
)


@pytest.fixture(scope="module")
def performer() -> kinesic.Performer:
    return kinesic.Performer("upper22", style="joyful")


@pytest.fixture(scope="module")
def plan(performer) -> kinesic.Plan:
    return performer.plan(NOD)


def test_performer_has_the_defaults_of_the_command_line():
    options = PlanningOptions.__annotations__
    assert {name: options[name].__metadata__[0].default for name in INTERACTIVE_DEFAULTS} == INTERACTIVE_DEFAULTS
    assert INTERACTIVE_DEFAULTS["voice"] == "auto"


def test_public_names_of_the_package_exist_and_are_listed_by_dir():
    assert all(getattr(kinesic, name) is not None for name in kinesic.__all__)
    assert {"Performer", "Plan", "Performance", "Robot", "Style", "Client", "solve_ik", "track_ik"} <= {*dir(kinesic)}
    assert kinesic.solve_ik is kinesic.ik.solve
    with pytest.raises(AttributeError, match="no attribute performe"):
        kinesic.performe  # noqa: B018 - asking for it is what is tested


def test_importing_kinesic_does_not_import_numpy_mujoco_or_msgspec():
    code = "import sys, kinesic; print([name for name in ('numpy', 'mujoco', 'msgspec') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_performer_options_set_style_targets_idle_motion_and_variation(tmp_path: Path):
    performer = kinesic.Performer(
        style="calm",
        settings={"power": 0.5, "head.spatial": -0.5},
        targets={"screen": [1.0, 0.2, 0.4]},
        gather="complex",
        idle=0.5,
        variation=2,
        seed=7,
        pause=0.5,
    )
    assert repr(performer) == "Performer('upper22', style='calm')"
    assert (performer.style.gesture.power, performer.style.head.spatial) == (0.5, -0.5)
    assert performer.setup.targets["screen"].tolist() == [1.0, 0.2, 0.4]
    assert performer.setup.idling == Idling(0.5, 7)
    assert performer.setup.variation == Variation(2, 7)
    file = tmp_path / "targets.toml"
    file.write_text("door = [2.0, -1.0, 0.5]", encoding="utf-8")
    assert kinesic.Performer(targets=file).setup.targets["door"].tolist() == [2.0, -1.0, 0.5]


@pytest.mark.parametrize(
    ("wrong", "error", "said"),
    [
        ({"robot": "uper22"}, kinesic.ConfigError, "did you mean upper22"),
        ({"style": "joyfull"}, kinesic.ConfigError, "did you mean joyful"),
        ({"gathr": "lazy"}, TypeError, "no option gathr; did you mean gather"),
        ({"xyz": 1}, TypeError, "no option xyz; known: settings, lexicon"),
        ({"gather": "complx"}, kinesic.ConfigError, "gather is 'complx'; did you mean complex"),
        ({"idle": "calm"}, kinesic.ConfigError, "idle is 'calm'; use 0 to 2"),
        ({"variation": 2.1}, kinesic.ConfigError, r"variation is 2\.1; use 0 to 2"),
        ({"seed": -1}, kinesic.ConfigError, "seed is -1; use a whole number, 0 or more"),
        ({"pause": -1.0}, kinesic.ConfigError, "pause is -1.0; use 0 to 60 seconds"),
        ({"settings": {"pwer": 1.0}}, kinesic.ConfigError, "no pwer; did you mean power"),
        ({"targets": {"door": [1.0]}}, kinesic.ConfigError, "target door is .* three finite numbers"),
    ],
)
def test_error_for_invalid_performer_options_names_valid_ones(wrong, error, said):
    with pytest.raises(error, match=said):
        kinesic.Performer(**wrong)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"on": "servo"}, "did you mean servos"),
        ({"twin": "nominl"}, "did you mean nominal"),
        ({"on": "servos", "feedforward": "none"}, "servos accept only 'full'"),
    ],
)
def test_error_for_invalid_perform_arguments_names_valid_ones(performer, plan, wrong, said):
    with pytest.raises(kinesic.ConfigError, match=said):
        performer.perform(plan, **wrong)


def test_performer_accepts_a_document_as_path_or_as_text(performer):
    path = CONFIGS / "bml" / "welcome.bml"
    assert str(performer.plan(str(path))).startswith(f"plan of {path} on upper22")
    with pytest.raises(kinesic.BmlError, match=r"nowhere.bml: No such file or directory; give a path, or BML text"):
        performer.plan("nowhere.bml")
    with pytest.raises(kinesic.BmlError, match=r"nowhere.*null byte; give a path"):
        performer.plan("nowhere\0.bml")
    with pytest.raises(kinesic.BmlError, match=r"^greeting:1"):
        performer.plan("<bml", source="greeting")


def test_module_functions_perform_and_plan_accept_a_document():
    run = kinesic.perform(NOD)
    assert isinstance(run, kinesic.Performance)
    assert str(kinesic.plan(NOD)).startswith("plan of block b on upper22 (neutral)")


def test_performer_can_play_one_of_several_characters_of_a_document():
    text = (
        '<bml id="b" agent="Anna"><head id="h" lexeme="NOD"/><head id="i" lexeme="NOD" agent="Bert" start="1"/></bml>'
    )
    plans = {name: kinesic.Performer(character=name).plan(text) for name in (None, "Anna", "bert", "Cleo")}
    performed = {
        name: [id for id, outcome in plan.keyframes.outcomes.items() if outcome.kind == "realised"]
        for name, plan in plans.items()
    }
    assert performed == {None: ["h"], "Anna": ["h"], "bert": ["i"], "Cleo": []}


def test_speech_of_other_characters_is_skipped_without_sound_but_with_a_duration():
    text = '<bml agent="Anna"><speech id="s">one</speech><speech id="t" agent="Bert">two \u79c1</speech></bml>'
    plan = kinesic.Performer(voice="auto").plan(text)
    assert [timed.behaviour.id for timed in plan.timeline.timed] == ["s"]
    assert (plan.utterances["t"].sound, plan.utterances["t"].phonemes) == (None, ())
    assert plan.utterances["t"].duration > 0.0
    assert [notice.text for notice in plan.notices if notice.id.endswith(":t")] == [
        "speech 't' is skipped: Bert performs it"
    ]


def test_performer_takes_a_string_as_a_path_unless_it_begins_like_a_document(performer):
    for text in (NOD, "\ufeff \n" + NOD, NOD.encode()):
        assert performer.plan(text).timeline.block.source == "<text>"
    with pytest.raises(kinesic.BmlError, match="give a path"):
        performer.plan("nod.bml")
    with pytest.raises(kinesic.BmlError, match="the document is empty"):
        performer.plan("")
