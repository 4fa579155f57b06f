"""Scripts that build wheels and try them on another processor."""

import sys
from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def find_scripts(monkeypatch):
    """Put the folder with the release scripts on the search path of modules."""
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parent.parent / "release"))


def test_building_wheels_requires_python_3_11_and_a_later_version(monkeypatch):
    import wheels  # noqa: PLC0415 - no part of the package

    versions = {"a": (3, 10), "b": (3, 13), "c": (3, 11), "d": (3, 12), "e": None}
    monkeypatch.setattr(wheels, "read_version", versions.get)
    assert [interpreter.path for interpreter in wheels.choose_interpreters([*versions])] == ["c", "d"]
    with pytest.raises(SystemExit, match=r"a later version .* found: c \(3.11\)"):
        wheels.choose_interpreters(["c", "e"])


def test_python_interpreter_without_headers_is_not_used_for_wheels(tmp_path):
    import wheels  # noqa: PLC0415 - no part of the package

    liar = tmp_path / "python"
    liar.write_text("#!/bin/sh\necho 3 11\necho False\n")
    liar.chmod(0o755)
    assert wheels.read_version(str(liar)) is None
    assert wheels.read_version(sys.executable) in (sys.version_info[:2], None)  # Debian has headers apart


def test_wheel_with_a_plain_linux_tag_is_refused():
    import wheels  # noqa: PLC0415 - no part of the package

    shown = 'x.whl is consistent with the\nfollowing platform tag: "manylinux_2_28_aarch64".\n'
    assert wheels.read_platform(shown) == (28, "aarch64")
    with pytest.raises(SystemExit, match="does not allow"):
        wheels.read_platform(shown.replace("manylinux_2_28", "linux"))


def test_difference_of_smoke_test_results_is_their_largest_numeric_difference():
    import smoke  # noqa: PLC0415 - no part of the package

    one = {"plan": {"postures": [[0.0, 1.0], [2.0, 3.0]]}, "ping": "ff"}
    other = {"plan": {"postures": [[0.0, 1.0], [2.0, 3.5]]}, "ping": "ff"}
    assert smoke.difference(one, one) == 0.0
    assert smoke.difference(one, other) == 0.5
    assert smoke.difference(one, other | {"ping": "fe"}) == float("inf")
    assert smoke.difference(one, {"plan": one["plan"]}) == float("inf")
    assert smoke.difference([1.0], [float("nan")]) == float("inf")


def test_timing_of_the_first_report_after_installation_lists_steps_sum_and_sizes(tmp_path):
    import first_report  # noqa: PLC0415 - no part of the package

    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "file").write_bytes(b"x" * 1000)
    (tmp_path / "link").symlink_to(tmp_path / "in" / "file")
    assert first_report.size_of(tmp_path) == 1000
    steps = [first_report.Step("download", 20.0, 4.0), first_report.Step("kinesic demo", 12.5, 9.25)]
    assert first_report.describe(steps, installed=441_000_000, downloaded=127_000_000).splitlines()[1:] == [
        "download          20.0 s     4.0 s",
        "kinesic demo      12.5 s     9.2 s",
        "all               32.5 s    13.2 s",
        "installed 441 MB, downloaded 127 MB",
    ]


def test_first_report_timing_measures_commands_and_shows_the_output_of_a_failed_command(tmp_path, monkeypatch):
    import first_report  # noqa: PLC0415 - no part of the package

    monkeypatch.setenv("KINESIC_SEED", "7")
    code = "import os, sys; open('settings', 'w').write(str([k for k in os.environ if k.startswith('KINESIC_')]))"
    step = first_report.run("one", [sys.executable, "-c", code], tmp_path)
    assert (tmp_path / "settings").read_text() == "[]"
    assert 0.0 < step.processor < 10.0
    with pytest.raises(SystemExit, match=r"(?s)two failed:.*ZeroDivisionError"):
        first_report.run("two", [sys.executable, "-c", "1/0"], tmp_path)
