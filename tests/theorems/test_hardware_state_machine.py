"""What holds for every sequence of events and facts, however mad."""

from dataclasses import fields, replace
from typing import get_args

from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.hardware.supervisor.state_machine import MOVING, Event, Observation, Stage, SupervisorState, step

EVENTS: tuple[Event, ...] = get_args(Event)
ENERGISING = {"arm", "adopt"}
GOING = {"approach", "follow", "fold"}

flags = st.booleans()
facts = st.builds(
    Observation,
    **{field.name: flags for field in fields(Observation) if field.name != "policy"},
    policy=st.sampled_from(["hold", "limp"]),
)
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
            assert after.stage not in MOVING | {Stage.ARM, Stage.HOLD}
            assert not (ENERGISING | GOING) & set(actions)
            if known.policy == "limp":
                assert after.stage in (Stage.RELEASE, Stage.CLOSED)


@given(stories)
@settings(max_examples=60)
def test_nothing_moves_or_is_armed_after_an_emergency_stop(story: list[tuple[Event, Observation]]):
    for before, _, _, after, actions in told(story):
        if before.stopped and after.stopped:
            assert not GOING & set(actions)
            assert "arm" not in actions
            assert after.stage not in MOVING


@given(stories)
@settings(max_examples=60)
def test_torque_comes_only_in_arm_and_goes_only_in_release(story: list[tuple[Event, Observation]]):
    for _, _, _, after, actions in told(story):
        assert ("arm" in actions) == (after.stage is Stage.ARM and bool(actions))
        assert ("release" in actions) == (after.stage is Stage.RELEASE and bool(actions))


def good_end(state: SupervisorState, known: Observation) -> tuple[SupervisorState, int]:
    """Lets everything go well from now on, until nothing changes any more; where that is, and after how many steps."""
    for count in range(30):
        event: Event = "tick"
        if state.stage in (Stage.PROBE, Stage.CONFIGURE, Stage.ARM, Stage.ADOPT, Stage.RELEASE):
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
    known = Observation(energised=True, reached=True, ended=not release, release=release)
    assert good_end(state, known)[0].stage is Stage.CLOSED


@given(stories)
@settings(max_examples=60)
def test_every_state_leads_to_rest_or_release_when_nobody_wants_anything(story: list[tuple[Event, Observation]]):
    state = told(story)[-1][3]
    end, _ = good_end(state, Observation(energised=True, reached=True, idle=True))
    assert end.stage in (Stage.CLOSED, Stage.LIMP, Stage.STOPPED) or (end.stage is Stage.HOLD and end.folded)


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
