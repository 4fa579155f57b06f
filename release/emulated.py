"""Test an aarch64 wheel with release/smoke.py under QEMU user-mode emulation.

Everything comes from the registries: QEMU and an arm64 Python from Debian, unpacked into a folder without root, and the
wheels of the dependencies from PyPI. Needed are Debian 12 or a later one (apt-get, dpkg-deb) on another processor. The
same program runs first on this processor with this interpreter, which must have kinesic; the results must agree.
"""

import argparse
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SMOKE = ROOT / "release" / "smoke.py"
PYTHON_PACKAGES = ("python3-minimal", "libpython3-stdlib", "libstdc++6")  # Debian packages of the emulated Python
PLATFORMS = [f"--platform=manylinux_{glibc}_aarch64" for glibc in ("2_17", "2_24", "2_27", "2_28", "2_31", "2_34")]
TIME_LIMIT = 600  # [s] longest duration of the emulated run


def main() -> None:
    """Run the smoke test on both processors and compare the results."""
    parser = argparse.ArgumentParser(description="Test an aarch64 wheel of kinesic under QEMU.")
    parser.add_argument("wheel", type=Path, help="wheel for aarch64")
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "aarch64", help="kept between runs")
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    emulator = unpack_debian(folder / "qemu", ("qemu-user-static",)) / "usr" / "bin" / "qemu-aarch64-static"
    system = unpack_debian(folder / "arm64", PYTHON_PACKAGES, architecture="arm64")
    (python,) = (path for path in (system / "usr" / "bin").glob("python3.*") if path.name[-1].isdigit())
    packages = install(arguments.wheel.resolve(), folder / "packages", python.name.removeprefix("python"))
    native, emulated = folder / "native.json", folder / "aarch64.json"
    native.write_bytes(subprocess.run([sys.executable, SMOKE], stdout=subprocess.PIPE, check=True).stdout)
    command = [emulator, "-L", system, python, SMOKE, "--expect", native]
    environment = {"PYTHONPATH": str(packages), "PATH": os.environ["PATH"], "MUJOCO_GL": "disable"}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, timeout=TIME_LIMIT, check=False)
    emulated.write_bytes(done.stdout)
    if done.returncode:
        sys.exit("the smoke test failed or its results differ; build the wheel from the kinesic of this interpreter")


def unpack_debian(folder: Path, packages: tuple[str, ...], *, architecture: str | None = None) -> Path:
    """Download Debian packages with their dependencies, and unpack them.

    Args:
        folder: folder for the unpacked files; an existing one is used as it is.
        packages: names of the packages.
        architecture: processor of the packages; None: this machine's, without dependencies.
    """
    if folder.exists():
        return folder
    state = folder.parent / f"{folder.name}.apt"
    for part in ("lists/partial", "cache/archives/partial"):
        (state / part).mkdir(parents=True, exist_ok=True)
    (state / "status").touch()
    apt = ["apt-get", "-qq", "-o", f"Dir::State={state}", "-o", f"Dir::State::status={state / 'status'}"]
    apt += ["-o", f"Dir::Cache={state / 'cache'}", "-o", "Acquire::Languages=none", "-o", "APT::Sandbox::User="]
    apt += ["-o", "Debug::NoLocking=1"]
    if architecture is not None:
        apt += ["-o", f"APT::Architecture={architecture}", "-o", f"APT::Architectures={architecture}"]
    archives = state / "cache" / "archives"
    subprocess.run([*apt, "update"], check=True)
    if architecture is None:
        subprocess.run([*apt, "download", *packages], cwd=archives, check=True)
    else:
        subprocess.run([*apt, "install", "--no-install-recommends", "--download-only", "--yes", *packages], check=True)
    unfinished = folder.parent / f"{folder.name}.part"
    for archive in sorted(archives.glob("*.deb")):
        subprocess.run(["dpkg-deb", "--extract", archive, unfinished], check=True)
    return unfinished.rename(folder)


def install(wheel: Path, folder: Path, version: str) -> Path:
    """Install the wheel, its dependencies and SciPy for aarch64."""
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--upgrade"]
    command += ["--no-compile", "--only-binary=:all:", f"--python-version={version}", *PLATFORMS]
    subprocess.run([*command, "--target", folder, wheel, "scipy"], check=True)
    return folder


if __name__ == "__main__":
    main()
