"""Ticks of the live loop: the clock, the sinks, and who owns the time."""

from math import floor

import numpy as np
import pytest

from kinesic.controller.play import SETTLE
from kinesic.face.display import DisplayError
from kinesic.hardware.protocol.wire import BusError
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.serve.loop import HICCUP, PERIOD
from kinesic.serve.messages import FeedbackNotice, PlannerReady, RequestDone
from kinesic.serve.sinks.real_time import RealTimeSink

from .played_sinks import Held, Timed, TimedServos
from .simulated import Recorder, Simulation, nod, proposal


def until(*times: float):
    yield from times


def test_every_sink_gets_each_tick_once(simulation: Simulation):
    recorders = [Recorder(), Recorder()]
    loop = simulation.make([RealTimeSink(each) for each in recorders])
    simulation.run(until(1.005))
    for each in recorders:
        assert np.allclose(each.times, np.arange(101) / 100)
        assert each.closed == 1
    assert loop.late == 0
    assert not loop.failed
    assert loop.error is None


def test_ticks_come_one_period_after_the_other(simulation: Simulation):
    """Half a period late is seen by nobody, a whole one is."""
    seen = []

    class Watch(Recorder):
        def write(self, command, /):
            seen.append((simulation.now, command.time))

    simulation.make([RealTimeSink(Watch())])
    simulation.run(until(1.005))
    assert max(abs(now - time) for now, time in seen) < PERIOD / 4


def test_a_loop_that_was_held_up_catches_up(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])

    def script():
        yield 0.5
        simulation.time += HICCUP - 3 * PERIOD
        yield 1.005

    simulation.run(script())
    assert np.allclose(recorder.times, np.arange(101) / 100)
    assert loop.late == 1
    assert simulation.clock.now() == pytest.approx(1.0, abs=2 * PERIOD)


def test_two_periods_are_no_delay_that_counts(simulation: Simulation):
    loop = simulation.make()

    def script():
        yield 0.5
        simulation.time += 0.5 * PERIOD
        yield 0.7
        simulation.time += 1.5 * PERIOD
        yield 1.0

    simulation.run(script())
    assert loop.late == 1


def test_time_stands_still_while_the_machine_sleeps(simulation: Simulation):
    recorder = Recorder()
    simulation.make([RealTimeSink(recorder)])

    def script():
        yield 0.5
        simulation.time += 3600.0
        yield 3600.6

    simulation.run(script())
    assert 0.55 < simulation.clock.now() < 0.7
    assert np.allclose(np.diff(recorder.times), PERIOD)
    assert simulation.loop.late == 0


def test_a_sink_that_owns_the_time_sets_the_clock(simulation: Simulation):
    timed, other = Timed(), Recorder()
    timed.speed = 0.5
    simulation.make([RealTimeSink(timed), RealTimeSink(other)])
    simulation.run(until(2.0))
    assert simulation.clock.now() == pytest.approx(1.0, abs=2 * PERIOD)
    assert other.times[-1] == pytest.approx(1.0, abs=2 * PERIOD)
    assert np.allclose(np.diff(other.times), PERIOD)


def test_time_never_goes_back_and_stands_while_it_is_unknown(simulation: Simulation):
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


def test_limp_servos_own_no_time_and_get_their_commands_from_where_they_are_armed(simulation: Simulation):
    servos = TimedServos()
    loop = simulation.make([RealTimeSink(servos, ahead=0.5), RealTimeSink(Recorder())])
    servos.says = 0.0

    def script():
        yield 1.0
        assert simulation.clock.now() == pytest.approx(1.0, abs=PERIOD)
        assert not servos.armed
        servos.commands.clear()
        loop.arm()
        servos.says = None
        yield 1.05
        assert servos.armed
        assert servos.times[0] == pytest.approx(1.0, abs=2 * PERIOD), "they begin with the motion as it is then"
        assert simulation.clock.now() == pytest.approx(1.0, abs=2 * PERIOD)

    simulation.run(script())
    assert loop.servos is servos


def test_arming_without_servos_changes_nothing(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])

    def script():
        yield 0.1
        loop.arm()
        yield 0.2

    simulation.run(script())
    assert loop.servos is None
    assert np.allclose(np.diff(recorder.times), PERIOD)


@pytest.mark.parametrize("fault", [BusError("unplugged"), DisplayError("no window")])
def test_a_sink_that_fails_ends_the_loop_and_closes_all(simulation: Simulation, fault: Exception):
    recorders = [Recorder(), Recorder()]
    loop = simulation.make([RealTimeSink(each) for each in recorders])

    def script():
        yield 0.5
        recorders[0].fault = fault
        yield 5.0

    simulation.run(script())
    assert simulation.now < 0.6
    assert loop.failed
    assert loop.error is fault
    assert [each.closed for each in recorders] == [1, 1]


def test_a_fault_of_the_program_is_a_failure_too(simulation: Simulation):
    recorder = Recorder()
    loop = simulation.make([RealTimeSink(recorder)])
    recorder.fault = ZeroDivisionError("a fault of the program")
    with pytest.raises(ZeroDivisionError):
        simulation.run(until(1.005))
    assert loop.failed
    assert loop.error is None
    assert recorder.closed == 1


def test_consent_is_asked_of_all_sinks(simulation: Simulation):
    held, free = Held(), Recorder()
    loop = simulation.make([RealTimeSink(free), RealTimeSink(held)])
    assert loop.waits()
    loop.resume()
    assert not loop.waits()
    assert not held.held


def test_nobody_waits_without_such_a_sink(simulation: Simulation):
    loop = simulation.make([RealTimeSink(Recorder())])
    loop.resume()
    assert not loop.waits()


def test_it_has_settled_a_little_after_all_is_over(simulation: Simulation):
    loop = simulation.make()
    planner = simulation.link()
    settled = {}

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1, 1.0), cut=0.1, agenda=(ScheduledFeedback(2.0, "x"),)))
        yield 0.05
        end = loop.motion.end
        for time in (0.5, end + SETTLE - 0.03, 1.9, 2.05):
            yield time
            settled[round(time, 2)] = loop.settled()

    simulation.run(script())
    assert list(settled.values()) == [False, False, False, True], settled


def test_motion_alone_settles_after_its_stillness(simulation: Simulation):
    loop = simulation.make()
    end, settled = loop.motion.end, []

    def script():
        for time in (end + SETTLE - 0.03, end + SETTLE + 0.03):
            yield time
            settled.append(loop.settled())

    simulation.run(script())
    assert settled == [False, True]


def test_words_of_the_planner_go_where_they_belong(simulation: Simulation):
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
    assert time == pytest.approx(0.1, abs=2 * PERIOD), "at once"


def test_the_loop_goes_on_without_a_planner(simulation: Simulation):
    recorder = Recorder()
    simulation.make([RealTimeSink(recorder)])
    planner = simulation.link()

    def script():
        yield 0.2
        planner.close()
        yield 0.505

    simulation.run(script())
    assert np.allclose(recorder.times, np.arange(floor(0.5 / PERIOD) + 1) * PERIOD)


def test_the_body_is_where_the_motion_has_it_if_nothing_measures(simulation: Simulation):
    loop = simulation.make([RealTimeSink(Recorder())])
    planner = simulation.link()
    reports = []

    def script():
        planner.send(proposal(motion=nod(simulation.setup, 0.1), cut=0.1))
        yield 1.0
        reports.append(loop.body())

    simulation.run(script())
    (report,) = reports
    expected = nod(simulation.setup, 0.1).angles(np.array([report.time]))[0]
    assert report.time == pytest.approx(1.0, abs=PERIOD)
    assert report.angles == report.planned == pytest.approx(expected, abs=2e-4)
    assert report.servos is None


def test_the_body_is_told_as_the_last_sink_measures_it_and_with_the_servos_health(simulation: Simulation):
    class Measuring(Recorder):
        def __init__(self, angle):
            super().__init__()
            self.angle = angle

        def seen(self):
            return 1.0, np.full(2, self.angle)

    loop = simulation.make([RealTimeSink(Measuring(0.1)), RealTimeSink(Measuring(0.2))])
    assert loop.body().angles == (0.2, 0.2)
    servos = TimedServos()
    report = simulation.make([RealTimeSink(servos)]).body()
    assert (report.hottest, report.volts, report.faulty) == (41.0, 11.5, True)
    assert report.angles == (0.5, 0.5)


def test_a_planner_is_told_the_clock_and_what_accompanies_the_motion(simulation: Simulation):
    loop = simulation.make()
    assert loop.properties.clock is simulation.clock
    assert loop.properties.accompaniment.face
