"""Rules of the state machine, stage by stage."""

from dataclasses import replace

import pytest

from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.state_machine import Stage, SupervisorState
from kinesic.hardware.supervisor.transitions import step

HEALTHY_OBSERVATION = Observation(energised=True)  # all servos have torque and no fault


def at(stage: Stage, **changes: object) -> SupervisorState:
    return replace(SupervisorState(stage, checked=True, powered=True), **changes)


COMMANDS_DUE = {"due": True}  # observation in which commands wait to be performed
FOLDED, FAULTY, PAUSED = {"folded": True}, {"faulty": True}, {"paused": True}
RULES = [  # stage, flags, event, observation; then next stage, actions, next flags
    (Stage.CLOSED, {}, "tick", {}, Stage.CLOSED, (), {}),
    (Stage.PROBE, {}, "tick", {}, Stage.PROBE, (), {}),
    (Stage.CONFIGURE, {}, "tick", {}, Stage.CONFIGURE, (), {}),
    (Stage.CONFIGURE, {"powered": False}, "done", {}, Stage.ADOPT, ("adopt",), {"powered": True}),
    (Stage.CONFIGURE, {}, "done", {"energised": False}, Stage.LIMP, (), {}),
    (Stage.LIMP, {}, "tick", {"begun": True, "ended": True}, Stage.CLOSED, ("close",), {}),
    (Stage.LIMP, FAULTY, "tick", {"begun": True}, Stage.CLOSED, ("close",), {}),
    (Stage.LIMP, {}, "tick", {"begun": True, "answering": False}, Stage.LIMP, (), {}),
    (Stage.LIMP, {"powered": False}, "tick", {"begun": True}, Stage.ARM, ("arm",), {"powered": True}),
    (Stage.ARM, {}, "tick", {}, Stage.ARM, (), {"armed": False}),
    (Stage.ARM, {}, "done", {}, Stage.HOLD, ("hold",), {"armed": True, "faulty": False, "refused": False}),
    (Stage.ARM, {}, "refused", {}, Stage.HOLD, ("hold",), {"armed": True, "faulty": True, "refused": True}),
    # holding: torque that is gone, or has to come
    (Stage.HOLD, {}, "tick", {"energised": False}, Stage.RELEASE, ("release",), {}),
    (Stage.HOLD, {}, "tick", {"energised": False, "limp": True}, Stage.ARM, ("arm",), {}),
    (Stage.HOLD, FAULTY, "tick", {"energised": False, "limp": True}, Stage.RELEASE, ("release",), {}),
    (Stage.HOLD, {}, "tick", {"limp": True, "answering": False}, Stage.HOLD, (), {}),
    (Stage.HOLD, FOLDED, "tick", {"limp": True}, Stage.ARM, ("arm",), {"folded": False}),
    (Stage.HOLD, {"refused": True}, "tick", {"limp": True}, Stage.HOLD, (), {}),
    (Stage.HOLD, {}, "tick", {"limp": True, "confirmed": True, "raised": True}, Stage.FOLD, ("fold",), {}),
    (Stage.HOLD, {}, "tick", {"limp": True, "ended": True}, Stage.FOLD, ("fold",), {}),
    (Stage.HOLD, FAULTY, "tick", {"limp": True}, Stage.FOLD, ("fold",), {}),
    (Stage.HOLD, PAUSED, "tick", {"limp": True}, Stage.HOLD, (), {}),
    (Stage.HOLD, PAUSED, "tick", {"limp": True, "raised": True}, Stage.ARM, ("arm",), {}),
    # holding: after an emergency stop
    (Stage.HOLD, {"stopped": True}, "tick", COMMANDS_DUE, Stage.STOPPED, ("hold",), {}),
    (Stage.HOLD, {"stopped": True}, "tick", {"alone": True, "ended": True}, Stage.FOLD, ("fold",), {}),
    # holding: the end
    (Stage.HOLD, {}, "tick", {"ended": True}, Stage.FOLD, ("fold",), {}),
    (Stage.HOLD, PAUSED, "tick", {"ended": True}, Stage.HOLD, (), {}),
    (Stage.HOLD, PAUSED, "tick", {"ended": True, "idle": True}, Stage.FOLD, ("fold",), {}),
    (Stage.HOLD, PAUSED, "tick", {"release": True}, Stage.FOLD, ("fold",), {}),
    (Stage.HOLD, PAUSED, "tick", {"confirmed": True}, Stage.FOLD, ("fold",), {}),
    (Stage.HOLD, {"careful": True}, "tick", {"release": True}, Stage.HOLD, (), {}),
    (Stage.HOLD, {"careful": True}, "tick", {"release": True, "idle": True}, Stage.FOLD, ("fold",), {}),
    (Stage.HOLD, FOLDED, "tick", {"ended": True}, Stage.RELEASE, ("release",), {}),
    (Stage.HOLD, FOLDED, "tick", {"ended": True, "raised": True}, Stage.HOLD, (), {}),
    (Stage.HOLD, FOLDED, "tick", {"ended": True, "raised": True, "confirmed": True}, Stage.RELEASE, ("release",), {}),
    (Stage.HOLD, FOLDED, "tick", {"ended": True, "raised": True, "idle": True}, Stage.WAITING, (), {}),
    # holding: what goes on
    (Stage.HOLD, FOLDED, "tick", COMMANDS_DUE, Stage.APPROACH, ("approach",), {"folded": False}),
    (Stage.HOLD, {}, "tick", {"due": True, "well": False}, Stage.HOLD, (), {}),
    (Stage.HOLD, {}, "tick", {"due": False}, Stage.HOLD, (), {}),
    (Stage.HOLD, PAUSED, "tick", COMMANDS_DUE, Stage.HOLD, (), {}),
    (Stage.HOLD, FOLDED, "tick", {"idle": True}, Stage.HOLD, (), {}),
    (Stage.WAITING, FOLDED, "tick", {"raised": True}, Stage.WAITING, (), {}),
    (Stage.WAITING, FOLDED, "tick", {}, Stage.RELEASE, ("release",), {}),
    (Stage.WAITING, FOLDED, "resumed", {"raised": True}, Stage.HOLD, ("hold",), {"folded": False, "careful": False}),
    (Stage.WAITING, FOLDED, "mended", {"raised": True}, Stage.HOLD, ("hold",), {"folded": False, "careful": True}),
    (Stage.WAITING, FOLDED, "tick", {"raised": True, "limp": True}, Stage.HOLD, ("hold",), {"careful": True}),
    # performing
    (Stage.APPROACH, {}, "tick", COMMANDS_DUE, Stage.APPROACH, (), {}),
    (Stage.ACTIVE, {}, "tick", {"due": True, "reached": True}, Stage.ACTIVE, (), {}),
    (Stage.DEGRADED, {}, "tick", {"due": True, "still": True}, Stage.HOLD, ("hold",), {}),
    (Stage.DEGRADED, {}, "tick", {"due": True, "still": False}, Stage.ACTIVE, (), {}),
    (Stage.DEGRADED, {"approaching": True}, "tick", {"due": True, "still": False}, Stage.APPROACH, (), {}),
    (Stage.DEGRADED, {}, "tick", {"due": True, "well": False, "still": False}, Stage.DEGRADED, (), {}),
    (Stage.FOLD, {}, "tick", {}, Stage.FOLD, (), {"folded": False}),
    (
        Stage.FOLD,
        {"careful": True},
        "tick",
        {"reached": True},
        Stage.HOLD,
        ("hold",),
        {"folded": True, "careful": False},
    ),
    (Stage.FOLD, {}, "failed", {"reached": True}, Stage.FOLD, ("fold",), {"faulty": True, "folded": False}),
    # letting go
    (Stage.RELEASE, {}, "tick", {}, Stage.RELEASE, (), {"powered": True}),
    (Stage.RELEASE, {}, "done", {}, Stage.CLOSED, ("close",), {"powered": False}),
    (Stage.RELEASE, {}, "refused", {}, Stage.CLOSED, ("close",), {"powered": True}),
    (Stage.STOPPED, {"stopped": True}, "tick", COMMANDS_DUE, Stage.STOPPED, (), {}),
    (Stage.STOPPED, {"stopped": True, "folded": True}, "resumed", {}, Stage.HOLD, ("hold",), {"folded": False}),
    (Stage.STOPPED, {"stopped": True}, "tick", {"alone": True}, Stage.HOLD, ("hold",), {"stopped": True}),
    # ports and watchdogs
    (Stage.LOST, {}, "tick", {}, Stage.LOST, (), {}),
    (Stage.LOST, {}, "tick", {"hopeless": True}, Stage.CLOSED, ("close",), {}),
    (Stage.IDENTIFY, {}, "tick", {}, Stage.IDENTIFY, (), {}),
    (Stage.IDENTIFY, {}, "refused", {}, Stage.LOST, ("slow",), {}),
    (Stage.ADOPT, FOLDED, "tick", {}, Stage.ADOPT, (), {"armed": False}),
    (Stage.ADOPT, FOLDED, "done", {}, Stage.HOLD, ("hold",), {"armed": True, "folded": False, "faulty": False}),
    (Stage.ADOPT, FOLDED, "refused", {}, Stage.HOLD, ("hold",), {"armed": True, "folded": False, "faulty": True}),
    (Stage.ADOPT, FAULTY, "done", {}, Stage.HOLD, ("hold",), {"faulty": True}),
    (Stage.HOLD, {}, "tripped", {}, Stage.ADOPT, ("adopt",), {}),
    (Stage.ARM, {}, "tripped", {}, Stage.ARM, (), {}),
    (Stage.ADOPT, {}, "tripped", {}, Stage.ADOPT, (), {}),
    (Stage.LIMP, {}, "lost", {}, Stage.LIMP, (), {}),
    (Stage.ARM, {}, "lost", {}, Stage.LOST, ("slow",), {}),
    # what is remembered, whatever the stage
    (Stage.LOST, {"armed": True}, "tick", {"interrupted": True}, Stage.LOST, (), {"paused": True}),
    (Stage.LOST, {}, "tick", {"interrupted": True}, Stage.LOST, (), {"paused": False}),
    (Stage.LIMP, {"armed": True}, "tick", {"interrupted": True}, Stage.LIMP, (), {"paused": False}),
    (Stage.LOST, {"refused": True, "stopped": True}, "mended", {}, Stage.LOST, (), {"refused": False, "stopped": True}),
    (Stage.LOST, {"refused": True, **PAUSED}, "resumed", {}, Stage.LOST, (), {"refused": False, "paused": False}),
    (Stage.LOST, {"stopped": True}, "resumed", {}, Stage.LOST, (), {"stopped": False}),
]


@pytest.mark.parametrize(("stage", "before", "event", "facts", "after", "actions", "remembered"), RULES)
def test_each_supervisor_event_leads_to_the_stage_actions_and_flags_of_the_rule_table(
    stage, before, event, facts, after, actions, remembered
):
    state, begun = step(at(stage, **before), event, replace(HEALTHY_OBSERVATION, **facts))
    assert (state.stage, begun) == (after, actions)
    assert {name: getattr(state, name) for name in remembered} == remembered


@pytest.mark.parametrize("stage", [Stage.APPROACH, Stage.ACTIVE])
@pytest.mark.parametrize(
    ("before", "facts"),
    [
        (FAULTY, COMMANDS_DUE),
        (PAUSED, COMMANDS_DUE),
        ({}, {"due": True, "ended": True}),
        ({}, {"due": True, "well": False}),
        ({}, {"due": False}),
    ],
)
def test_servo_faults_pauses_and_missing_commands_slow_the_performance_to_a_stop(
    stage: Stage, before: dict, facts: dict
):
    approaching = stage is Stage.APPROACH
    known = replace(HEALTHY_OBSERVATION, **facts, reached=True)
    state, begun = step(at(stage, **before, approaching=not approaching), "tick", known)
    assert (state.stage, begun, state.approaching) == (Stage.DEGRADED, ("slow",), approaching)
    assert step(state, "tick", replace(known, still=False)) == (state, ())  # and does not go on by itself


@pytest.mark.parametrize("policy", ["hold", "limp"])
@pytest.mark.parametrize("raised", [False, True])
@pytest.mark.parametrize("stage", Stage)
def test_emergency_stop_holds_releases_or_waits_depending_on_stage_and_policy(stage: Stage, policy: str, raised: bool):
    state, begun = step(at(stage), "estop", replace(HEALTHY_OBSERVATION, policy=policy, raised=raised))
    ended = {Stage.CLOSED, Stage.RELEASE}
    waiting = {Stage.LOST, Stage.IDENTIFY, Stage.ADOPT} | ({Stage.ARM} if raised else set())
    if stage in ended or (policy == "hold" and stage in waiting):
        expected = (stage, ())
    elif policy == "limp" or stage is Stage.ARM:
        expected = (Stage.RELEASE, ("release",))
    elif stage in (Stage.PROBE, Stage.CONFIGURE, Stage.LIMP):
        expected = (Stage.CLOSED, ("close",))
    else:
        expected = (Stage.STOPPED, ("slow",))
    assert (state.stage, begun) == expected
    assert state.stopped
    assert state.paused


def test_emergency_stop_before_the_servo_check_closes_the_ports():
    for policy in ("hold", "limp"):
        state, begun = step(SupervisorState(Stage.PROBE), "estop", replace(HEALTHY_OBSERVATION, policy=policy))
        assert (state.stage, begun) == (Stage.CLOSED, ("close",))


def test_performance_time_advances_only_in_the_active_and_degraded_stages():
    assert {stage for stage in Stage if stage.runs} == {Stage.ACTIVE, Stage.DEGRADED}


def test_opening_the_ports_resets_the_supervisor_state():
    after = SupervisorState(Stage.CLOSED, checked=True, armed=True, stopped=True, paused=True, faulty=True, folded=True)
    assert step(after, "open", Observation()) == (SupervisorState(Stage.PROBE), ("check",))
