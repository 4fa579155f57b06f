import gc
import subprocess
import sys
from pathlib import Path

import pytest

from kinesic import importing
from kinesic.importing import import_at_once

PACKAGE = Path(importing.__file__).parent


@pytest.fixture
def watching(tmp_path, monkeypatch):
    (tmp_path / "watching.py").write_text("import gc\nWATCHED = gc.isenabled()\n")
    (tmp_path / "failing.py").write_text("import what_nobody_has\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield
    sys.modules.pop("watching", None)


def test_garbage_collection_is_disabled_during_an_import_and_enabled_afterwards(watching):
    assert import_at_once("watching").WATCHED is False
    assert gc.isenabled()


def test_garbage_collection_is_reenabled_after_a_failed_import(watching):
    with pytest.raises(ModuleNotFoundError, match="what_nobody_has"):
        import_at_once("failing")
    assert gc.isenabled()


def test_garbage_collection_disabled_before_an_import_stays_disabled(watching):
    gc.disable()
    try:
        import_at_once("watching")
        assert not gc.isenabled()
    finally:
        gc.enable()


BLOCK = '<bml id="b"><gesture id="g" lexeme="beat" stroke="1"/></bml>'


IMPORT_STAGES = {  # start -> (code, modules that must not be loaded after it), in the order of execution
    "tools of a model": (
        (
            "import kinesic.cli.live.mcp, kinesic.mcp.server",
            "scipy PIL kinesic.motion kinesic.bml.parse kinesic.expressivity.lexicon.lexicon kinesic.report",
        ),
    ),
    "command line": (
        ("import kinesic.cli.servos.simulate", "mujoco OpenGL kinesic.face.gl"),
        (
            f"import kinesic; kinesic.Performer(idle=0.0, variation=0.0).plan({BLOCK!r})",
            "scipy.interpolate scipy.optimize scipy.sparse casadi highspy urllib.request jinja2 PIL.Image",
        ),
        (
            "import kinesic.cli.live.serve",
            "scipy.interpolate scipy.optimize scipy.sparse highspy jinja2 PIL.Image kinesic.face.render.portrait",
        ),
        ("import kinesic.face.render.portrait", "scipy.sparse scipy.spatial scipy.optimize"),
    ),
}


@pytest.mark.parametrize("start", IMPORT_STAGES)
def test_slowly_imported_modules_are_not_loaded_by_code_that_does_not_need_them(start):
    """Checked in a separate process; each import takes longer than planning a gesture.

    A stage also has the modules of the stages before it, none of which is in its list.
    """
    loaded = "print([name for name in {!r}.split() if name in sys.modules])"
    lines = [f"{code}; {loaded.format(late)}" for code, late in IMPORT_STAGES[start]]
    program = [sys.executable, "-c", "\n".join(("import sys", *lines))]
    done = subprocess.run(program, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["[]"] * len(lines)


def test_scipy_signal_which_takes_half_a_second_is_imported_in_functions_only():
    """Checked in the sources, because a process that imports captured motion takes more than a second."""
    texts = {file: file.read_text("utf-8") for file in PACKAGE.rglob("*.py")}
    lines = [(file.name, line) for file, text in texts.items() for line in text.splitlines() if "scipy.signal" in line]
    assert [name for name, line in lines if not line.startswith("    from")] == []
    assert {name for name, _ in lines} >= {"resampling.py", "gesture_markers.py"}
