"""The committed script and style of the page are what its sources build to."""

from __future__ import annotations

import gzip
import shutil
import subprocess
from importlib.resources import files
from pathlib import Path

import pytest

from trundle import page

WEB = Path(__file__).parents[2] / "web"
NAMES = ("page.js", "page.css", "LICENSES.txt")


def asset(name: str) -> str:
    return files("trundle").joinpath("page", "assets", name).read_text(encoding="utf-8")


def test_the_sources_build_to_the_committed_bundle(tmp_path: Path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    if not (WEB / "node_modules" / "esbuild").is_dir():
        pytest.skip("the libraries of the page are not installed: make web installs them")
    subprocess.run([node, str(WEB / "build.mjs"), str(tmp_path)], check=True, timeout=120)
    changed = [name for name in NAMES if (tmp_path / name).read_text(encoding="utf-8") != asset(name)]
    assert not changed, f"{changed} differ from what web/ builds to: make web, then commit them"


def test_the_bundle_can_stand_inside_a_script_element_and_names_no_other_host() -> None:
    script, style = asset("page.js"), asset("page.css")
    assert "</script" not in script.lower()
    assert "<!--" not in script
    assert "</style" not in style.lower()
    assert "url(http" not in style.replace("'", "").replace('"', "")
    assert "sourceMappingURL" not in script


def test_the_licences_of_the_libraries_are_kept() -> None:
    licences = asset("LICENSES.txt")
    assert licences.count("Permission is hereby granted, free of charge") == 2
    for name in ("three", "uplot"):
        assert f"---- {name} " in licences


def test_the_lock_names_no_host() -> None:
    lock = (WEB / "package-lock.json").read_text(encoding="utf-8")
    assert '"resolved"' not in lock
    assert lock.count('"integrity"') > 10


def test_the_page_is_one_request_of_at_most_250_kb() -> None:
    html = page.render({"mode": "live"}, title="trundle")
    assert len(gzip.compress(html.encode(), 6)) <= 250_000
