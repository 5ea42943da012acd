"""Gather the pages of the site in build/docs, for MkDocs or Zensical to build (see mkdocs.yml).

docs/home.md becomes the site's first page, the README the next one, and docs/ the guides. A link to anything else in
the repository becomes a link within the site, to a page that shows the file or lists the folder.
"""

import re
import shutil
import sys
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[1]
SITE = ROOT / "build" / "docs"

# Pages of the repository whose place in the site is not the one that they have in docs/ or in the repository.
PLACES = {
    "docs/home.md": "index.md",
    "README.md": "start.md",
    "README.ko.md": "ko/index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
}
PICTURES = {".png", ".svg", ".gif", ".webp"}
LANGUAGES = {".py": "python", ".sh": "sh", ".yaml": "yaml", ".hpp": "cpp", ".cpp": "cpp", ".toml": "toml"}
LINK = re.compile(r"\]\(([^)\s#]*)(#[^)\s]*)?\)")
UNSEARCHED = "---\nsearch:\n  exclude: true\n---\n"


def site_place(path: str) -> str:
    """Where a file or folder of the repository is in the site's sources; both are posix paths."""
    if path in PLACES:
        return PLACES[path]
    source = ROOT / path
    place = path.removeprefix("docs/").removesuffix("/README.md")
    if source.is_dir() or source.name == "README.md":
        return f"{place}/index.md"
    return place if source.suffix in {".md", *PICTURES} else f"{place}.md"


def relative(target: str, page: str) -> str:
    """The link that leads from one page of the site to another place in it."""
    up, down = PurePosixPath(page).parent.parts, PurePosixPath(target).parts
    shared = 0
    while shared < min(len(up), len(down) - 1) and up[shared] == down[shared]:
        shared += 1
    return "/".join([".."] * (len(up) - shared) + list(down[shared:]))


def rewrite(text: str, path: str) -> tuple[str, list[str]]:
    """A page with its links as the site needs them, and what they lead to, as paths of the repository.

    Raises:
        FileNotFoundError: If a link leads to nothing; the message names page and link.
    """
    found: list[str] = []

    def replace(match: re.Match[str]) -> str:
        link, anchor = match[1], match[2] or ""
        if not link or re.match(r"[a-z]+:", link):
            return match[0]
        source = (ROOT / path).parent / link
        if not source.exists():
            raise FileNotFoundError(f"{path}: the link to {link} leads to nothing")
        target = source.resolve().relative_to(ROOT).as_posix()
        found.append(target)
        return f"]({relative(site_place(target), site_place(path))}{anchor})"

    parts = re.split(r"(^```.*?^```)", text, flags=re.MULTILINE | re.DOTALL)
    parts[::2] = [LINK.sub(replace, part) for part in parts[::2]]
    return "".join(parts), found


def file_page(path: str) -> str:
    """A page that shows a text file."""
    language = LANGUAGES.get(Path(path).suffix, "text")
    return f"{UNSEARCHED}# {path}\n\n```{language}\n{(ROOT / path).read_text().rstrip()}\n```\n"


def folder_page(path: str) -> tuple[str, list[str]]:
    """A page that lists a folder, and what it lists."""
    shown = [entry for entry in sorted((ROOT / path).iterdir()) if not entry.name.startswith(("_", "."))]
    names = [entry.relative_to(ROOT).as_posix() for entry in shown]
    lines = [f"- [{Path(name).name}]({relative(site_place(name), site_place(path))})" for name in names]
    return f"{UNSEARCHED}# {path}\n\n" + "\n".join(lines) + "\n", names


def gather(site: Path = SITE) -> None:
    """Write the site's sources, from the repository's pages and all that they lead to."""
    shutil.rmtree(site, ignore_errors=True)
    waiting = [*PLACES, *(page.relative_to(ROOT).as_posix() for page in sorted((ROOT / "docs").rglob("*.md")))]
    done: set[str] = set()
    while waiting:
        path = waiting.pop()
        if path in done:
            continue
        done.add(path)
        place, source = site / site_place(path), ROOT / path
        place.parent.mkdir(parents=True, exist_ok=True)
        more: list[str] = []
        if source.is_dir() and (source / "README.md").exists():
            waiting.append(f"{path}/README.md")
            continue
        if source.is_dir():
            text, more = folder_page(path)
        elif source.suffix in PICTURES:
            shutil.copy(source, place)
            continue
        elif source.suffix == ".md":
            text, more = rewrite(source.read_text(), path)
        else:
            text = file_page(path)
        place.write_text(text)
        waiting += more


if __name__ == "__main__":
    try:
        gather()
    except FileNotFoundError as error:
        sys.exit(f"docs_site.py: {error}")
