"""A performance that knows its verdicts and writes its report."""

from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.command import State
from kinesic.body.config import ConfigError
from kinesic.controller.performance import MeasuredMotion
from kinesic.controller.performance import Performance as DryRun
from kinesic.controller.servo_performance import ServoRun
from kinesic.files.output_file import new_file
from kinesic.files.output_folder import MARKER, check_folder
from kinesic.planning.motion_files import replace_motion
from kinesic.planning.syncs import Syncs, SyncTime
from kinesic.report.checks import Check, checks, grade
from kinesic.report.report import Json, report
from kinesic.report.servo_report import live_checks, live_log, with_live
from kinesic.report.verdict import verdict
from kinesic.sim.log import write_log

if TYPE_CHECKING:
    from kinesic.report.output import WrittenPaths

LOG = "servos.npz"
FILES = (
    MARKER,
    "report.json",
    "report.html",
    "measured.npz",
    "film.webp",
    "film.mp4",
    "face.webp",
    "speech.wav",
    LOG,
    "learned.toml",
)  # of a report


@dataclass(frozen=True)
class PerformedSync(SyncTime):
    """One sync point: when it was asked for, when it was planned, and when it was met."""

    performed: float | None  # [s] block time; None: never


@dataclass(frozen=True, eq=False, repr=False)
class Performance(DryRun):
    """One plan as it was performed: in the twin, and on the servos where these were asked for."""

    seed: int = 0
    beside: tuple[DryRun, ...] = ()  # the same plan in other twins
    servos: ServoRun | None = None

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """The verdicts on the twin's performance, and on that of the servos where they performed."""
        return (*checks(self), *(live_checks(self.servos) if self.servos is not None else ()))

    @property
    def ok(self) -> bool:
        """Whether no check has failed."""
        return grade(self.checks) != "fail"

    @cached_property
    def data(self) -> Mapping[str, Json]:
        """What `report.json` holds."""
        found = report(self, source=self.plan.timeline.block.source, seed=self.seed, beside=self.beside)
        return with_live(found, self.servos) if self.servos is not None else found

    @cached_property
    def syncs(self) -> Syncs[PerformedSync]:
        """Sync points with the times at which they were met; `syncs["nod:stroke"].performed`."""
        lags = self.lags if self.servos is None else self.servos.lags
        rows = ((sync, lags.get(sync, 0.0)) for sync in self.plan.syncs)
        return Syncs(
            PerformedSync(
                sync.behaviour, sync.sync, sync.asked, sync.planned, None if lag is None else sync.planned + lag
            )
            for sync, lag in rows
        )

    @cached_property
    def motion(self) -> MeasuredMotion:
        """What was measured: by the servos where they moved, else in the twin."""
        live = self.servos
        if live is not None and len(live.times) > 1:
            return MeasuredMotion(live.times, live.followed, sealed(np.gradient(live.followed, live.times, axis=0)))
        return MeasuredMotion(self.measured.times, self.measured.angles, self.measured.speeds)

    def at(self, when: float | str) -> State:
        """What was measured at a performance time [s], or when a sync point such as `nod:stroke` was met.

        Raises:
            KeyError: there is no such sync point, or it was never met.
        """
        if isinstance(when, str):
            met = self.syncs[when].performed
            if met is None:
                raise KeyError(f"{when} was never met")
            when = self.plan.trajectory.zero + met
        return State(*(sealed(row[0]) for row in self.motion.sample(np.array([when]))))

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Writes what was measured; the suffix names the format: .npz, .csv or .bap.

        Args:
            path: of the file; a motion that was saved there before is replaced.
            force: whether any other ordinary file may be replaced, too.

        Raises:
            ConfigError: the suffix is not known, or the path is a folder's, a link's or, unless forced, another file's.
        """
        return replace_motion(self.motion, self.plan.setup.robot, Path(path), force=force)

    def report(self, folder: str | Path, *, film: bool = True) -> "WrittenPaths":
        """Writes report.html, report.json and what belongs to them; an earlier report in the folder is replaced.

        Args:
            folder: of the report alone.
            film: whether twin and face are filmed, where OpenGL works.

        Raises:
            ConfigError: something else is in the folder.
        """
        place = Path(folder)
        _check_free(place)
        from kinesic.report.films import film_processes  # noqa: PLC0415 - slow to import, and not every run is reported
        from kinesic.report.output import add_films, write_report  # noqa: PLC0415 - as above

        with film_processes() if film else nullcontext() as processes:
            written = write_report(self, dict(self.data), place, film=film, force=True)
            if processes is not None:
                written = add_films(written, self, dict(self.data), processes)
        if self.servos is not None:
            with new_file(place / LOG, force=True) as fresh:
                write_log(live_log(self.servos), self.plan.setup.robot, fresh)
        return written

    def __str__(self) -> str:
        """The verdict in one line."""
        return verdict(self.data)

    def __repr__(self) -> str:
        return f"<performance of {self.plan} in the {self.twin_name} twin{' and on servos' if self.servos else ''}>"


def performance_of(
    run: DryRun, *, seed: int, beside: tuple[DryRun, ...] = (), servos: ServoRun | None = None
) -> Performance:
    """Makes a performance of a dry run, with its verdicts, and with what the servos did."""
    same = {field.name: getattr(run, field.name) for field in fields(DryRun)}
    return Performance(**same, seed=seed, beside=beside, servos=servos)


def _check_free(folder: Path) -> None:
    strangers = sorted(file.name for file in folder.iterdir() if file.name not in FILES) if folder.is_dir() else []
    if strangers:
        raise ConfigError(f"{folder} holds {strangers[0]}, which no report has written; name another folder")
    check_folder(folder, force=True)
