"""Plans and performs a document and prints what that took: `python -m kinesic.bench.growth.length_process SECONDS`."""

import json
import sys
from dataclasses import asdict

from kinesic.bench.growth import measure, warm_up
from kinesic.controller.perform import set_up

if __name__ == "__main__":
    known, length = set_up(), float(sys.argv[1])
    warm_up(known)
    sys.stdout.write(json.dumps(asdict(measure(known, length, length))))
