import gc
import subprocess
import sys

import pytest

from kinesic.importing import import_at_once
from kinesic.motion.trajectory import KERNEL


@pytest.fixture
def watching(tmp_path, monkeypatch):
    (tmp_path / "watching.py").write_text("import gc\nWATCHED = gc.isenabled()\n")
    (tmp_path / "failing.py").write_text("import what_nobody_has\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield
    sys.modules.pop("watching", None)


def test_nobody_looks_for_garbage_meanwhile_and_then_again(watching):
    assert import_at_once("watching").WATCHED is False
    assert gc.isenabled()


def test_garbage_is_looked_for_again_where_an_import_fails(watching):
    with pytest.raises(ModuleNotFoundError, match="what_nobody_has"):
        import_at_once("failing")
    assert gc.isenabled()


def test_who_looks_for_no_garbage_goes_on_so(watching):
    gc.disable()
    try:
        import_at_once("watching")
        assert not gc.isenabled()
    finally:
        gc.enable()


OF_KERNELS = "scipy.sparse casadi" if KERNEL == "compiled" else ""  # what kernels spare
BLOCK = '<bml id="b"><gesture id="g" lexeme="beat" stroke="1"/></bml>'


@pytest.mark.parametrize(
    ("code", "late"),
    [
        (
            f"import kinesic; kinesic.Performer(idle=0.0, variation=0.0).plan({BLOCK!r})",
            f"scipy.interpolate scipy.optimize {OF_KERNELS} urllib.request jinja2 PIL.Image",
        ),
        (
            "import kinesic.cli.live.serve",
            "scipy.interpolate scipy.optimize scipy.sparse jinja2 PIL.Image rich kinesic.face.render.portrait",
        ),
    ],
    ids=["a performer that plans", "a server that begins"],
)
def test_what_only_some_need_is_not_there_before_them(code, late):
    """Seen in a process of its own; each of these takes longer to import than a gesture to be planned."""
    code = f"{code}; import sys; print([name for name in {late.split()} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
