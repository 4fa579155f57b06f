"""Process that measures time and memory to plan and perform one document.

Run `python -m kinesic.bench.growth.length_process SECONDS`; it prints JSON.
"""

import json
import sys
from dataclasses import asdict

from kinesic.bench.growth import measure_document_cost, warm_up_planner
from kinesic.session.setup import set_up

if __name__ == "__main__":
    setup, length = set_up(), float(sys.argv[1])
    warm_up_planner(setup)
    sys.stdout.write(json.dumps(asdict(measure_document_cost(setup, length, length))))
