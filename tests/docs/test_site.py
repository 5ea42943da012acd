"""The site of `make docs`: every public name has a page, and every link leads somewhere."""

import importlib
import importlib.util
import inspect
import os
import pkgutil
import re
import shutil
import subprocess
import sys
import zlib
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from urllib.parse import unquote

import pytest
import yaml

import trundle
from trundle.control.controller import CONTROLLERS
from trundle.planning.planner import PLANNERS
from trundle.planning.smoother import SMOOTHERS
from trundle.sim.simulator import SIMULATORS
from trundle.worlds.world import WORLDS

ROOT = Path(__file__).parents[2]
SETTINGS = yaml.safe_load((ROOT / "mkdocs.yml").read_text())
# What is no part of the API: the command line, the kernels, and how other people's files are opened and read.
INTERNAL = ("trundle._core", "trundle.cli", "trundle.files", "trundle.guard")
# Modules whose public names are those that they define, as they have no `__all__`.
WHOLE = ("trundle.errors", "trundle.geometry", "trundle.path", "trundle.geometry.solids")
HAS_GYM = importlib.util.find_spec("gymnasium") is not None
"""Whether the extra is there without which trundle.gym cannot be imported."""
DIRECTIVE = re.compile(r"^::: (\S+)$", flags=re.MULTILINE)


def load_script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("docs_site", ROOT / "scripts" / "docs_site.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


docs_site = load_script()


def defined_names(module: ModuleType) -> list[str]:
    """Names that a module exports, or defines where it does not say."""
    if hasattr(module, "__all__"):
        return list(module.__all__)
    own = [name for name, value in vars(module).items() if getattr(value, "__module__", None) == module.__name__]
    return [name for name in own if not name.startswith("_")]


def public_modules() -> list[ModuleType]:
    names = [module.name for module in pkgutil.walk_packages(trundle.__path__, "trundle.") if module.ispkg]
    internal = INTERNAL if HAS_GYM else (*INTERNAL, "trundle.gym")
    modules = [importlib.import_module(name) for name in (*names, *WHOLE) if not name.startswith(internal)]
    return [module for module in modules if hasattr(module, "__all__") or module.__name__ in WHOLE]


def directives() -> list[str]:
    pages = sorted((ROOT / "docs/reference").glob("*.md"))
    found = [name for page in pages for name in DIRECTIVE.findall(page.read_text())]
    return [name for name in found if HAS_GYM or not name.startswith("trundle.gym")]


def shown_names() -> set[str]:
    """Every name that a page of the reference shows: a module's public names, or one name."""
    shown = set()
    for target in directives():
        found = pkgutil.resolve_name(target)
        shown |= {f"{target}.{name}" for name in defined_names(found)} if inspect.ismodule(found) else {target}
    return shown


def home(value: object) -> str:
    return f"{getattr(value, '__module__', '')}.{getattr(value, '__qualname__', '')}"


def test_every_public_name_has_a_page() -> None:
    shown = shown_names()
    homes = {home(pkgutil.resolve_name(name)) for name in shown}
    public = {f"{module.__name__}.{name}" for module in public_modules() for name in defined_names(module)}
    assert "trundle.costmap.Costmap" in public
    assert sorted(name for name in public if name not in shown and home(pkgutil.resolve_name(name)) not in homes) == []
    common = [name for name in trundle.__all__ if name != "__version__"]
    assert [name for name in common if home(getattr(trundle, name)) not in homes] == []
    overview = (ROOT / "docs/reference/index.md").read_text()
    assert [name for name in trundle.__all__ if f"`trundle.{name}`" not in overview] == []


def test_every_choice_by_name_has_a_page() -> None:
    homes = {home(pkgutil.resolve_name(name)) for name in shown_names()}
    made = {
        name: registry.load(name)
        for registry in (PLANNERS, CONTROLLERS, SMOOTHERS, SIMULATORS, WORLDS)
        for name in registry.names()
    }
    assert [name for name, made_by in made.items() if home(made_by) not in homes] == []


def test_the_site_needs_no_plugin_but_search_and_mkdocstrings() -> None:
    assert [plugin if isinstance(plugin, str) else next(iter(plugin)) for plugin in SETTINGS["plugins"]] == [
        "search",
        "mkdocstrings",
    ]
    assert {"hooks", "theme.custom_dir"} & {*SETTINGS, *(f"theme.{key}" for key in SETTINGS["theme"])} == set()


def nav_pages(nav: list[object]) -> list[str]:
    pages: list[str] = []
    for entry in nav:
        for item in entry.values() if isinstance(entry, dict) else [entry]:
            pages += nav_pages(item) if isinstance(item, list) else [item]
    return pages


def test_the_navigation_has_every_page_and_links_out_of_docs_lead_to_pages(tmp_path: Path) -> None:
    docs_site.gather(tmp_path)
    there = {page.relative_to(tmp_path).as_posix() for page in tmp_path.rglob("*.md")}
    outside = tuple(line.strip("/*") + "/" for line in SETTINGS["not_in_nav"].split())
    listed = nav_pages(SETTINGS["nav"])
    assert len(listed) == len(set(listed))
    assert set(listed) <= there
    assert {page for page in there if not page.startswith(outside)} <= set(listed)
    isaac = (tmp_path / "isaac.md").read_text()
    assert "](src/trundle/sim/isaac/signatures.yaml.md)" in isaac
    assert "](examples/isaac/index.md)" in isaac
    assert (tmp_path / "examples/isaac/index.md").is_file()
    assert "](planning.md)" in (tmp_path / "start.md").read_text()


def test_the_first_page_shows_three_things_in_three_pictures(tmp_path: Path) -> None:
    docs_site.gather(tmp_path)
    home = (tmp_path / "index.md").read_text()
    parts = home.split("\n## ")[1:]
    assert [len(re.findall(r"^!\[[^]]+\]\(images/", part, flags=re.MULTILINE)) for part in parts] == [1, 1, 1]
    assert [len(re.findall(r"^trundle ", part, flags=re.MULTILINE)) for part in parts] == [1, 1, 1]
    assert "](start.md#two-commands)" in home


def test_a_link_that_leads_nowhere_is_named() -> None:
    with pytest.raises(FileNotFoundError, match=r"docs/maps\.md: the link to \.\./lost\.md leads to nothing"):
        docs_site.rewrite("see [this](../lost.md#part)", "docs/maps.md")


def test_code_and_links_to_other_hosts_stay_as_they_are() -> None:
    text = "a [b](https://host/c) [d](#e)\n```python\nf[g](h)\n```\n[i](conventions.md#units)"
    assert docs_site.rewrite(text, "docs/maps.md") == (text, ["docs/conventions.md"])


@pytest.mark.parametrize(
    "page", [*docs_site.PLACES, *(page.relative_to(ROOT).as_posix() for page in (ROOT / "docs").rglob("*.md"))]
)
def test_lists_and_tables_begin_after_an_empty_line(page: str) -> None:
    # Python-Markdown takes them for a part of the paragraph above otherwise.
    text = re.sub(r"^```.*?^```", "```", (ROOT / page).read_text(), flags=re.MULTILINE | re.DOTALL)
    pairs = zip(text.splitlines(), text.splitlines()[1:], strict=False)
    starts = re.compile(r"(- |\d+\. |\|)")
    inside = re.compile(r"(#|- |\d+\. |\||  )")
    assert [line for above, line in pairs if above and starts.match(line) and not inside.match(above)] == []


class Links(HTMLParser):
    """The places and the links of one page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.places: set[str] = set()
        self.links: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for key, value in attrs:
            if value and key in ("id", "name"):
                self.places.add(value)
            elif value and key in ("href", "src") and not re.match(r"[a-z]+:|//", value):
                self.links.add(value)


def broken_links(site: Path) -> list[str]:
    pages = {page: Links(page.read_text()) for page in site.rglob("*.html") if page.name != "404.html"}
    broken = []
    for page, found in pages.items():
        for link in found.links:
            path, _, anchor = link.partition("#")
            target = (page.parent / unquote(path)).resolve() if path.partition("?")[0] else page
            if target.is_dir():
                target /= "index.html"
            if not target.is_file() or (anchor and target in pages and unquote(anchor) not in pages[target].places):
                broken.append(f"{page.relative_to(site)}: {link}")
    return broken


def inventory(site: Path) -> set[str]:
    """The names that a site has a place for (Sphinx's inventory: four lines of text, the rest compressed)."""
    lines = zlib.decompress((site / "objects.inv").read_bytes().split(b"\n", 4)[4]).decode().splitlines()
    return {line.partition(" ")[0] for line in lines}


@pytest.mark.slow
@pytest.mark.parametrize("builder", ["mkdocs", "zensical"])
def test_the_site_is_built_without_a_warning(builder: str, tmp_path: Path) -> None:
    command = shutil.which(builder, path=str(Path(sys.executable).parent))
    if command is None:
        pytest.skip(f"{builder} is not installed: make docs installs it")
    docs_site.gather(tmp_path / "build" / "docs")
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    (tmp_path / "src").symlink_to(ROOT / "src")
    done = subprocess.run(
        [command, "build", "--strict"],
        cwd=tmp_path,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARNING" not in done.stdout + done.stderr
    site = tmp_path / "site"
    assert broken_links(site) == []
    assert shown_names() <= inventory(site)
