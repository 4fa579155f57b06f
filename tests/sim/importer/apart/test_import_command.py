"""Start of the import process and handling of its result."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.apart import answer, import_process, imported
from kinesic.sim.importer.apart.answer import answer_import
from kinesic.sim.importer.apart.imported import Answer, Bounds, ImportedRobot, Refusal, import_apart
from kinesic.sim.importer.convert import Mapped

IMPORTED_ROBOT = ImportedRobot(
    "text", (("l_elbow", "left", "0..90", "0"),), b"shell", 1.0, ("legs",), ("mesh.stl",), ""
)


@pytest.fixture
def fake_process(monkeypatch):
    """Replace the import process by a result and record its arguments."""
    begun: dict = {}

    def by(code: int = 0, output: bytes = b"", errors: bytes = b"") -> dict:
        def run(command, **named):
            begun.update(named, command=command, is_empty=os.listdir(named["cwd"]) == [])
            return subprocess.CompletedProcess(command, code, output, errors)

        monkeypatch.setattr(subprocess, "run", run)
        return begun

    return by


def refused(path: Path) -> str:
    with pytest.raises(ConfigError) as caught:
        import_apart(path)
    return str(caught.value)


def test_import_process_has_limits_and_a_temporary_empty_folder(fake_process, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OMP_NUM_THREADS", "64")
    monkeypatch.setattr(sys, "path", ["", "/somewhere"])
    begun = fake_process(output=msgspec.msgpack.encode(IMPORTED_ROBOT))
    assert import_apart(Path("robot.xml"), bounds=Bounds(duration=7.0, cpu_time=3, memory=1000)) == IMPORTED_ROBOT
    module = "kinesic.sim.importer.apart.import_process"
    assert begun["command"] == [sys.executable, "-P", "-m", module, str(tmp_path / "robot.xml"), "1000", "3"]
    assert begun["timeout"] == 7.0
    assert begun["is_empty"]
    assert not Path(begun["cwd"]).exists()
    assert (begun["stdin"], begun["capture_output"], begun["start_new_session"], begun["check"]) == (
        subprocess.DEVNULL,
        True,
        True,
        False,
    )
    environment = begun["env"]
    assert {environment[name] for name in imported.THREAD_VARIABLES} == {"1"}
    assert environment["PYTHONPATH"] == f"{tmp_path}{os.pathsep}/somewhere"
    assert environment["PATH"] == os.environ["PATH"]


def test_import_process_may_take_300_s_2_gb_and_120_cpu_seconds_by_default(fake_process):
    begun = fake_process(output=msgspec.msgpack.encode(IMPORTED_ROBOT))
    import_apart(Path("robot.xml"))
    assert (begun["timeout"], begun["command"][-2:]) == (300.0, ["2000000000", "120"])


def test_refusal_by_the_import_process_names_the_file_by_the_path_that_the_user_gave(
    fake_process, tmp_path: Path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    fake_process(output=msgspec.msgpack.encode(Refusal(f"{tmp_path / 'robot.xml'}:3: is no robot")))
    assert refused(Path("robot.xml")) == "robot.xml:3: is no robot"


@pytest.mark.parametrize(
    ("code", "errors", "said"),
    [
        (-24, b"", "signal SIGXCPU: it takes more processor time than any robot needs"),
        (-11, b"Trace\n", "signal 11: it takes too much memory, or MuJoCo fails"),
        (1, b"Trace\nKeyError: x\n\n", "an internal error of kinesic, please report it with the file: KeyError: x"),
        (3, b" \n", "an internal error of kinesic, please report it with the file: exit code 3"),
        (1, b"\xff", "an internal error of kinesic, please report it with the file: \N{REPLACEMENT CHARACTER}"),
    ],
)
def test_failed_import_process_is_reported_in_one_line(fake_process, code: int, errors: bytes, said: str):
    fake_process(code, msgspec.msgpack.encode(IMPORTED_ROBOT), errors)
    result = refused(Path("robot.xml"))
    assert result.startswith(f"robot.xml: its import ended with {said}")
    assert "\n" not in result


@pytest.mark.parametrize("output", [b"", b"text", msgspec.msgpack.encode({"type": "Other"}), msgspec.msgpack.encode(3)])
def test_unreadable_import_answer_is_rejected(fake_process, output: bytes):
    fake_process(0, output)
    assert refused(Path("robot.xml")).startswith("robot.xml: its import returned an unreadable answer: ")


def test_import_process_limits_its_memory_cpu_time_and_core_dumps(monkeypatch):
    """A limit that cannot be set does not affect the others."""
    set_bounds = {}

    def setrlimit(kind: int, bounds: tuple[int, int]) -> None:
        set_bounds[kind] = bounds
        raise ValueError("a lower bound is set already")

    monkeypatch.setattr(resource, "setrlimit", setrlimit)
    import_process.bound_process(memory=1000, cpu_time=7)
    assert set_bounds == {
        resource.RLIMIT_DATA: (1000, 1000),
        resource.RLIMIT_CPU: (7, 12),
        resource.RLIMIT_CORE: (0, 0),
    }


def answered(path: Path) -> Answer:
    return msgspec.msgpack.decode(answer_import(path), type=Answer)


def test_import_answer_contains_robot_text_and_hinge_mapping(hanging_path: Path, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = answered(hanging_path)
    assert isinstance(result, ImportedRobot)
    assert result.text.startswith("# ")
    assert f"Mapped from {hanging_path.name} by `kinesic robots import`; confidence " in result.text
    assert ("REVIEW before it moves" in result.text) is bool(result.doubt)
    elbow = next(row for row in result.mapping if row[1] == "left_elbow_joint")
    assert elbow[0].startswith("l_")
    assert elbow[2] == "0..126"
    assert all(row[3] != "-0" for row in result.mapping)
    assert any("assumed" in row[2] for row in result.mapping)
    assert list(tmp_path.iterdir()) == []


def test_import_process_answers_an_invalid_file_with_a_refusal(tmp_path: Path, monkeypatch):
    (tmp_path / "broken.xml").write_text("<mujoco>")
    result = answered(tmp_path / "broken.xml")
    assert isinstance(result, Refusal)
    assert result.reason.startswith(f"{tmp_path / 'broken.xml'}: not a readable MJCF or URDF")

    def fail(path: Path, wishes: object) -> None:
        raise MemoryError

    monkeypatch.setattr(answer, "import_humanoid", fail)
    assert answered(tmp_path / "large.xml") == Refusal(
        f"{tmp_path / 'large.xml'}: its import takes more memory than any robot needs; simplify its meshes"
    )


def test_timeout_of_an_import_names_its_duration(monkeypatch):
    def wait(command, *, timeout, **named):
        raise subprocess.TimeoutExpired(command, timeout)

    monkeypatch.setattr(subprocess, "run", wait)
    assert refused(Path("robot.xml")) == "robot.xml: its import takes longer than 300 s; simplify its meshes"


def test_heading_of_a_doubtful_import_begins_with_a_review_note(hanging_mapped: Mapped):
    result = hanging_mapped
    sure, doubted = (
        answer._write_heading(result, "a.xml", ""),
        answer._write_heading(result, "a.xml", "its sides may be wrong"),
    )
    assert doubted[:2] == ["REVIEW before it moves: its sides may be wrong.", ""]
    assert doubted[2:] == sure
    said = answer._describe_doubt(result)
    assert said.startswith(f"confidence {result.confidence:.2f} is below {answer.REVIEW_CONFIDENCE:g}, so ")


def test_hinge_mapping_of_an_import_lists_the_rest_angles_of_the_robot_file(hanging_mapped: Mapped):
    rests, file = {row[0]: row[3] for row in answer._list_mapping(hanging_mapped)}, hanging_mapped.file
    assert rests == {hinge.name: f"{file.rest.get(hinge.name, 0.0) + 0.0:.0f}" for hinge in hanging_mapped.hinges}
    assert "0" in rests.values()


def test_import_answer_contains_a_shell_if_the_robot_has_meshes(
    hanging_path: Path, hanging_mapped: Mapped, tmp_path: Path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(answer, "import_humanoid", lambda path, wishes: hanging_mapped)  # an import takes half a second
    assert answered(hanging_path).shell == b""
    monkeypatch.setattr(answer, "build_imported_shell", lambda found, robot: f"shell of {robot.name}")
    monkeypatch.setattr(answer, "write_shell", lambda shell, path: path.write_text(shell))
    assert answered(hanging_path).shell.startswith(b"shell of ")


def test_import_process_prints_only_its_answer_to_standard_output(monkeypatch):
    """Output of libraries goes to standard error."""

    def noisy(path: Path, wished: tuple[str, ...]) -> bytes:
        os.write(1, b"noise of a library")
        return f"answer for {path} with {' '.join(wished)}".encode()

    monkeypatch.setattr(answer, "answer_import", noisy)
    bound = "%d %d;"
    monkeypatch.setattr(
        import_process, "bound_process", lambda *, memory, cpu_time: os.write(2, (bound % (memory, cpu_time)).encode())
    )
    (output, out), (errors, err) = os.pipe(), os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.dup2(out, 1)
            os.dup2(err, 2)
            import_process.main("robot.xml", "1000", "7", "neck=none")
            os._exit(0)
        finally:
            os._exit(1)  # an exception must not run the test session in the child
    os.close(out)
    os.close(err)
    with os.fdopen(output, "rb") as stream, os.fdopen(errors, "rb") as others:
        assert stream.read() == b"answer for robot.xml with neck=none"
        assert others.read() == b"1000 7;noise of a library"
    assert os.waitpid(child, 0)[1] == 0


@pytest.mark.parametrize("text", ["", None])
def test_robot_file_whose_name_is_not_utf8_is_imported_or_refused_by_a_readable_name(
    hanging_path: Path, tmp_path: Path, monkeypatch, text: str | None
):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / f"b\udcff{hanging_path.suffix}"
    try:
        path.write_text(hanging_path.read_text() if text is None else text)
    except OSError as error:
        pytest.skip(f"this file system refuses the name: {error}")
    result = answered(path)
    if text is None:
        assert isinstance(result, ImportedRobot)
        assert rf'from = "b\\udcff{path.suffix}"' in result.text
    else:
        assert isinstance(result, Refusal)
        assert rf"b\udcff{path.suffix}" in result.reason
