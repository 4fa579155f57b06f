"""Runs the supervisor's loop: a cycle of the wires, what follows from it, and a status for the planner."""

from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic

import numpy as np

from kinesic.hardware.bus.host import Punctuality
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.axes import Axes, Snapshot
from kinesic.hardware.supervisor.channel import Channel
from kinesic.hardware.supervisor.failures import FailureWatch, InterruptionWatch
from kinesic.hardware.supervisor.goals import GoalSteering
from kinesic.hardware.supervisor.identity import identify
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.monitor import CommunicationMonitor
from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.player import DONE
from kinesic.hardware.supervisor.preflight import Table, configure, control_tables, take_over
from kinesic.hardware.supervisor.requests import Requests
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import MOVING, Action, Event, Stage, SupervisorState, step
from kinesic.hardware.supervisor.status import EventLog, StatusWriter
from kinesic.hardware.supervisor.torque import (
    RAMP,
    Procedure,
    adopt,
    energise,
    keep_watchdogs,
    release_torque,
    watchdog_counts,
)

TAKEN = 32  # commands in one cycle at most: it must not take long
AHEAD = 2.0  # [s] of the performance that are taken from the channel
WIRE_SHARE = 0.9  # of a period that the wires may take; the rest is for deciding
LEAST = 1e-4  # [s] between two cycles
LOOKS = 100  # cycles until everybody must have answered


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What a supervisor stands between: wires on one side, the planner on the other; and its log."""

    opens: Callable[[str], Wire]  # the wire of a bus, by its name; raises BusError
    channel: Channel  # to the planner
    planner: Callable[[], bool]  # whether it lives
    journal: EventLog
    announce: Callable[[], None] = lambda: (
        None
    )  # once the ports are held, before anything is configured; raises BusError


class Supervisor:
    """Drives the servos of a manifest for whoever writes into the channel. It never raises for them."""

    def __init__(
        self, manifest: Manifest, surroundings: Surroundings, settings: SupervisorSettings, *, watchdog: float
    ) -> None:
        """Nothing is opened yet; `watchdog` [s] is that of the servos' bus watchdogs."""
        self.manifest, self.state = manifest, SupervisorState()
        self.late = 0  # cycles that began more than a period late, as the loop counts them
        self._around, self._channel, self._settings = surroundings, surroundings.channel, settings
        self._least_watchdog, self._host = watchdog_counts(watchdog), Punctuality(watchdog)
        self._writer = StatusWriter(manifest, surroundings.channel, surroundings.journal)
        self._steering, self._monitor = GoalSteering(manifest, settings), CommunicationMonitor(manifest, ())
        self._failures, self._interruptions = FailureWatch(manifest, self._note), InterruptionWatch(settings.startle)
        self._requests = Requests(surroundings.channel, surroundings.planner)
        self._axes: Axes | None = None
        self._tables: tuple[Table, ...] = ()
        self._procedure: Procedure | None = None
        self._concerned: list[int] = []  # the members it is about
        self._last: Snapshot | None = None
        self._since = self._clock = 0.0  # [s] in this stage; of the last cycle
        self._limited = False  # whether goals were cut in the last cycle

    @property
    def done(self) -> bool:
        """Whether all is over."""
        return self._axes is None

    def open(self) -> None:
        """Opens the ports and checks who is there; nothing is energised."""
        self._advance("open")
        self._write_status()

    def step(self) -> None:
        """Runs one period."""
        axes = self._axes
        if axes is None:
            return
        now = axes.now()
        seconds = min(max(now - self._clock, LEAST), 2 * self._settings.period)
        self._clock = now
        if news := self._host.note(now, excused=self._procedure is not None):
            self._note("host", news)
        self._requests.look()
        self._take_commands()
        self._move(seconds)
        self._look(axes, self._goals(), seconds)
        if self._procedure is None and self._last is not None:
            keep_watchdogs(axes, self._last, self._watchdog)
        self._proceed()
        for event in self._detect_events():
            self._advance(event)
        self._interruptions.note_servos(well=self._monitor.well or not self.state.armed)
        self._write_status()

    def _take_commands(self) -> None:
        player, performances = self._steering.player, self._steering.player.performances
        before = player.left > DONE
        taken = self._channel.commands(TAKEN if player.left < AHEAD else 0)
        for time, goals, leads in taken:
            if not player.take(time, goals, leads):
                self._note("dropped", f"a command for {time:.3f} s came too late, or is not a number")
        fresh = player.performances != performances
        stage, left = self.state.stage, player.left > DONE
        self._interruptions.note_commands(self._clock, stage=stage, before=before, left=left, fresh=fresh)

    def sleep(self, until: float) -> None:
        """Waits until a time [s] on the wires' clock."""
        if self._axes is not None:
            self._axes.sleep(until)

    def now(self) -> float:
        """Returns the time [s] on the wires' clock."""
        return self._axes.now() if self._axes is not None else monotonic()

    def _look(self, axes: Axes, goals: Ticks | None, seconds: float) -> None:
        self._last = axes.cycle(goals)
        self._monitor.look(self._last, self._steering.goals, seconds)
        for name, event in self._last.events:
            self._note(event.kind, f"{name}: {event.text}", -1 if event.servo is None else event.servo)

    def _move(self, seconds: float) -> None:
        stage, monitor = self.state.stage, self._monitor
        target = min(monitor.scale, self._host.pace) if stage is Stage.ACTIVE else float(stage in MOVING)
        hurry = self._requests.alone or stage in (Stage.STOPPED, Stage.LOST)
        slow = self._settings.quick if hurry and not target else self._settings.slow
        if stage is Stage.ACTIVE and self._requests.pace < target:
            target, slow = self._requests.pace, self._settings.wary
        refused = self._steering.move(seconds, monitor.present, target=target, slow=slow) & monitor.energised
        if refused.any() and not self._limited:
            names = ", ".join(sorted({self.manifest.members[k].hinge for k in np.flatnonzero(refused)}))
            self._note("limited", f"goals of {names} were asked beyond what they may do")
        self._limited = bool(refused.any())

    def _goals(self) -> Ticks | None:
        limp = ~self._monitor.energised
        if self._procedure is not None:
            limp[self._concerned] = False  # the procedure says where they are
        self._steering.follow_limp(limp, self._monitor.present)
        return self._steering.ticks()

    @property
    def _watchdog(self) -> int:
        """BUS_WATCHDOG of servos with torque."""
        return min(self._host.stretch * self._least_watchdog, Register.BUS_WATCHDOG.field.upper)

    def _observe(self) -> Observation:
        player, monitor, asked, stage = self._steering.player, self._monitor, self._requests, self.state.stage
        settings, lasted = self._settings, self._clock - self._since
        resting = stage is Stage.HOLD and lasted > settings.patience
        patience = settings.consent if self.state.paused else settings.patience
        waits = (stage is Stage.HOLD or not monitor.answering) and not self.state.stopped
        vain = waits and lasted > patience
        enough = DONE if stage in MOVING or asked.ended else settings.lead - DONE
        return Observation(
            energised=monitor.any_energised,
            answering=monitor.answering,
            well=monitor.well and self._procedure is None,
            limp=monitor.any_limp,
            begun=player.begun,
            due=not asked.alone and player.left > enough,
            ended=asked.alone or (asked.ended and (player.left <= DONE or vain)),
            alone=asked.alone,
            release=asked.release,
            weak=monitor.weak,
            raised=bool(monitor.raised.any()),
            confirmed=asked.confirmed,
            interrupted=self._interruptions.interrupted,
            still=player.still,
            reached=player.reached and self._steering.arrived,
            idle=resting,
            hopeless=stage is Stage.LOST and self._interruptions.unwell > settings.hopeless,
            policy=asked.policy(settings.policy),
        )

    def _detect_events(self) -> tuple[Event, ...]:
        stage, monitor, events = self.state.stage, self._monitor, list(self._requests.events())
        if monitor.lost and stage is not Stage.LOST:
            events.append("lost")
        if not monitor.lost and stage is Stage.LOST:
            events.append("back")
        if monitor.tripped and not monitor.lost:
            events.append("tripped")
        failures = self._failures.look(monitor)
        if "failed" in failures:
            self._steering.give_up(monitor.stuck, monitor.present)
        return (*events, *failures, "tick")

    def _advance(self, event: Event) -> None:
        """Lets the state machine see an event, and begins what it asks for."""
        before = self.state
        if event == "resumed":
            self._interruptions.note_consent()
        self.state, actions = step(self.state, event, self._observe())
        if self.state.stage is not before.stage:
            self._since = self._clock
            self._note("stage", f"{before.stage.value} -> {self.state.stage.value} ({event})")
        if self.state.paused and not before.paused and event != "estop" and not self.state.faulty:
            why = self._interruptions.describe(self._monitor.trouble())
            self._note("paused", f"{why}; nothing goes on before somebody consents")
        for action in actions:
            self._perform(action)

    def _perform(self, action: Action) -> None:
        steering = self._steering
        if action == "check":
            self._try(self._check)
        elif action == "configure":
            self._try(self._configure)
        elif action in ("arm", "identify", "adopt", "release"):
            self._begin(action)
        elif action == "hold":
            self._procedure = None
            steering.hold()
        elif action == "slow":
            self._procedure = None
        elif action == "approach":
            steering.approach()
        elif action == "follow":
            steering.player.follow()
        elif action == "fold":
            steering.fold(self._monitor.holding_joints)
        elif action == "close":
            self._close()

    def _try(self, deed: Callable[[], None]) -> None:
        """Does something that takes its time, while nothing moves."""
        try:
            deed()
        except BusError as error:
            for line in str(error).splitlines():
                self._note("refused", line)
            self._advance("refused")
        else:
            self._advance("done")

    def _check(self) -> None:
        axes, self._tables = take_over(self.manifest, self._around.opens, period=WIRE_SHARE * self._settings.period)
        self._axes, self._monitor = axes, CommunicationMonitor(self.manifest, self._tables)
        self._around.announce()
        for _ in range(LOOKS):
            self._look(axes, None, self._settings.period)
            if self._monitor.answering:
                return
        silent = ", ".join(axes.where(k) for k in np.flatnonzero(~self._monitor.answered).tolist())
        raise BusError(f"{silent}: answers too rarely; check plugs, cable length and latency timer")

    def _configure(self) -> None:
        if self._axes is not None:
            for change in configure(self._axes, self._tables):
                self._note("configured", f"{change.register.name}: {change.before} -> {change.after}", change.servo)
            self._tables = control_tables(self._axes)
            self._clock = self._axes.now()

    def _begin(self, action: Action) -> None:
        axes, last = self._axes, self._last
        if axes is None or last is None:
            return
        power = np.array([table[Register.PWM_LIMIT] for table in self._tables], dtype=np.int64)
        self._steering.hold()
        self._concerned = list(axes.everybody)
        if action == "arm":
            self._concerned = np.flatnonzero(self._monitor.limp).tolist()
            self._steering.take_back(self._concerned)
            steps = round(RAMP / self._settings.period)
            self._procedure = energise(axes, self._concerned, last, power, watchdog=self._watchdog, steps=steps)
        elif action == "identify":
            self._procedure = identify(axes, self._tables, watchdog=self._watchdog)
        elif action == "adopt":
            earlier = self._steering.goals
            if earlier is None:
                earlier = np.array([table[Register.GOAL_POSITION] for table in self._tables], dtype=np.float64)
            self._procedure = adopt(axes, last, earlier, power, watchdog=self._watchdog)
        else:
            self._procedure = release_torque(axes, tries=round(self._settings.hopeless / self._settings.period))
        self._proceed(first=True)

    def _proceed(self, *, first: bool = False) -> None:
        """Lets the procedure see the last cycle, and say what it wants of the next."""
        procedure = self._procedure
        if procedure is None or self._last is None:
            return
        try:
            goals = next(procedure) if first else procedure.send(self._last)
            if goals is not None:
                self._steering.put(self._concerned, goals)
        except StopIteration:
            self._procedure = None
            self._advance("done")
        except BusError as error:
            self._procedure = None
            self._note("refused", str(error))
            self._advance("refused")

    def _close(self) -> None:
        if self._axes is not None:
            self._axes.close()
        self._axes = self._procedure = None

    def _note(self, kind: str, text: str, servo: int = -1) -> None:
        self._writer.note(self.now(), kind, text, servo)

    def _write_status(self) -> None:
        self._writer.write(self._clock, self.state, self._monitor, self._steering, self.late)
