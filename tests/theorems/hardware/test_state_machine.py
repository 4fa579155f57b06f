"""What holds for every sequence of events and facts, however mad."""

from dataclasses import fields, replace
from typing import get_args

from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.state_machine import MOVING, POWERED, Event, Stage, SupervisorState, step
from kinesic.hardware.supervisor.status import awaited

EVENTS: tuple[Event, ...] = get_args(Event)
ENERGISING = {"arm", "adopt"}
GOING = {"approach", "follow", "fold"}

flags = st.booleans()
facts = st.builds(
    Observation,
    **{field.name: flags for field in fields(Observation) if field.name != "policy"},
    policy=st.sampled_from(["hold", "limp"]),
).filter(lambda known: known.energised or not known.raised)
stories = st.lists(st.tuples(st.sampled_from(EVENTS), facts), max_size=25)


def told(
    story: list[tuple[Event, Observation]],
) -> list[tuple[SupervisorState, Event, Observation, SupervisorState, tuple[str, ...]]]:
    """Every step of a story that begins at the beginning."""
    state, steps = SupervisorState(), []
    for event, known in [("open", Observation()), *story]:
        after, actions = step(state, event, known)
        steps.append((state, event, known, after, actions))
        state = after
    return steps


@given(stories)
@settings(max_examples=60)
def test_nothing_is_energised_before_the_manifest_is_right(story: list[tuple[Event, Observation]]):
    for before, _, _, after, actions in told(story):
        if ENERGISING & set(actions):
            assert before.checked
            assert after.powered
        if not after.checked:
            assert after.stage in (Stage.CLOSED, Stage.PROBE)


@given(stories)
@settings(max_examples=60)
def test_an_emergency_stop_wins(story: list[tuple[Event, Observation]]):
    for _, event, known, after, actions in told(story):
        if event == "estop":
            assert after.stopped
            assert after.stage not in MOVING | {Stage.HOLD}
            assert after.stage is not Stage.ARM or known.raised
            assert not (ENERGISING | GOING) & set(actions)
            if known.policy == "limp":
                assert after.stage in (Stage.RELEASE, Stage.CLOSED)


@given(stories)
@settings(max_examples=60)
def test_nothing_moves_or_is_armed_after_an_emergency_stop(story: list[tuple[Event, Observation]]):
    """Until somebody wants the end, or nobody is there who could."""
    for before, _, known, after, actions in told(story):
        if before.stopped and after.stopped and not known.dismissed:
            assert not GOING & set(actions)
            assert "arm" not in actions
            assert after.stage not in MOVING or before.stage in MOVING


@given(stories)
@settings(max_examples=60)
def test_torque_comes_only_in_arm_and_goes_only_in_release(story: list[tuple[Event, Observation]]):
    for _, _, _, after, actions in told(story):
        assert ("arm" in actions) == (after.stage is Stage.ARM and bool(actions))
        assert ("release" in actions) == (after.stage is Stage.RELEASE and bool(actions))


@given(stories)
@settings(max_examples=200)
def test_no_torque_is_taken_from_a_raised_limb_unless_a_person_wants_it(story: list[tuple[Event, Observation]]):
    for _, event, known, _, actions in told(story):
        if "release" in actions and known.raised:
            assert known.confirmed or (event == "estop" and known.policy == "limp")


@given(stories)
@settings(max_examples=200)
def test_after_a_long_interruption_nothing_is_performed_without_consent(story: list[tuple[Event, Observation]]):
    owed = False
    for before, event, known, after, actions in told(story):
        if event == "open":
            owed = False
        if event == "resumed":
            owed = False
        if known.interrupted and before.armed and before.stage in POWERED:
            owed = True
        if owed and event != "open":
            assert not {"approach", "follow"} & set(actions)
            assert after.stage not in (Stage.APPROACH, Stage.ACTIVE) or after.stage is before.stage
            assert "arm" not in actions or known.raised


@given(stories)
@settings(max_examples=100)
def test_where_a_long_interruption_strikes_a_performance_it_comes_to_a_stop(story: list[tuple[Event, Observation]]):
    for before, event, known, after, _ in told(story):
        if known.interrupted and before.armed and before.stage in POWERED and event not in ("open", "resumed"):
            assert after.stage not in (Stage.APPROACH, Stage.ACTIVE)


def good_end(state: SupervisorState, known: Observation) -> tuple[SupervisorState, int]:
    """Lets everything go well from now on, until nothing changes any more; where that is, and after how many steps."""
    for count in range(30):
        event: Event = "tick"
        if state.stage in (Stage.PROBE, Stage.CONFIGURE, Stage.ARM, Stage.IDENTIFY, Stage.ADOPT, Stage.RELEASE):
            event = "done"
        if state.stage is Stage.LOST:
            event = "back"
        after, actions = step(state, event, known)
        if after == state and not actions:
            return state, count
        state = after
    raise AssertionError(f"{state} changes for ever")


@given(stories, flags)
@settings(max_examples=60)
def test_every_state_leads_to_release_once_the_planner_has_ended(story: list[tuple[Event, Observation]], release: bool):
    state = told(story)[-1][3]
    known = Observation(energised=True, reached=True, idle=True, ended=True, alone=not release, release=release)
    assert good_end(state, known)[0].stage is Stage.CLOSED


@given(stories, flags)
@settings(max_examples=60)
def test_who_cannot_come_to_rest_is_held_until_a_person_confirms(story: list[tuple[Event, Observation]], alone: bool):
    state = told(story)[-1][3]
    known = Observation(energised=True, reached=True, idle=True, ended=True, alone=alone, release=True, raised=True)
    end, _ = good_end(state, known)
    assert end.stage in (Stage.WAITING, Stage.CLOSED)
    if end.stage is Stage.WAITING:
        assert awaited(end, well=True) == "confirmation"
        assert good_end(end, replace(known, confirmed=True))[0].stage is Stage.CLOSED


@given(stories)
@settings(max_examples=60)
def test_after_an_emergency_stop_a_dead_planner_means_hold_then_fold(story: list[tuple[Event, Observation]]):
    state, known = told(story)[-1][3], Observation(energised=True, raised=True, ended=True, alone=True)
    state, _ = step(state, "estop", known)
    if state.stage is not Stage.STOPPED or state.faulty or state.careful:
        return
    for _ in range(3):
        state, actions = step(state, "tick", known)
        assert set(actions) <= {"hold"}
    state, actions = step(state, "tick", replace(known, idle=True))
    assert actions == ("fold",)


@given(stories)
@settings(max_examples=60)
def test_every_state_leads_to_rest_or_to_a_hold_that_says_what_it_waits_for(story: list[tuple[Event, Observation]]):
    state = told(story)[-1][3]
    end, _ = good_end(state, Observation(energised=True, reached=True, idle=True))
    assert end.stage in (Stage.CLOSED, Stage.LIMP, Stage.STOPPED) or (end.stage is Stage.HOLD and end.folded)
    assert (awaited(end, well=True) == "nothing") == (end.stage is Stage.CLOSED)


@given(stories)
@settings(max_examples=60)
def test_a_lost_port_is_no_dead_end(story: list[tuple[Event, Observation]]):
    state = told(story)[-1][3]
    if state.stage is Stage.LOST:
        assert step(state, "tick", Observation(hopeless=True))[0].stage is Stage.CLOSED


@given(st.sampled_from(Stage), flags, flags, st.sampled_from(EVENTS), facts)
def test_the_machine_is_a_function(stage: Stage, stopped: bool, faulty: bool, event: Event, known: Observation):
    state = replace(SupervisorState(stage), stopped=stopped, faulty=faulty)
    assert step(state, event, known) == step(state, event, known)
