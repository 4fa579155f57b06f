"""A plan does not hang on the processor: other kernels of linear algebra and of elementary functions give the same.

The second plan is made in a process of its own, with OpenBLAS's oldest kernel, without NumPy's vector code and without
the fused instructions of the C library; where the tests run with one of these already, with another. That the same
process plans the same bytes again is a theorem of the whole line.
"""

import os
import platform
import random
import subprocess
import sys
from ctypes import CDLL, c_char_p
from pathlib import Path

import numpy as np
import pytest
from numpy._core import _multiarray_umath as umath

from kinesic.bml.block import BmlError
from kinesic.controller.perform import plan, set_up
from kinesic.report.batch import documents

ROOT = Path(__file__).resolve().parents[3]
WELCOME = ROOT / "kinesic" / "configs" / "bml" / "welcome.bml"
CORPUS = Path(os.environ.get("KINESIC_CORPUS", ROOT.parent / "shared" / "corpus"))
FOLDERS = {"greta/bml": 2, "openbmlparser": 7, "realizertester": 9, "asap": 2}  # the first take longest
LARGEST = 5000  # [bytes]
NEAR = 1e-9  # [rad]
RATE = 100.0  # [Hz]
OLDEST = {"x86_64": ("Prescott", "Nehalem"), "aarch64": ("ARMV8", "NEOVERSEN1")}  # the first, unless it is in use
NAMED = {"katmai": "Prescott"}  # how OpenBLAS calls what was asked for
NO_FUSED = "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable"


def chosen() -> list[Path]:
    """`welcome.bml` and a seeded sample of what others wrote."""
    pick = random.Random(20)
    files = [
        path
        for folder, count in FOLDERS.items()
        if (CORPUS / folder).exists()
        for path in pick.sample([p for p in documents((CORPUS / folder,)) if p.stat().st_size < LARGEST], count)
    ]
    return [WELCOME, *files]


def planned(files: list[Path]) -> dict[str, np.ndarray]:
    """Sampled angles (n, hinges) [rad] of each document, and the name of the kernel that was used."""
    known, angles = set_up(), {"kernel": np.array(kernel())}
    for path in files:
        try:
            motion = plan(path.read_text(encoding="utf-8"), known, source=str(path)).trajectory
        except BmlError:
            continue
        angles[str(path)] = motion.sample(np.arange(int(motion.duration * RATE) + 1) / RATE)[0]
    return angles


def kernel() -> str:
    """Which of its kernels NumPy's OpenBLAS uses; nothing where NumPy has another library."""
    for path in (Path(np.__file__).parents[1] / "numpy.libs").glob("*openblas*"):
        name = getattr(CDLL(str(path)), "scipy_openblas_get_corename64_", None)
        if name is not None:
            name.restype = c_char_p
            return str(name().decode())
    return ""


def elsewhere() -> dict[str, str]:
    """The environment of a process that calculates otherwise than this one."""
    vectors = [name for name in umath.__cpu_dispatch__ if umath.__cpu_features__[name]]
    oldest, second = OLDEST[platform.machine()]
    used = NAMED.get(kernel().lower(), kernel())
    other = {
        "OPENBLAS_CORETYPE": second if used.lower() == oldest.lower() else oldest,
        "NPY_DISABLE_CPU_FEATURES": " ".join(vectors),
        "GLIBC_TUNABLES": "" if "GLIBC_TUNABLES" in os.environ else NO_FUSED,
    }
    return {**{name: value for name, value in os.environ.items() if name not in other}, **other}


def test_another_kernel_gives_the_same_plans(tmp_path: Path):
    if not kernel() or platform.machine() not in OLDEST:
        pytest.skip("NumPy's linear algebra here is not an OpenBLAS that has several kernels")
    files, out = chosen(), tmp_path / "elsewhere.npz"
    environment = {name: value for name, value in elsewhere().items() if value}
    with subprocess.Popen([sys.executable, __file__, str(out), *map(str, files)], env=environment) as process:
        here = planned(files)
    assert process.returncode == 0
    there = np.load(out)
    assert set(here) == set(there.files)
    assert len(here) > len(files) // 2
    assert here.pop("kernel") != there["kernel"]
    for name, angles in here.items():
        assert angles.shape == there[name].shape, name
        assert np.abs(angles - there[name]).max() < NEAR, name


if __name__ == "__main__":
    np.savez(sys.argv[1], **planned([Path(name) for name in sys.argv[2:]]))
