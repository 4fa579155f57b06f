"""Performances with their checks and reports."""

from collections.abc import Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.command import State
from kinesic.body.config import ConfigError
from kinesic.body.html_view import NotebookView
from kinesic.files.held_folder import hold_folder
from kinesic.files.output_file import new_file
from kinesic.files.output_folder import MARKER_FILE, check_folder
from kinesic.metrics.dry_run import DryRun, MeasuredMotion
from kinesic.metrics.servo_run import ServoRun
from kinesic.planning.files.motion_files import replace_motion_file
from kinesic.planning.syncs import Syncs, SyncTime
from kinesic.report.checks import Check, checks, grade
from kinesic.report.report import Json, report
from kinesic.report.servo_report import live_checks, live_log, with_live
from kinesic.report.verdict import verdict
from kinesic.sim.log import write_log

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

    from kinesic.report.data_frames import FrameName
    from kinesic.report.output import WrittenPaths

SERVO_LOG_NAME = "servos.npz"  # file name of the log of a servo run
REPORT_FILES = (
    MARKER_FILE,
    "report.json",
    "report.html",
    "measured.npz",
    "film.webp",
    "film.mp4",
    "face.webp",
    "speech.wav",
    SERVO_LOG_NAME,
    "learned.toml",
)  # all files of a report


@dataclass(frozen=True)
class PerformedSync(SyncTime):
    """A sync point with its requested, planned and performed time."""

    performed: float | None  # [s] block time; None: never


@dataclass(frozen=True, eq=False, repr=False)
class Performance(DryRun, NotebookView):
    """A plan performed in the twin and, optionally, on servos."""

    seed: int = 0
    other_runs: tuple[DryRun, ...] = ()  # the same plan in other twins
    servos: ServoRun | None = None

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the twin's performance, and of the servos' if they performed."""
        return (*checks(self), *(live_checks(self.servos) if self.servos is not None else ()))

    @property
    def ok(self) -> bool:
        """Whether no check failed."""
        return grade(self.checks) != "fail"

    @cached_property
    def data(self) -> Mapping[str, Json]:
        """Content of `report.json`."""
        content = report(self, source=self.plan.timeline.block.source, seed=self.seed, other_runs=self.other_runs)
        return with_live(content, self.servos) if self.servos is not None else content

    @cached_property
    def syncs(self) -> Syncs[PerformedSync]:
        """Sync points with performed times, accessed as `syncs["nod:stroke"].performed`."""
        lags = self.lags if self.servos is None else self.servos.lags
        rows = ((sync, lags.get(sync, 0.0)) for sync in self.plan.syncs)
        return Syncs(
            PerformedSync(
                sync.behaviour, sync.sync, sync.requested, sync.planned, None if lag is None else sync.planned + lag
            )
            for sync, lag in rows
        )

    @cached_property
    def motion(self) -> MeasuredMotion:
        """Measured motion: of the servos if they performed, otherwise the twin's."""
        live = self.servos
        if live is not None and len(live.times) > 1:
            return MeasuredMotion(
                live.times, live.interpolated_angles, sealed(np.gradient(live.interpolated_angles, live.times, axis=0))
            )
        return MeasuredMotion(self.measured.times, self.measured.angles, self.measured.velocities)

    def at(self, when: float | str) -> State:
        """Return the measured state at a time [s] or a sync point.

        A sync point is given as `nod:stroke`; its performed time is used.

        Raises:
            KeyError: the sync point does not exist, or the body never arrived.
        """
        if isinstance(when, str):
            met = self.syncs[when].performed
            if met is None:
                raise KeyError(f"{when} was never met")
            when = self.plan.trajectory.zero + met
        return State(*(sealed(row[0]) for row in self.motion.sample(np.array([when]))))

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the measured motion to a file, such as .npz or .csv.

        Args:
            path: path of the file; a motion saved there before is replaced.
            force: whether to replace any other ordinary file.

        Raises:
            ConfigError: the suffix is unknown, or the path is a folder, a link or, unless forced, another file.
        """
        return replace_motion_file(self.motion, self.plan.setup.robot, Path(path), force=force)

    def report(self, folder: str | Path, *, film: bool = True) -> "WrittenPaths":
        """Write the report with optional films, replacing an earlier report.

        Args:
            folder: folder of the report alone.
            film: whether to film twin and face, if OpenGL works.

        Raises:
            ConfigError: the folder contains foreign files.
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
            with new_file(place / SERVO_LOG_NAME, force=True) as fresh:
                write_log(live_log(self.servos), self.plan.setup.robot, fresh)
        return written

    def to_dataframe(self, table: "FrameName" = "motion") -> "DataFrame":
        """Return a table of the performance as a pandas data frame.

        Args:
            table: "motion": rows every 10 ms, columns (quantity, hinge) such as `("measured", "r_elbow_flexion")`,
                angles in rad; "servos": readings of the servos; "syncs"; "behaviours"; "checks".

        Raises:
            ConfigError: pandas is missing, the table is unknown, or no servos performed.
        """
        from kinesic.report.data_frames import make_data_frame  # noqa: PLC0415 - pandas is slow to import

        return make_data_frame(self, table)

    def plot(self, hinges: Sequence[str] | None = None) -> tuple["Axes", ...]:
        """Draw the timeline and the angles of hinges with matplotlib.

        Args:
            hinges: names of the hinges; None: those with the largest range of motion.

        Returns:
            The axes of the timeline, then one for each hinge.

        Raises:
            ConfigError: matplotlib is missing, or the robot has no such hinge.
        """
        from kinesic.report.joint_plot import draw_joint_plot  # noqa: PLC0415 - matplotlib is slow to import

        return draw_joint_plot(self, hinges)

    def __str__(self) -> str:
        """Return the verdict in one line."""
        return verdict(self.data)

    def __repr__(self) -> str:
        return f"<performance of {self.plan} in the {self.twin_name} twin{' and on servos' if self.servos else ''}>"


def performance_of(
    run: DryRun, *, seed: int, other_runs: tuple[DryRun, ...] = (), servos: ServoRun | None = None
) -> Performance:
    """Combine a dry run and an optional servo run into a performance."""
    same = {field.name: getattr(run, field.name) for field in fields(DryRun)}
    return Performance(**same, seed=seed, other_runs=other_runs, servos=servos)


def _check_free(folder: Path) -> None:
    foreign_files: list[str] = []
    with suppress(OSError), hold_folder(folder) as held:  # no folder, or a link, which `check_folder` refuses
        foreign_files = sorted(set(held.names()) - set(REPORT_FILES))
    if foreign_files:
        raise ConfigError(f"{folder} holds {foreign_files[0]}, which no report has written; name another folder")
    check_folder(folder, force=True)
