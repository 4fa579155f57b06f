"""Build the documentation site, check its links, and write llms.txt.

.venv/bin/python docs/make/site.py                       # build/site
.venv/bin/python docs/make/site.py --publish FOLDER      # and FOLDER/VERSION with versions.json, for a web server
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
SITE = ROOT / "build" / "site"
LATEST_ALIAS = "latest"  # folder of the newest published version
UNCHECKED_SCHEMES = ("http", "https", "mailto", "data", "javascript")
LOADING_TAGS = ("script", "link", "img", "video", "iframe")
NAVIGATION_LINE = re.compile(r"^(?P<indent> *)- (?:(?P<title>[^:\n]+): ?)?(?P<page>[\w/-]+\.md)?$", re.MULTILINE)
REDIRECT_PAGE = '<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url={target}">\n'


@dataclass(frozen=True, eq=False)
class NavigationEntry:
    """One page of the navigation, with the title of its section."""

    section: str
    page: str  # path below docs


def read_navigation(configuration: str) -> list[NavigationEntry]:
    """Return the pages of `nav` in mkdocs.yml in their order."""
    _, navigation = configuration.split("\nnav:\n")
    entries, section = [], ""
    for line in NAVIGATION_LINE.finditer(navigation):
        if not line["page"]:
            section = line["title"]
        else:
            is_inside = len(line["indent"]) > 2
            entries.append(NavigationEntry(section if is_inside else line["title"], line["page"]))
    return entries


class PageLinks(HTMLParser):
    """Links, pictures and anchors of one page."""

    def __init__(self, html: str) -> None:
        """Parse the HTML of a page."""
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.loaded: list[str] = []  # scripts, styles and pictures
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the links and anchors of a tag."""
        values = {name: value for name, value in attrs if value is not None}
        self.links += [values[name] for name in ("href", "src") if name in values]
        if tag in LOADING_TAGS and values.get("rel", "stylesheet") == "stylesheet":
            self.loaded += [values[name] for name in ("href", "src") if name in values]
        self.anchors |= {values[name] for name in ("id", "name") if name in values}


def find_broken_links(site: Path) -> Iterator[str]:
    """Yield broken links and external resources as `page: link`."""
    pages = {path: PageLinks(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    for path, page in pages.items():
        yield from (f"{path.relative_to(site)}: {link}" for link in page.loaded if urlsplit(link).netloc)
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme in UNCHECKED_SCHEMES or parts.netloc or path.name == "404.html":
                continue
            place, anchor = urldefrag(link)
            target = path if not place else (path.parent / unquote(urlsplit(place).path)).resolve()
            target = target / "index.html" if target.is_dir() else target
            if not target.exists() or (anchor and target in pages and unquote(anchor) not in pages[target].anchors):
                yield f"{path.relative_to(site)}: {link}"


def write_llms_files(site: Path, entries: list[NavigationEntry]) -> None:
    """Write llms.txt, llms-full.txt and each page as Markdown.

    llms.txt lists all pages, llms-full.txt contains their texts.
    """
    lines, texts, section = ["# kinesic", "", f"> {_summary('index.md')}"], [], ""
    for entry in entries:
        if entry.section != section:
            section = entry.section
            lines += ["", f"## {section}", ""]
        text = (DOCS / entry.page).read_text(encoding="utf-8")
        title = text.splitlines()[0].removeprefix("# ")
        lines.append(f"- [{title}]({entry.page}): {_summary(entry.page)}")
        texts.append(f"<!-- {entry.page} -->\n\n{text}")
        (site / entry.page).write_text(text, encoding="utf-8")
    (site / "llms.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (site / "llms-full.txt").write_text("\n".join(texts), encoding="utf-8")


def _summary(page: str) -> str:
    """Return the first sentence of a page's prose, without links."""
    blocks = (DOCS / page).read_text(encoding="utf-8").split("\n\n")[1:]
    prose = next((block for block in blocks if re.match(r"[A-Za-z`\[]", block)), "")
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", " ".join(prose.split()))
    return re.split(r"(?<=[^.][.:])\s(?=[A-Z`])", plain)[0]


def publish(site: Path, folder: Path, version: str) -> None:
    """Publish a built site as a version and as latest.

    The pages read `versions.json` in the folder above them for their selector of versions.
    """
    for name in (version, LATEST_ALIAS):
        shutil.rmtree(folder / name, ignore_errors=True)
        shutil.copytree(site, folder / name)
    listed = folder / "versions.json"
    versions = json.loads(listed.read_text(encoding="utf-8")) if listed.exists() else []
    others = [dict(entry, aliases=[]) for entry in versions if entry["version"] != version]
    entries = [{"version": version, "title": version, "aliases": [LATEST_ALIAS]}, *others]
    listed.write_text(json.dumps(entries, indent=2) + "\n", encoding="utf-8")
    (folder / "index.html").write_text(REDIRECT_PAGE.format(target=f"{LATEST_ALIAS}/"), encoding="utf-8")


def main() -> int:
    """Build the site; return 1 if a link is broken."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--publish", type=Path, metavar="FOLDER", help="add this version to a folder of all versions")
    options = parser.parse_args()
    program = Path(sys.executable).with_name("zensical")
    if code := subprocess.run([program, "build", "--strict", "--clean"], cwd=ROOT, check=False).returncode:
        return code
    entries = read_navigation((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    write_llms_files(SITE, entries)
    broken = list(find_broken_links(SITE))
    print(*broken, f"{len(entries)} pages, {len(broken)} broken links", sep="\n")
    if options.publish and not broken:
        from kinesic.version import __version__  # noqa: PLC0415 - the site itself builds without kinesic

        publish(SITE, options.publish, __version__)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
