"""Requests to the planner: styles, stops, order of handling, and its end."""

import json
from types import SimpleNamespace

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.style.style import style_preset
from kinesic.serve import planner as module
from kinesic.serve.messages import (
    Halted,
    PlannerReady,
    RequestDone,
    Restyling,
)
from kinesic.serve.planner import PlannerState, run_planner

from .played_planner import played_planner


@pytest.fixture
def state(known, monkeypatch) -> PlannerState:
    return played_planner(known, monkeypatch)


@pytest.fixture
def restyled(state, monkeypatch):
    """Apply a change of style, and return its arguments."""

    def apply(*given):
        found = []
        monkeypatch.setattr(module, "change_style", lambda scene, now, **options: found.append(options) or scene)
        state.execute(Restyling(*given))
        return found

    return apply


def test_style_request_without_a_block_applies_style_and_parameter_changes_to_all_blocks(state, restyled):
    ((options),) = restyled("calm", ("power=-0.5",), 0.5, None, 3)
    assert options["style"] == style_preset("calm").changed(("power=-0.5",))
    assert (options["amount"], options["block"]) == (0.5, None)
    ((options),) = restyled(None, ("power=-0.5",), None, None, 3)
    assert options["style"] == state._shared.scene.setup.style.changed(("power=-0.5",))
    assert restyled("calm", (), None, None, 3)[0]["style"] == style_preset("calm")
    assert restyled(None, (), 0.5, None, 3)[0]["style"] is None


def test_style_change_of_one_block_passes_on_the_block_id(state, restyled):
    ((options),) = restyled("calm", (), None, "b", 3)
    assert (options["style"], options["block"], options["amount"]) == ("calm", "b", None)


def test_refusal_of_a_style_is_sent_to_the_client_that_requested_the_style(state, restyled, monkeypatch):
    assert restyled("gloomy", (), None, None, 3) == []
    ((message, sender),) = state._shared.told
    assert sender == 3
    assert (json.loads(message)["told"], json.loads(message)["do"]) == ("refused", "style")


def test_planner_passes_an_emergency_stop_to_the_scene(state):
    halted = Halted(3, 1.0, None)
    state.handle_stop(halted)
    assert state._shared.halts == [halted]


class PlayedEnd:
    """End of a pipe with prepared messages."""

    def __init__(self, name, *messages) -> None:
        self.name, self.messages, self.sent = name, list(messages), []

    def recv(self):
        return self.messages.pop(0)

    recv_bytes = recv

    def send(self, message) -> None:
        self.sent.append(message)


def test_planner_handles_stops_before_requests_and_requests_before_refined_plans(monkeypatch):
    calls = []

    class PlayedState:
        pause = 0.5

        def __init__(self, setup, renewed, loop, refiner, properties, *, beginning, rules) -> None:
            calls.append(("state", setup, renewed("old"), beginning, rules))

        def __getattr__(self, name):
            return lambda *given: calls.append((name, *given))

    requests, loop, refiner = (
        PlayedEnd("requests", "start", "request"),
        PlayedEnd("loop", "stop"),
        PlayedEnd("r", "plan"),
    )
    ready = [[requests, loop, refiner], [refiner, requests], [refiner], []]

    def wait(ends, pause):
        assert ends == [requests, loop, refiner]
        assert pause == 0.5
        if not ready:
            raise EOFError
        return ready.pop(0)

    monkeypatch.setattr(module, "PlannerState", PlayedState)
    monkeypatch.setattr(module, "wait", wait)
    monkeypatch.setattr(module, "warm_up", lambda setup, accompaniment: calls.append(("warm_up", setup, accompaniment)))
    monkeypatch.setattr(module, "freeze_heap", lambda: calls.append(("freeze_heap",)))
    monkeypatch.setattr(module, "renew_setup", lambda make, setup: (make(), setup))
    run_planner(lambda: "setup", requests, loop, refiner, SimpleNamespace(accompaniment="face"), "rules")
    each = [("plan_phrases",), ("request_refinement",)]
    assert calls == [
        ("warm_up", "setup", "face"),
        ("freeze_heap",),
        ("state", "setup", ("setup", "old"), "start", "rules"),
        ("handle_stop", "stop"),
        *each,
        ("execute", "request"),
        ("plan_phrases",),
        *each,
        ("apply_refinement", "plan"),
        *each,
        ("advance_scene",),
        *each,
    ]
    assert [type(message) for message in loop.sent] == [PlannerReady, RequestDone]


@pytest.mark.parametrize("error", [EOFError, BrokenPipeError, ConnectionResetError])
def test_planner_process_ends_quietly_if_its_pipe_breaks(error):
    calls = []

    def fail():
        calls.append(error)
        raise error

    run_planner(fail, None, None, None, None, None)
    assert calls == [error]


def test_unreadable_setup_ends_the_planner_with_its_error():
    def fail():
        raise ConfigError("no robot")

    with pytest.raises(ConfigError):
        run_planner(fail, None, None, None, None, None)
