"""Cluster certificates made by the commands of docs/how-to/run-many-documents.md."""

import re
import subprocess
from pathlib import Path

from kinesic.tasks.dask_access import Certificates

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "run-many-documents.md"


def make_certificates(folder: Path) -> Certificates:
    """Run the guide's commands in a folder."""
    commands = re.findall(r"^(?:umask|openssl) .+$", GUIDE.read_text(encoding="utf-8"), re.MULTILINE)
    subprocess.run("\n".join(commands), shell=True, cwd=folder, check=True, capture_output=True)
    return Certificates(folder / "ca.pem", folder / "member.pem", folder / "member.key")
