"""Process that fuzzes one target.

Usage: `python -m tests.fuzz.worker TARGET SECONDS SEED ENGINE FOLDER`. Every input is first written to the file `last`
of the folder, so that it is known even if the interpreter crashes. An error ends the process; the last line of its
standard output has the counts.
"""

import faulthandler
import sys
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import monotonic

from tests.fuzz.mutations import Pool, outcome_of

MAX_INPUT_TIME = 20.0  # [s] longest time for one input, after which the target counts as hanging
LAST_INPUT = "last"  # name of the file with the input that is read now


def fuzz_by_mutations(name: str, seconds: float, seed: int, folder: Path) -> None:
    """Fuzz with mutated inputs for some time [s]."""
    from tests.fuzz.targets import list_targets  # noqa: PLC0415 - atheris instruments the modules when it imports them

    last, chance, inputs, accepted = folder / LAST_INPUT, Random(f"{name} {seed}"), 0, 0
    with TemporaryDirectory(dir=folder) as files:
        target = list_targets(Path(files))[name]
        pool, end = Pool(target.seeds, chance), monotonic() + seconds
        try:
            while monotonic() < end:
                data = pool.draw()
                last.write_bytes(data)
                faulthandler.dump_traceback_later(MAX_INPUT_TIME, exit=True)
                outcome = outcome_of(target.read, data, target.refusals)
                pool.keep(data, outcome)
                inputs, accepted = inputs + 1, accepted + (not outcome)
        finally:
            print(inputs, accepted, flush=True)  # noqa: T201 - read by the parent process


def fuzz_by_coverage(name: str, seconds: float, seed: int, folder: Path) -> None:
    """Fuzz with inputs from atheris for some time [s].

    Atheris derives inputs from the code coverage of earlier ones.
    """
    import atheris  # noqa: PLC0415 - optional

    with atheris.instrument_imports(include=["kinesic"]):
        from tests.fuzz.targets import list_targets  # noqa: PLC0415 - see above

    corpus, last, counts = folder / "corpus", folder / LAST_INPUT, [0, 0]
    corpus.mkdir(exist_ok=True)
    with TemporaryDirectory(dir=folder) as files:
        target = list_targets(Path(files))[name]
        for number, text in enumerate(target.seeds):
            (corpus / f"seed-{number}").write_bytes(text)

        def read(data: bytes) -> None:
            last.write_bytes(data)
            counts[0] += 1
            counts[1] += not outcome_of(target.read, data, target.refusals)
            if counts[0] % 50 == 0:
                (folder / "counts").write_text(f"{counts[0]} {counts[1]}")

        options = [f"-max_total_time={round(seconds)}", f"-seed={seed + 1}", f"-timeout={round(MAX_INPUT_TIME)}"]
        options += [f"-artifact_prefix={folder}/", "-verbosity=0", "-print_final_stats=0", "-rss_limit_mb=4000"]
        atheris.Setup([sys.argv[0], *options, str(corpus)], read)
        atheris.Fuzz()  # ends the process


if __name__ == "__main__":
    chosen, duration, start, engine, place = sys.argv[1:]
    fuzz = fuzz_by_coverage if engine == "atheris" else fuzz_by_mutations
    fuzz(chosen, float(duration), int(start), Path(place))
