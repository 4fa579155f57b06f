"""Declarations of all verbs with their arguments and options.

The module that implements a verb is imported when the verb runs.
"""

from pathlib import Path

import click

from kinesic.bench import BENCH_PARTS
from kinesic.body.config import names_of
from kinesic.cli.completion import DOCUMENT_NAME, ROBOT_NAME, SHELL_NAMES, STYLE_NAME
from kinesic.cli.effects import effect_options, view_options
from kinesic.cli.film_options import film_options
from kinesic.cli.help_pages import VerbGroup
from kinesic.cli.many.workers import worker_options
from kinesic.cli.option_values import MetricsOutput, SpokenInput
from kinesic.cli.options import (
    FORCE_HELP,
    STYLE_HELP,
    expression_options,
    force_option,
    group_options,
    implemented_by,
    output_options,
    performer_options,
    picture_options,
    planning_options,
    robot_option,
    twin_options,
)
from kinesic.sim.fitting.parameters import DEFAULT_PARAMETERS, FIT_PARAMETERS
from kinesic.sim.log import LOG_FORMAT

ON_HELP = (
    "Sinks that perform, separated by commas: twin (always first), servos, face (a window, if there is a display). "
    "Space stops the servos, Ctrl-C folds them to rest."
)
AUDIO_HELP = "WAV recording of TEXT, or of speech without a text."
MAP_HELP = "Hinge of a joint of FILE, or none to hold the joint. Repeatable."
WORDS_HELP = (
    "Times of the words in --audio: Whisper, ElevenLabs, Polly or Azure JSON, TextGrid, EAF, SRT or VTT "
    "(default: found by their sound)."
)
FREE_HELP = "Servo parameters to fit; all others are those of the data sheets. mass only without stall. Repeatable."

report_options = output_options(
    "Folder of the report (default: out/NAME-TIME), or scene.glb to write the performance as glTF, with scene.wav.",
    FORCE_HELP,
    "Print the report as JSON.",
    film_options,
)


def _show_version(context: click.Context, _option: click.Parameter, is_requested: bool) -> None:
    """Print the version and exit, if --version is given."""
    if is_requested and not context.resilient_parsing:
        from kinesic.version import __version__  # noqa: PLC0415 - the package metadata is slow to import

        click.echo(f"{context.find_root().info_name}, version {__version__}")
        context.exit()


@click.group(cls=VerbGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_show_version,
    help="Show the version and exit.",
)
def kinesic() -> None:
    """Perform BML (Behavior Markup Language) on humanoids with servos."""


@kinesic.command("bench")
@click.argument("part", type=click.Choice([*BENCH_PARTS, "all"]))
@click.option("--matrix", is_flag=True, help="For bus: run the whole fault matrix with every driver instead.")
@click.option(
    "--style",
    "styles",
    multiple=True,
    type=click.Choice(names_of("style")),
    help="For naturalness: measure gestures of this style only. Repeatable.",
)
@click.option(
    "--capture",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    help="For naturalness: measure a folder of captured gestures (.skm with .sk, .bvh).",
)
@group_options(
    "output",
    MetricsOutput,
    click.option("--json", "as_json", is_flag=True, help="Print a list of metrics as JSON."),
    click.option(
        "--plots", type=click.Path(file_okay=False, path_type=Path), help="Also write plots into this folder."
    ),
    click.option("--out", type=click.Path(path_type=Path), help="Folder of the metrics, for `kinesic results`."),
    click.option("--force", is_flag=True, help="Replace existing plots, or a folder made by kinesic."),
)
@worker_options
@implemented_by("bench:print_metrics")
def _bench() -> None:
    """Run the benchmarks of PART.

    Timings are medians in a warm process.
    """


@kinesic.command("completion")
@click.argument("shell", type=click.Choice(SHELL_NAMES))
@implemented_by("completion_script:print_script")
def _complete() -> None:
    """Print the script with which SHELL completes verbs and names.

    Styles, robots, gestures and built-in documents are completed. For bash, append the script to ~/.bashrc; for zsh, to
    ~/.zshrc after compinit; for fish, write it to ~/.config/fish/completions/kinesic.fish. Then open a new terminal.
    """


@kinesic.command("demo")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder of the report (default: out/demo, which is replaced)."
)
@click.option("--robot", type=ROBOT_NAME, default="upper36", show_default=True, help="Name or TOML file of the robot.")
@click.option("--style", type=STYLE_NAME, default="neutral", show_default=True, help=STYLE_HELP)
@click.option("--film/--no-film", default=True, help="Film the twin and the face, if OpenGL works.")
@click.option("--open/--no-open", "browser", default=True, help="Open the page in the browser, if there is a desktop.")
@click.option("--force", is_flag=True, help=FORCE_HELP)
@implemented_by("demo:perform_demo")
def _demo() -> None:
    """Perform the built-in greeting in the twin and open its report.

    It needs no file and no robot. `kinesic perform welcome` performs the same document with all options.
    """


@kinesic.command("doctor")
@implemented_by("doctor:examine_machine")
def _doctor() -> None:
    """Show which optional parts work, and how to install the others."""


@kinesic.command("face")
@expression_options
@click.option(
    "--bml", type=DOCUMENT_NAME, metavar="FILE", help="BML document whose face is performed; - for standard input."
)
@picture_options
@view_options
@effect_options
@click.option(
    "--sheet", is_flag=True, help="Draw every action unit at low and high intensity, with and without wrinkles."
)
@planning_options
@implemented_by("face:draw_face")
def _face() -> None:
    """Draw the face to a picture, film or window.

    Without --out a window opens, if there is a display.
    """


@kinesic.command("perform")
@click.argument("file", type=DOCUMENT_NAME)
@planning_options
@performer_options(ON_HELP)
@twin_options
@report_options
@implemented_by("several_robots:perform_document")
def _perform() -> None:
    """Perform FILE (BML, FML, motion or -) and write a report.

    FILE may be the name of a built-in document: night, story or welcome. FILE - is BML on standard input. With servos,
    FILE is first performed in the twin, and on the servos only if no check failed. With --robot A,B several robots
    perform FILE, and are filmed side by side. A text of more than 4000 words is performed in parts, with a report each.
    """


@kinesic.command("plan")
@click.argument("file", type=DOCUMENT_NAME)
@planning_options
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="motion.npz, .csv, .bvh, .bap, .json or .mcap (ROS), or scene.glb with scene.wav (default: print a timeline).",
)
@force_option
@click.option(
    "--to",
    type=click.Choice(["motion", "bml"]),
    default="motion",
    help="bml: print the BML generated from FML or a text.",
)
@click.option(
    "--optimal", is_flag=True, help="Find the key times of least shift with IPOPT; this takes seconds to minutes."
)
@implemented_by("plan:plan_file")
def _plan() -> None:
    """Plan FILE (BML, FML, motion or -) and write the motion.

    FILE may be the name of a built-in document, such as welcome. FILE - is BML on standard input. Without --out, print
    the timeline of the plan and its deviations from FILE.
    """


@kinesic.group()
def robots() -> None:
    """List, show, check, import and search robots."""


@robots.command("list")
@implemented_by("robots:list_robots")
def _list_robots() -> None:
    """List the robots that come with kinesic."""


@robots.command("show")
@click.argument("robot", type=ROBOT_NAME, default="upper22")
@implemented_by("robots:show_robot")
def _show_robot() -> None:
    """Show range, servo and limits of every hinge of ROBOT."""


@robots.command("check")
@click.argument("robot", type=ROBOT_NAME, default="upper22")
@implemented_by("robots:assess_robot")
def _assess_robot() -> None:
    """Compute static torque ratios, workspace and clearance of ROBOT."""


@robots.command("import")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--out", type=click.Path(path_type=Path), help="TOML file of the robot (default: FILE's name, in this folder)."
)
@click.option("--map", "wished", multiple=True, metavar="JOINT=HINGE", help=MAP_HELP)
@force_option
@implemented_by("robots:import_robot")
def _import_robot() -> None:
    """Convert an MJCF, URDF or xacro robot to a robot file.

    The picture NAME.mapping.png shows the robot from the front with the names of its joints (extra plots). --map
    corrects the hinge of a joint, and of its partner on the other side, such as --map left_yaw=l_elbow_twisting.
    """


@kinesic.command("new")
@click.argument("kind", type=click.Choice(["gesture", "style", "robot"]))
@click.argument("name")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=".",
    help="TOML file, or folder of NAME.toml (default: this folder).",
)
@force_option
@implemented_by("new:write_new")
def _new() -> None:
    """Write NAME.toml: a commented gesture, style or robot to edit."""


@kinesic.command("say")
@group_options(
    "spoken",
    SpokenInput,
    click.argument("text", required=False),
    click.option("--audio", metavar="WAV", type=click.Path(path_type=Path), help=AUDIO_HELP),
    click.option("--words", metavar="FILE", type=click.Path(path_type=Path), help=WORDS_HELP),
)
@planning_options
@performer_options(ON_HELP)
@twin_options
@report_options
@click.option("--to", type=click.Choice(["performance", "bml"]), default="performance", help="bml: only print the BML.")
@implemented_by("perform:say_text")
def _say() -> None:
    """Say TEXT with matching gestures, head, face and gaze.

    The BML states a reason for each behaviour. If TEXT is -, standard input is spoken phrase by phrase as it arrives,
    without a report. With --audio, a recording is played in place of the voice, and lips, gestures and accents follow
    it: TEXT is that of --words by default. Without any text, gestures are beats on the accents.
    """


@kinesic.group()
def twin() -> None:
    """Fit the twin to a robot."""


@twin.command(
    "fit",
    epilog=f"LOG is an {LOG_FORMAT}. `kinesic perform` writes the twin's log, measured.npz, into its report folder. "
    "Fast, wide motion of every hinge is most informative; 5 to 20 s are enough.",
)
@click.argument("log", type=click.Path(path_type=Path))
@robot_option
@click.option(
    "--free",
    multiple=True,
    type=click.Choice(FIT_PARAMETERS),
    default=DEFAULT_PARAMETERS,
    show_default=True,
    help=FREE_HELP,
)
@click.option("--out", type=click.Path(path_type=Path), help="TOML file of the factors, for --twin.")
@force_option
@click.option("--json", "as_json", is_flag=True, help="Print the estimates as JSON.")
@implemented_by("twin:fit_twin")
def _fit_twin() -> None:
    """Fit servo parameters of the twin to LOG, and list undetermined ones."""
