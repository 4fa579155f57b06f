"""Main loop of the supervisor: bus cycles, reactions and status."""

from collections.abc import Callable
from time import monotonic

import numpy as np

from kinesic.hardware.bus.host import Punctuality
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes, Snapshot
from kinesic.hardware.supervisor.caps import CapWriter
from kinesic.hardware.supervisor.context import SupervisorContext
from kinesic.hardware.supervisor.failures import FailureWatch, InterruptionWatch
from kinesic.hardware.supervisor.goals import GoalSteering
from kinesic.hardware.supervisor.identity import identify
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.monitor import CommunicationMonitor
from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.player import END_TOLERANCE
from kinesic.hardware.supervisor.preflight import RegisterTable, configure, read_manifest_tables, take_over
from kinesic.hardware.supervisor.requests import Requests
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import MOVING_STAGES, Action, Event, Stage, SupervisorState
from kinesic.hardware.supervisor.status import StatusWriter
from kinesic.hardware.supervisor.torque import (
    POWER_RAMP_TIME,
    Procedure,
    adopt,
    energise,
    keep_watchdogs,
    release_torque,
    watchdog_counts,
)
from kinesic.hardware.supervisor.transitions import step
from kinesic.hardware.supervisor.wiring_check import explain_rare_answers

MAX_COMMANDS_PER_CYCLE = 32  # Largest number of commands read per cycle, which bounds the cycle's duration
COMMAND_LOOKAHEAD = 2.0  # [s] duration of commands read ahead from the channel
WIRE_TIME_FRACTION = 0.9  # fraction of a cycle period for bus traffic; the rest is for computation
MIN_STEP_TIME = 1e-4  # [s] smallest time step between two cycles
CHECK_CYCLES = 100  # Cycles after the start within which all servos must have answered


class Supervisor:
    """Control loop for all servos of a manifest."""

    def __init__(
        self, manifest: Manifest, context: SupervisorContext, settings: SupervisorSettings, *, watchdog: float
    ) -> None:
        """Create a supervisor with a watchdog time [s], without opening a port."""
        self.manifest, self.state = manifest, SupervisorState()
        self.late = 0  # number of cycles that began more than a period late, counted by the caller's loop
        self._context, self._channel, self._settings = context, context.channel, settings
        self._least_watchdog, self._host = watchdog_counts(watchdog), Punctuality(watchdog)
        self._writer = StatusWriter(manifest, context.channel, context.journal)
        self._steering, self._monitor = GoalSteering(manifest, settings), CommunicationMonitor(manifest, ())
        self._failures, self._interruptions = FailureWatch(manifest, self._note), InterruptionWatch(settings.startle)
        self._requests = Requests(context.channel, context.planner)
        self._caps, self._brakes = CapWriter(manifest, ()), False  # whether a quick stop is in progress
        self._axes: Axes | None = None
        self._tables: tuple[RegisterTable, ...] = ()
        self._procedure: Procedure | None = None
        self._members: list[int] = []  # members of the procedure
        self._last: Snapshot | None = None
        self._since = self._clock = 0.0  # [s] start of this stage; time of the last cycle
        self._limited = False  # whether goals were limited in the last cycle

    @property
    def done(self) -> bool:
        """Whether no port is open, as before `open` and after the end."""
        return self._axes is None

    def open(self) -> None:
        """Open the ports, check the servos and configure them, without torque."""
        self._advance("open")
        self._write_status()

    def step(self) -> None:
        """Run one control period: bus cycle, reactions and status."""
        axes = self._axes
        if axes is None:
            return
        now = axes.now()
        seconds = min(max(now - self._clock, MIN_STEP_TIME), 2 * self._settings.period)
        self._clock = now
        if change := self._host.note(now, excused=self._procedure is not None):
            self._note("host", change)
        self._requests.look()
        self._take_commands()
        self._move(seconds)
        self._caps.take(self._channel.caps(), self._monitor, self._steering)
        if self._procedure is None:
            self._caps.write(axes, self._monitor, seconds=seconds, braking=self._brakes)
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
        before = player.left > END_TOLERANCE
        taken = self._channel.commands(MAX_COMMANDS_PER_CYCLE if player.left < COMMAND_LOOKAHEAD else 0)
        for time, goals, leads in taken:
            if not player.take(time, goals, leads):
                self._note("dropped", f"a command for {time:.3f} s came too late or is not finite")
        fresh = player.performances != performances
        stage, left = self.state.stage, player.left > END_TOLERANCE
        self._interruptions.note_commands(self._clock, stage=stage, before=before, left=left, fresh=fresh)

    def sleep(self, until: float) -> None:
        """Wait until a time [s] of the wires' clock."""
        if self._axes is not None:
            self._axes.sleep(until)

    def now(self) -> float:
        """Return the wires' clock [s], or the monotonic clock without open ports."""
        return self._axes.now() if self._axes is not None else monotonic()

    def _look(self, axes: Axes, goals: Ticks | None, seconds: float) -> None:
        self._last = axes.cycle(goals)
        self._monitor.look(self._last, self._steering.goals, seconds)
        for name, event in self._last.events:
            self._note(event.kind, f"{name}: {event.text}", -1 if event.servo is None else event.servo)

    def _move(self, seconds: float) -> None:
        stage, monitor = self.state.stage, self._monitor
        target = min(monitor.scale, self._host.pace) if stage is Stage.ACTIVE else float(stage in MOVING_STAGES)
        hurry = self._requests.alone or stage in (Stage.STOPPED, Stage.LOST)
        slow = self._settings.quick if hurry and not target else self._settings.slow
        self._brakes = hurry and not target and not self._steering.player.still
        if stage is Stage.ACTIVE and self._requests.pace < target:
            target, slow = self._requests.pace, self._settings.wary
        refused = self._steering.move(seconds, monitor.present, target=target, slow=slow) & monitor.energised
        if refused.any() and not self._limited:
            names = ", ".join(sorted({self.manifest.members[k].hinge for k in np.flatnonzero(refused)}))
            self._note("limited", f"goals of {names} exceed their limits")
        self._limited = bool(refused.any())

    def _goals(self) -> Ticks | None:
        limp = ~self._monitor.energised
        if self._procedure is not None:
            limp[self._members] = False  # the procedure sets their goals
        self._steering.follow_without_torque(limp, self._monitor.present)
        return self._steering.ticks()

    @property
    def _watchdog(self) -> int:
        """Value of BUS_WATCHDOG for servos with torque."""
        return min(self._host.watchdog_factor * self._least_watchdog, Register.BUS_WATCHDOG.field.upper)

    def _observe(self) -> Observation:
        player, monitor, requests, stage = self._steering.player, self._monitor, self._requests, self.state.stage
        settings, elapsed = self._settings, self._clock - self._since
        patience = settings.consent if self.state.paused else settings.patience
        waits = (stage is Stage.HOLD or not monitor.answering) and not self.state.stopped
        has_waited = waits and elapsed > patience
        enough = END_TOLERANCE if stage in MOVING_STAGES or requests.ended else settings.lead - END_TOLERANCE
        return Observation(
            energised=monitor.any_energised,
            answering=monitor.answering,
            well=monitor.well and self._procedure is None,
            limp=monitor.any_limp,
            begun=player.begun,
            due=not requests.alone and player.left > enough,
            ended=requests.alone or (requests.ended and (player.left <= END_TOLERANCE or has_waited)),
            alone=requests.alone,
            release=requests.release,
            weak=monitor.weak,
            raised=bool(monitor.raised.any()),
            confirmed=requests.confirmed,
            interrupted=self._interruptions.interrupted,
            still=player.still,
            reached=player.reached and self._steering.arrived,
            idle=stage is Stage.HOLD and elapsed > settings.patience,
            hopeless=stage is Stage.LOST and self._interruptions.fault_duration > settings.hopeless,
            policy=requests.policy(settings.policy),
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
        """Pass an event to the state machine, and begin its actions."""
        before = self.state
        if event == "resumed":
            self._interruptions.note_resume()
        self.state, actions = step(self.state, event, self._observe())
        if self.state.stage is not before.stage:
            self._since = self._clock
            self._note("stage", f"{before.stage.value} -> {self.state.stage.value} ({event})")
        if self.state.paused and not before.paused and event != "estop" and not self.state.faulty:
            cause = self._interruptions.describe(self._monitor.trouble())
            self._note("paused", f"{cause}; the performance waits for confirmation")
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

    def _try(self, operation: Callable[[], None]) -> None:
        """Run a slow operation while nothing moves, and report its outcome."""
        try:
            operation()
        except BusError as error:
            for line in str(error).splitlines():
                self._note("refused", line)
            self._advance("refused")
        else:
            self._advance("done")

    def _check(self) -> None:
        period = WIRE_TIME_FRACTION * self._settings.period
        axes, self._tables = take_over(self.manifest, self._context.opens, period=period)
        self._axes, self._monitor = axes, CommunicationMonitor(self.manifest, self._tables)
        self._context.announce()
        for _ in range(CHECK_CYCLES):
            self._look(axes, None, self._settings.period)
            if self._monitor.answering:
                return
        silent = [axes.label(k) for k in np.flatnonzero(~self._monitor.answered).tolist()]
        raise BusError(explain_rare_answers(self.manifest, silent, period=self._settings.period))

    def _configure(self) -> None:
        if self._axes is not None:
            for change in configure(self._axes, self._tables):
                self._note("configured", f"{change.register.name}: {change.before} -> {change.after}", change.servo)
            self._tables = read_manifest_tables(self._axes)
            self._caps = CapWriter(self.manifest, self._tables)
            self._clock = self._axes.now()

    def _begin(self, action: Action) -> None:
        axes, last = self._axes, self._last
        if axes is None or last is None:
            return
        self._steering.hold()
        self._caps.forget()
        self._members = list(axes.all_places)
        if action == "arm":
            self._members = np.flatnonzero(self._monitor.limp).tolist()
            self._steering.take_back(self._members)
            steps = round(POWER_RAMP_TIME / self._settings.period)
            self._procedure = energise(
                axes, self._members, last, self._caps.power, watchdog=self._watchdog, steps=steps
            )
        elif action == "identify":
            self._procedure = identify(axes, self._tables, watchdog=self._watchdog)
        elif action == "adopt":
            earlier = self._steering.goals
            if earlier is None:
                earlier = np.array([table[Register.GOAL_POSITION] for table in self._tables], dtype=np.float64)
            self._procedure = adopt(axes, last, earlier, self._caps.power, watchdog=self._watchdog)
        else:
            self._procedure = release_torque(axes, tries=round(self._settings.hopeless / self._settings.period))
        self._proceed(first=True)

    def _proceed(self, *, first: bool = False) -> None:
        """Advance the running torque procedure with the records of the last cycle."""
        procedure = self._procedure
        if procedure is None or self._last is None:
            return
        try:
            goals = next(procedure) if first else procedure.send(self._last)
            if goals is not None:
                self._steering.put(self._members, goals)
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
