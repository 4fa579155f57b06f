"""Plans are independent of the processor and its math kernels.

The second plan is made in another process with OpenBLAS's oldest kernel, without NumPy's SIMD code and without the
fused instructions of the C library; if the tests already use one of these, another is chosen. test_plan covers
repeatability within one process.
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
from kinesic.report.batch import documents
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

REPOSITORY_ROOT = Path(__file__).resolve().parents[3]
WELCOME_FILE = REPOSITORY_ROOT / "kinesic" / "configs" / "bml" / "welcome.bml"
CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", REPOSITORY_ROOT.parent / "shared" / "corpus"))
SAMPLE_COUNTS = {
    "greta/bml": 2,
    "openbmlparser": 7,
    "realizertester": 9,
    "asap": 2,
}  # number of tested documents per folder; the first two folders take longest
MAX_FILE_SIZE = 5000  # [bytes] largest document that is planned
ANGLE_TOLERANCE = 1e-9  # [rad] largest difference between two plans
SAMPLE_RATE = 100.0  # [Hz] sample rate of the compared angles
OLDEST_KERNELS = {
    "x86_64": ("Prescott", "Nehalem"),
    "aarch64": ("ARMV8", "NEOVERSEN1"),
}  # the first kernel is compared with the kernel in use, or the second if the first is in use
KERNEL_ALIASES = {"katmai": "Prescott"}  # other names of OpenBLAS kernels
# GLIBC_TUNABLES without vector and fused multiply-add instructions
NO_FUSED_INSTRUCTIONS = "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable"


def chosen() -> list[Path]:
    """Return `welcome.bml` and a random sample of the corpus."""
    pick = random.Random(20)
    files = [
        path
        for folder, count in SAMPLE_COUNTS.items()
        if (CORPUS_FOLDER / folder).exists()
        for path in pick.sample(
            [p for p in documents((CORPUS_FOLDER / folder,)) if p.stat().st_size < MAX_FILE_SIZE], count
        )
    ]
    return [WELCOME_FILE, *files]


def planned(files: list[Path]) -> dict[str, np.ndarray]:
    """Return the sampled angles (n, hinges) [rad] and the kernel's name."""
    known, angles = set_up(), {"kernel": np.array(kernel())}
    for path in files:
        try:
            motion = plan(path.read_text(encoding="utf-8"), known, source=str(path)).trajectory
        except BmlError:
            continue
        angles[str(path)] = motion.sample(np.arange(int(motion.duration * SAMPLE_RATE) + 1) / SAMPLE_RATE)[0]
    return angles


def kernel() -> str:
    """Return the kernel of NumPy's OpenBLAS, empty for another library."""
    for path in (Path(np.__file__).parents[1] / "numpy.libs").glob("*openblas*"):
        name = getattr(CDLL(str(path)), "scipy_openblas_get_corename64_", None)
        if name is not None:
            name.restype = c_char_p
            return str(name().decode())
    return ""


def other_kernel_environment() -> dict[str, str]:
    """Return environment variables that select other math kernels."""
    vectors = [name for name in umath.__cpu_dispatch__ if umath.__cpu_features__[name]]
    oldest, second = OLDEST_KERNELS[platform.machine()]
    used = KERNEL_ALIASES.get(kernel().lower(), kernel())
    other = {
        "OPENBLAS_CORETYPE": second if used.lower() == oldest.lower() else oldest,
        "NPY_DISABLE_CPU_FEATURES": " ".join(vectors),
        "GLIBC_TUNABLES": "" if "GLIBC_TUNABLES" in os.environ else NO_FUSED_INSTRUCTIONS,
    }
    return {**{name: value for name, value in os.environ.items() if name not in other}, **other}


@pytest.mark.soak
def test_plans_with_another_openblas_kernel_agree_within_a_tolerance(tmp_path: Path):
    if not kernel() or platform.machine() not in OLDEST_KERNELS:
        pytest.skip("NumPy's linear algebra here is not an OpenBLAS that has several kernels")
    files, out = chosen(), tmp_path / "elsewhere.npz"
    environment = {name: value for name, value in other_kernel_environment().items() if value}
    with subprocess.Popen([sys.executable, __file__, str(out), *map(str, files)], env=environment) as process:
        here = planned(files)
    assert process.returncode == 0
    there = np.load(out)
    assert set(here) == set(there.files)
    assert len(here) > len(files) // 2
    assert here.pop("kernel") != there["kernel"]
    for name, angles in here.items():
        assert angles.shape == there[name].shape, name
        assert np.abs(angles - there[name]).max() < ANGLE_TOLERANCE, name


if __name__ == "__main__":
    np.savez(sys.argv[1], **planned([Path(name) for name in sys.argv[2:]]))
