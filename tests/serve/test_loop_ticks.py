"""Ticks of the control loop: clock, sinks and time sources."""

from dataclasses import replace
from math import floor

import numpy as np
import pytest

from kinesic.body.command import SETTLE_DURATION
from kinesic.face.display import DisplayError
from kinesic.hardware.protocol.wire import BusError
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.serve.loop import MAX_CLOCK_LAG, TICK_PERIOD
from kinesic.serve.messages import FeedbackNotice, PlannerReady, RequestDone
from kinesic.serve.sinks.real_time import RealTimeSink

from .played_sinks import Held, Timed, TimedServos
from .simulated import Recorder, Simulation, nod, proposal


def until(*times: float):
    yield from times


def test_each_sink_gets_the_command_of_each_tick_once(simulation: Simulation):
    recorders = [Recorder(), Recorder()]
    loop = simulation.make([RealTimeSink(recorder) for recorder in recorders])
    simulation.run(until(1.005))
    for each in recorders:
        assert np.allclose(each.times, np.arange(101) / 100)
        assert each.closed == 1
    assert loop.late_ticks == 0
    assert not loop.has_failed
    assert loop.error is None


def test_commands_are_written_within_a_quarter_tick_of_their_time(simulation: Simulation):
    seen = []

    class Watch(Recorder):
        def write(self, command, /):
            seen.append((simulation.now, command.time))

    simulation.make([RealTimeSink(Watch())])
    simulation.run(until(1.005))
    assert max(abs(now - time) for now, time in seen) < TICK_PERIOD / 4


def test_delayed_control_loop_sends_all_missed_commands_later(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])

    def script():
        yield 0.5
        simulation.time += MAX_CLOCK_LAG - 3 * TICK_PERIOD
        yield 1.005

    simulation.run(script())
    assert np.allclose(recorder.times, np.arange(101) / 100)
    assert loop.late_ticks == 1
    assert simulation.clock.now() == pytest.approx(1.0, abs=2 * TICK_PERIOD)


def test_only_a_loop_delay_above_one_tick_period_counts_as_a_late_tick(simulation: Simulation):
    loop = simulation.make()

    def script():
        yield 0.5
        simulation.time += 0.5 * TICK_PERIOD
        yield 0.7
        simulation.time += 1.5 * TICK_PERIOD
        yield 1.0

    simulation.run(script())
    assert loop.late_ticks == 1


def test_server_clock_pauses_while_the_machine_is_suspended(simulation: Simulation):
    recorder = Recorder()
    simulation.make([RealTimeSink(recorder)])

    def script():
        yield 0.5
        simulation.time += 3600.0
        yield 3600.6

    simulation.run(script())
    assert 0.55 < simulation.clock.now() < 0.7
    assert np.allclose(np.diff(recorder.times), TICK_PERIOD)
    assert simulation.loop.late_ticks == 0


def test_sink_with_performance_time_sets_the_server_clock(simulation: Simulation):
    timed, other = Timed(), Recorder()
    timed.speed = 0.5
    simulation.make([RealTimeSink(timed), RealTimeSink(other)])
    simulation.run(until(2.0))
    assert simulation.clock.now() == pytest.approx(1.0, abs=2 * TICK_PERIOD)
    assert other.times[-1] == pytest.approx(1.0, abs=2 * TICK_PERIOD)
    assert np.allclose(np.diff(other.times), TICK_PERIOD)


def test_server_clock_never_decreases_and_pauses_while_the_performance_time_is_unknown(simulation: Simulation):
    timed = Timed()
    simulation.make([RealTimeSink(timed)])
    times = []

    def script():
        for says in (0.1, 0.5, 0.3, None, None, 0.45, 0.6):
            timed.says = says
            yield simulation.now + 0.05
            times.append(round(simulation.clock.now(), 1))

    simulation.run(script())
    assert times == [0.1, 0.5, 0.5, 0.5, 0.5, 0.5, 0.6]


def test_unarmed_servos_do_not_set_the_clock_and_get_commands_after_arming(simulation: Simulation):
    servos = TimedServos()
    loop = simulation.make([RealTimeSink(servos, ahead=0.5), RealTimeSink(Recorder())])
    servos.says = 0.0

    def script():
        yield 1.0
        assert simulation.clock.now() == pytest.approx(1.0, abs=TICK_PERIOD)
        assert not servos.armed
        servos.commands.clear()
        loop.arm()
        servos.says = None
        yield 1.05
        assert servos.armed
        assert servos.times[0] == pytest.approx(1.0, abs=2 * TICK_PERIOD), "they begin with the motion as it is then"
        assert simulation.clock.now() == pytest.approx(1.0, abs=2 * TICK_PERIOD)

    simulation.run(script())
    assert loop.servos is servos


def test_arming_request_without_servos_changes_nothing(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])

    def script():
        yield 0.1
        loop.arm()
        yield 0.2

    simulation.run(script())
    assert loop.servos is None
    assert np.allclose(np.diff(recorder.times), TICK_PERIOD)


@pytest.mark.parametrize("fault", [BusError("unplugged"), DisplayError("no window")])
def test_failed_sink_ends_the_control_loop_and_closes_all_sinks(simulation: Simulation, fault: Exception):
    recorders = [Recorder(), Recorder()]
    loop = simulation.make([RealTimeSink(recorder) for recorder in recorders])

    def script():
        yield 0.5
        recorders[0].fault = fault
        yield 5.0

    simulation.run(script())
    assert simulation.now < 0.6
    assert loop.has_failed
    assert loop.error is fault
    assert [recorder.closed for recorder in recorders] == [1, 1]


def test_unexpected_exception_in_the_loop_counts_as_failure(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    recorder.fault = ZeroDivisionError("a fault of the program")
    with pytest.raises(ZeroDivisionError):
        simulation.run(until(1.005))
    assert loop.has_failed
    assert loop.error is None
    assert recorder.closed == 1


def test_control_loop_needs_a_resume_request_while_one_of_its_outputs_is_held(simulation: Simulation):
    held, free = Held(), Recorder()
    loop = simulation.make([RealTimeSink(free), RealTimeSink(held)])
    assert loop.needs_resume()
    loop.resume()
    assert not loop.needs_resume()
    assert not held.held


def test_loop_without_resumable_sinks_needs_no_resume(simulation: Simulation):
    loop = simulation.make([RealTimeSink(Recorder())])
    loop.resume()
    assert not loop.needs_resume()


def test_control_loop_is_settled_when_motion_and_feedback_have_ended(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()
    settled = {}

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1, 1.0), cut=0.1, agenda=(ScheduledFeedback(2.0, "x"),)))
        yield 0.05
        end = loop.motion.end
        for time in (0.5, end + SETTLE_DURATION - 0.03, 1.9, 2.05):
            yield time
            settled[round(time, 2)] = loop.is_settled()

    simulation.run(script())
    assert list(settled.values()) == [False, False, False, True], settled


def test_control_loop_is_settled_once_the_remaining_motion_is_at_rest(simulation: Simulation):
    """After an interruption, the remaining motion is at rest for seconds."""
    loop = simulation.make()
    planner = simulation.link()
    short, settled = nod(simulation.setup, 0.1, 1.0), []
    resting = replace(short, controls=np.vstack((short.controls, np.repeat(short.controls[-1:], 900, axis=0))))

    def script():
        planner.send(proposal(motion=resting, cut=0.1))
        for time in (0.5, short.end + SETTLE_DURATION + 0.03):
            yield time
            settled.append(loop.is_settled())

    simulation.run(script())
    assert settled == [False, True]


def test_control_loop_without_feedback_is_settled_shortly_after_the_motion_end(simulation: Simulation):
    loop = simulation.make()
    end, settled = loop.motion.rest_start, []

    def script():
        for time in (end + SETTLE_DURATION - 0.03, end + SETTLE_DURATION + 0.03):
            yield time
            settled.append(loop.is_settled())

    simulation.run(script())
    assert settled == [False, True]


def test_planner_messages_reach_client_or_server(simulation: Simulation):
    simulation.make()
    planner = simulation.link()

    def script():
        yield 0.1
        planner.send(PlannerReady())
        planner.send(FeedbackNotice("<warning/>", 7))
        planner.send(RequestDone())
        yield 0.2
        planner.close()
        yield 0.4

    simulation.run(script())
    assert simulation.news == [PlannerReady(), RequestDone(), None]
    ((time, message, sender),) = simulation.told
    assert (message, sender) == ("<warning/>", 7)
    assert time == pytest.approx(0.1, abs=2 * TICK_PERIOD), "at once"


def test_control_loop_continues_without_a_planner(simulation: Simulation):
    recorder = Recorder()
    simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        yield 0.2
        planner.close()
        yield 0.505

    simulation.run(script())
    assert np.allclose(recorder.times, np.arange(floor(0.5 / TICK_PERIOD) + 1) * TICK_PERIOD)


def test_body_report_without_a_measuring_sink_contains_the_planned_angles(simulation: Simulation):
    loop = simulation.make([RealTimeSink(Recorder())])
    planner = simulation.link()
    reports = []

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1))
        yield 1.0
        reports.append(loop.report_body())

    simulation.run(script())
    (report,) = reports
    expected = nod(simulation.setup, 0.1).angles(np.array([report.time]))[0]
    assert report.time == pytest.approx(1.0, abs=TICK_PERIOD)
    assert report.angles == report.planned == pytest.approx(expected, abs=2e-4)
    assert report.servos is None


def test_body_report_uses_the_last_measuring_sink_and_servo_health(simulation: Simulation):
    class Measuring(Recorder):
        def __init__(self, angle):
            super().__init__()
            self.angle = angle

        def measurement(self):
            return 1.0, np.full(2, self.angle)

    loop = simulation.make([RealTimeSink(Measuring(0.1)), RealTimeSink(Measuring(0.2))])
    assert loop.report_body().angles == (0.2, 0.2)
    servos = TimedServos()
    report = simulation.make([RealTimeSink(servos)]).report_body()
    assert (report.hottest, report.volts, report.faulty) == (41.0, 11.5, True)
    assert report.angles == (0.5, 0.5)


def test_loop_properties_contain_the_server_clock_and_the_face_output(simulation: Simulation):
    loop = simulation.make()
    assert loop.properties.clock is simulation.clock
    assert loop.properties.accompaniment.face
