"""Session with stubs: planning order and refusals."""

import asyncio
from collections.abc import Callable
from types import SimpleNamespace

import pytest

from kinesic.hardware.protocol.wire import BusError
from kinesic.serve.messages import DocumentRequest, Interruption, Renewal, Restyling, Resumption
from kinesic.serve.session import RENEWAL_PERIOD
from kinesic.speech.voice import HIBARI_TABLES_MODULE

from .staged_session import Stage, settle


def test_waiting_documents_of_several_clients_are_planned_in_turns(on_stage: Callable):
    async def act(stage: Stage) -> None:
        for name, sender in (("a", 1), ("b", 1), ("c", 2)):
            assert stage.session.perform(stage.document(name, sender)) is None
        assert stage.session.status()["waiting"] == 3
        assert not stage.planner.sent, "it is not warm yet"
        assert stage.planned() == ["a", "c", "b"]

    on_stage(act)


def test_planner_and_query_service_get_the_text_tables_of_the_voice(on_stage: Callable):
    async def act(stage: Stage) -> None:
        assert stage.planner.tables == stage.desk_tables == (HIBARI_TABLES_MODULE,)

    on_stage(act)


def test_document_is_sent_to_an_idle_planner_with_the_count_of_emergency_stops(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.planner.is_warm = True
        stage.loop.stop_count = 3
        assert not stage.session.status()["planning"]
        stage.session.perform(stage.document("a"))
        assert stage.session.status()["planning"]
        (sent,) = stage.planner.sent
        assert sent == DocumentRequest(stage.document("a"), 3)

    on_stage(act)


def test_idle_planner_gets_a_request_immediately(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.planner.is_warm = True
        stage.session.interrupt("b")
        assert [request.block for request in stage.planner.sent] == ["b"]
        assert stage.loop.silenced == ["b"], "speech fades out before the planner answers"

    on_stage(act)


def test_queued_client_requests_are_planned_before_documents(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.perform(stage.document("a"))
        stage.session.interrupt("b")
        stage.session.restyle(Restyling(None, (), None, None, 1))
        assert stage.planned() == ["Interruption", "Restyling", "a"]

    on_stage(act)


def test_block_of_a_client_with_too_many_waiting_blocks_is_refused(on_stage: Callable):
    async def act(stage: Stage) -> None:
        for _ in range(2):
            assert stage.session.perform(stage.document("a")) is None
        refusal = stage.session.perform(stage.document("b"))
        assert refusal is not None
        assert 'id="b"' in refusal
        assert "rule waiting: 2 of your blocks already wait" in refusal
        assert stage.session.perform(stage.document("c", 2)) is None

    on_stage(act)


def test_documents_are_refused_between_a_stop_and_a_resume_request(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.perform(stage.document("a", 4))
        stage.session.perform(stage.document("b", 5))
        stage.session.emergency_stop()
        assert stage.loop.stop_count == 1
        assert stage.session.status()["state"] == "stopped"
        await settle()
        assert [(sender, 'id="a"' in message or 'id="b"' in message) for message, sender in stage.told] == [
            (4, True),
            (5, True),
        ]
        assert all("rule stopped: an emergency stop came; resume first" in message for message, _ in stage.told)
        assert "resume first" in (stage.session.perform(stage.document("c")) or "")
        assert stage.session.arming_obstacle == "an emergency stop holds; resume first"
        stage.session.resume()
        assert stage.session.perform(stage.document("d")) is None
        stage.planner.become_free()
        assert stage.planner.sent.popleft() == Resumption(1)
        assert stage.planned() == ["d"]

    on_stage(act)


def test_resume_without_a_stop_releases_held_servos_without_a_planner_request(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.loop.held = True
        stage.session.resume()
        assert not stage.loop.held
        assert stage.planned() == []

    on_stage(act)


def test_emergency_stop_without_a_running_control_loop_raises_an_error(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.loop.alive = False
        with pytest.raises(RuntimeError, match="has ended"):
            stage.session.emergency_stop()
        assert stage.loop.stop_count == 0

    on_stage(act)


def test_session_refuses_documents_while_servos_hold_after_an_interruption(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.loop.held = True
        assert "hold after an interruption of more than a second" in (stage.session.perform(stage.document("a")) or "")
        assert stage.session.status()["state"] == "stopped"
        assert stage.planned() == []

    on_stage(act)


@pytest.mark.parametrize("armed", [True, False])
def test_servos_without_torque_refuse_documents(on_stage: Callable, armed: bool):
    async def act(stage: Stage) -> None:
        stage.loop.servos = SimpleNamespace(armed=armed, state="limp")
        refusal = stage.session.perform(stage.document("a"))
        assert (refusal is None) == armed
        assert armed or "rule limp" in (refusal or "")
        assert stage.session.status()["servos"] == "limp"

    on_stage(act)


def test_waiting_documents_are_refused_only_if_all_blocks_are_interrupted(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.perform(stage.document("a", 7))
        stage.session.interrupt("x")
        assert not stage.told
        stage.session.interrupt(None)
        ((message, sender),) = stage.told
        assert sender == 7
        assert "rule interrupted: everything was interrupted" in message
        stage.planner.become_free()
        assert stage.planner.sent.popleft().block == "x"
        assert stage.planned() == ["Interruption"]

    on_stage(act)


@pytest.mark.parametrize(
    ("rests", "idles", "state", "hindered"),
    [(True, False, "resting", False), (False, True, "resting", False), (False, False, "playing", True)],
)
def test_status_reports_motion_state_idling_planner_and_servos(
    on_stage: Callable, rests: bool, idles: bool, state: str, hindered: bool
):
    async def act(stage: Stage) -> None:
        stage.loop.rests, stage.loop.is_idling = rests, idles
        status = stage.session.status()
        assert (status["state"], status["idles"], status["robot"]) == (state, idles, "dummy")
        assert (status["planner"], status["servos"], status["deaths"]) == ("starting", None, 0)
        assert bool(stage.session.arming_obstacle) == hindered
        stage.planner.is_warm = True
        assert stage.session.status()["planner"] == "warm"
        stage.session.emergency_stop()
        assert stage.session.status()["idles"] is False

    on_stage(act)


def test_client_is_unfinished_with_waiting_planned_or_running_blocks(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.perform(stage.document("a", 1))
        stage.planner.serving, stage.loop.unfinished_client = 2, 3
        assert [stage.session.has_unfinished_blocks(sender) for sender in range(5)] == [False, True, True, True, False]

    on_stage(act)


def test_session_start_waits_until_the_planner_is_ready(on_stage: Callable):
    async def act(stage: Stage) -> None:
        starting = asyncio.create_task(stage.session.start())
        await settle()
        assert not starting.done()
        stage.planner.become_free()
        await starting
        assert stage.loop.late_ticks == 0

    on_stage(act)


def test_planner_start_failure_raises_and_ends_the_loop(on_stage: Callable):
    async def act(stage: Stage) -> None:
        starting = asyncio.create_task(stage.session.start())
        await settle()
        stage.planner.has_failed = True
        stage.planner.lost(None)
        with pytest.raises(RuntimeError, match="the planner does not start"):
            await starting
        assert stage.loop.shutdowns == 1

    on_stage(act)


def test_servo_failure_while_the_planner_starts_aborts_the_session_start(on_stage: Callable):
    async def act(stage: Stage) -> None:
        starting = asyncio.create_task(stage.session.start())
        await settle()
        stage.loop.alive, stage.loop.error = False, BusError("the servos were stopped")
        with pytest.raises(BusError, match="the servos were stopped"):
            await starting

    on_stage(act)


def test_document_that_kills_the_planner_is_refused(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.planner.lost(DocumentRequest(stage.document("a", 8), 0))
        stage.planner.lost(Interruption(None))
        ((message, sender),) = stage.told
        assert sender == 8
        assert 'id="a"' in message
        assert "took longer than 3 s" in message
        assert stage.loop.shutdowns == 0, "another planner follows"

    on_stage(act)


def test_folding_the_arms_waits_until_all_blocks_have_ended(on_stage: Callable):
    async def act(stage: Stage) -> None:
        folding = asyncio.create_task(stage.session.fold())
        for stage.loop.rests in (False, True):
            await settle()
            assert not folding.done(), "the request waits for the planner"
        stage.planner.become_free()
        await settle()
        assert not folding.done(), "the planner is busy"
        stage.loop.rests, stage.planner.busy = False, False
        await settle()
        assert not folding.done(), "the robot moves"
        stage.loop.rests = True
        await folding
        interruption = stage.planner.sent.popleft()
        assert (interruption.block, interruption.yields, interruption.sender) == (None, False, None)

    on_stage(act)


def test_folding_the_arms_does_not_wait_for_an_ended_loop(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.loop.alive = False
        stage.planner.busy = True
        await asyncio.wait_for(stage.session.fold(), 5.0)
        assert stage.planner.busy

    on_stage(act)


@pytest.mark.parametrize("alive", [True, False])
def test_closing_the_session_ends_the_control_loop_and_planner_and_client_queries_and_arming(
    on_stage: Callable, alive: bool
):
    async def act(stage: Stage) -> None:
        stage.loop.alive = alive
        renewing = asyncio.create_task(stage.saved())
        await asyncio.sleep(0)
        stage.session.close()
        await asyncio.gather(renewing, return_exceptions=True)
        assert (stage.loop.shutdowns, stage.loop.joined) == (1, int(alive))
        assert (stage.planner.closed, stage.desk.closed, stage.arming.closed) == (1, 1, 1)
        assert not stage.planned()

    on_stage(act)


def test_lexicon_reload_is_shared_by_waiting_callers_and_rate_limited(on_stage: Callable):
    async def act(stage: Stage) -> None:
        await asyncio.gather(stage.saved(), stage.saved())
        assert stage.slept == [0.0]
        assert stage.planned() == ["Renewal"]
        stage.time += 0.25
        await stage.saved()
        assert stage.slept[1:] == [pytest.approx(RENEWAL_PERIOD - 0.25)]
        assert stage.planned() == ["Renewal"]
        assert Renewal() == Renewal()

    on_stage(act)


def test_loop_messages_are_delivered_in_the_asyncio_thread(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.loop.send_feedback("<x/>", 3)
        stage.loop.notify_server("ready")
        assert not stage.told
        await settle()
        assert stage.told == [("<x/>", 3)]
        assert stage.planner.received == ["ready"]

    on_stage(act)
