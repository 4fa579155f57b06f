"""Client that attacks outside files with hostile names, planted links and races."""

import hashlib
import json
import os
import random
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Thread
from typing import get_args
from xml.sax.saxutils import quoteattr

from kinesic import Performer
from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError
from kinesic.cli.live.folder_gestures import read_folder
from kinesic.cli.live.serve import EXPORT_WRITERS
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.setup import Setup
from kinesic.report.output import default_folder
from kinesic.serve.desk.backups import BackupFolder
from kinesic.serve.desk.documents import DocumentFolder
from kinesic.serve.desk.drafter import FileQuestion, answer_draft
from kinesic.serve.wire.questions import ExportQuestion, Format, GestureQuestion
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id={0}><head id={0} lexeme="NOD" start="0"/></bml>'
GESTURE = "category = {}\n\n[[gesture]]\nid = {}\nkeys = [{{ right = {{ at = [0.5, 0.3, 0.5] }} }}]\n"
ROBOT = "[robot]\nname = {}\nextends = {}\n"
SECRET_TEXT = "dear-secret-letter"
KEPT_NAMES = ("data.csv", "song.wav", "motion.npz", "rc.bap", "scene.glb", "mine.bml", "mine.toml", "letter")
PLANTED_NAMES = ("link.bml", "link.toml", "race.bml", "race.toml", "performance.csv", "performance.npz", "gesture.toml")
FILE_SOURCES = (
    "{}",
    "{}.bml",
    "{}.toml",
    "{}.csv",
    "..\\{}",
    "C:\\{}",
    "~/{}",
    "file:///{}",
    "%2e%2e/{}",
    "{}\n",
    " {}",
    "{}\0",
)
REQUEST_WEIGHTS = {"export": 45, "save": 25, "open": 15, "load": 12, "report": 3}  # in percent of all requests


@dataclass(frozen=True)
class Grounds:
    """Folders of an attack: document folder, temporary folder and protected outside files."""

    root: Path

    @property
    def given(self) -> Path:
        return self.root / "given"

    @property
    def temporary(self) -> Path:
        return self.root / "temporary"

    @property
    def outside(self) -> Path:
        return self.root / "outside"

    def lay_out(self) -> None:
        """Create the folders, the secret files outside, and links to these files inside."""
        for folder in (self.given, self.temporary, self.outside / "work", self.outside / "home"):
            folder.mkdir(parents=True)
            for name in KEPT_NAMES if folder.is_relative_to(self.outside) else ():
                (folder / name).write_text(SECRET_TEXT)
                (folder / name).chmod(0o600 if name.startswith("m") else 0o644)
        for folder in (self.given, self.temporary):
            (folder / "up").symlink_to(self.outside)
            for name in PLANTED_NAMES:
                (folder / name).symlink_to(self.outside / "home" / "mine.bml")

    def snapshot(self) -> dict[str, tuple]:
        """Return kind, permissions, modification time and content of all outside files."""
        states = {}
        for folder, folders, files in os.walk(self.outside):
            for name in (".", *folders, *files):
                path = Path(folder, name)
                status = path.lstat()
                content = hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else sorted(os.listdir(path))
                states[str(path)] = (status.st_mode, status.st_mtime_ns, status.st_size, status.st_ino, str(content))
        return states

    @contextmanager
    def racing(self) -> Iterator[None]:
        """Replace files by links and folders in a thread, as fast as possible."""
        done = Event()
        thread = Thread(target=self._race, args=(done,))
        thread.start()
        try:
            yield
        finally:
            done.set()
            thread.join()

    def _race(self, done: Event) -> None:
        letter, chance = self.outside / "home" / "mine.bml", random.Random(0)
        while not done.wait(0.0002):
            path = self.given / chance.choice(("race.bml", "race.toml", "race-report"))
            aside = path.with_name(f"aside-{path.name}")
            with suppress(OSError):
                path.rename(aside)
                path.symlink_to(letter if path.suffix else self.outside / "work")
                done.wait(0.0002)
                path.unlink()
                aside.rename(path)


class Intruder:
    """Generator of requests of all kinds with hostile names."""

    def __init__(self, grounds: Grounds, setup: Setup, performer: Performer, seed: int) -> None:
        self._grounds, self._setup, self._performer = grounds, setup, performer
        self._chance, self._folder = random.Random(seed), DocumentFolder(grounds.given)
        self.done: Counter[str] = Counter()
        self.granted: Counter[str] = Counter()  # accepted requests

    def act(self, count: int) -> None:
        """Execute a number of requests.

        Each must end in an answer or a refusal and must not reveal a secret.
        """
        acts: dict[str, Callable[[], str]] = {
            "export": self._export,
            "save": self._save,
            "open": self._open,
            "load": self._load,
            "report": self._report,
        }
        for kind in self._chance.choices(list(REQUEST_WEIGHTS), list(REQUEST_WEIGHTS.values()), k=count):
            self.done[kind] += 1
            try:
                answer = acts[kind]()
                self.granted[kind] += 1
            except (ConfigError, BmlError) as refusal:
                answer = str(refusal)
            assert SECRET_TEXT not in answer, (kind, answer)

    def name(self) -> str:
        """Return a hostile name, or occasionally a harmless one."""
        chance, grounds = self._chance, self._grounds
        kept = chance.choice(KEPT_NAMES)
        place = chance.choice((grounds.outside / "home", grounds.outside / "work", grounds.given, grounds.temporary))
        bare = chance.choice(
            (
                str(place / kept),
                str((place / kept).with_suffix("")),
                "../" * chance.randint(1, 9) + f"outside/home/{Path(kept).stem}",
                f"up/home/{Path(kept).stem}",
                *(Path(planted).stem for planted in PLANTED_NAMES),
                *("con", "NUL", "com1.x", ".", "..", "", "/", "-", ".hidden", "a" * 500, "\N{GRINNING FACE}" * 90),
                *("doc", "race", "/dev/shm/x", "/proc/self/cwd/mine", "\N{RIGHT-TO-LEFT OVERRIDE}lmb", "\udcff", "a b"),
            )
        )
        return chance.choice((*("{}",) * 12, *FILE_SOURCES)).format(bare)

    def _export(self) -> str:
        document = NOD.format(quoteattr(self.name().translate({0: "?", 0xDCFF: "?"})))
        question = ExportQuestion(document, self._chance.choice(get_args(Format)), id=1)
        answer = answer_draft(question, self._setup, DEFAULT_QUOTAS, writers=EXPORT_WRITERS)
        data = json.loads(answer)
        if "error" in data:
            raise ConfigError(answer)
        assert Path(data["name"]).name == data["name"]
        return answer

    def _save(self) -> str:
        name, text = self.name(), NOD.format('"b"')
        if self._chance.random() < 0.4:
            name = self._chance.choice(("race", "doc", "link", "new")) + self._chance.choice((".bml", ".toml"))
        if name.endswith(".toml"):
            text = GESTURE.format('"beat"', '"mine"')
            present = self._folder.read_present(name)
            fault = answer_draft(FileQuestion(name, text, present), self._setup, DEFAULT_QUOTAS)
            if fault:
                raise ConfigError(fault)
        self._folder.save(name, text)
        return name

    def _open(self) -> str:
        if self._chance.random() < 0.2:
            return "\n".join(self._folder.list().names)
        if self._chance.random() < 0.3:
            return self._folder.read_version(self.name(), self._chance.randint(0, 3))
        if self._chance.random() < 0.3:
            return self._back_up()
        return self._folder.read(self.name()).text

    def _back_up(self) -> str:
        """Store a backup under hostile names, and read all backups."""
        backups, key = BackupFolder(self._grounds.given), self.name()
        backups.keep(key, self.name(), self.name(), "unsaved")
        return "".join(backups.read(header.key).text for header in backups.list())

    def _load(self) -> str:
        """Load gesture and robot files from an untrusted source."""
        what = self._chance.randrange(4)
        quoted = [json.dumps(self.name()).replace("\\udcff", "?") for _ in range(2)]
        if what == 0:
            return answer_draft(GestureQuestion(GESTURE.format(*quoted)), self._setup, DEFAULT_QUOTAS)
        if what == 1:
            return answer_draft(GestureQuestion(lexeme=self.name().replace("\udcff", "?")), self._setup, DEFAULT_QUOTAS)
        if what == 2:
            return "\n".join(read_folder(self._grounds.given).faults)
        file = self._grounds.temporary / "stranger.toml"
        file.write_text(ROBOT.format(quoted[0], self._chance.choice(('"upper22"', quoted[1]))))
        return load_robot(file).name

    def _report(self) -> str:
        document = NOD.format(quoteattr(self.name().translate({0: "?", 0xDCFF: "?"})))
        name = self._chance.choice(("race-report", default_folder(self.name().replace("\0", "?")).name))
        plan = self._performer.plan(document, source=self.name())
        return str(self._performer.perform(plan).report(self._grounds.given / name, film=False))
