"""docs/evaluation.md: its files load, its commands and Python run, and they print what it shows."""

import re
import shlex
from pathlib import Path

import pytest
import yaml

from trundle.cli.entry import run_command
from trundle.evaluation.statistics import wilson

DOCS = Path(__file__).parents[2] / "docs"
GUIDE = (DOCS / "evaluation.md").read_text()


def blocks(language: str) -> list[str]:
    """The code of the guide in one language."""
    return re.findall(rf"```{language}\n(.*?)```", GUIDE, flags=re.DOTALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files of the guide."""
    folder = tmp_path_factory.mktemp("guide")
    for text in blocks("yaml"):
        name = re.match(r"# (\S+\.ya?ml)\n", text)
        assert name is not None, text
        path = folder / name[1]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


def test_the_commands_run_and_print_what_the_guide_shows(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    for line in "".join(blocks("sh")).splitlines():
        command, _, comment = line.partition(" #")
        expected = int(comment.split()[-1]) if "exit code" in comment else 0
        assert run_command(shlex.split(command)[1:]) == expected, line
    printed = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    for line in "".join(blocks("text")).splitlines():
        if "SPL" not in line and "clearance" not in line:
            assert " ".join(line.split()) in printed, line
    assert (folder / "runs" / "rooms" / "report.html").is_file()


def test_the_python_runs(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("duckdb")
    monkeypatch.chdir(folder)
    (code,) = blocks("python")
    exec(code, {})
    assert "20 of 20 episodes" in capsys.readouterr().out


def test_the_job_for_github_uses_the_actions_and_permissions_of_our_own(folder: Path) -> None:
    job = yaml.safe_load((folder / ".github" / "workflows" / "gate.yml").read_text())
    ours = yaml.safe_load((DOCS.parent / ".github" / "workflows" / "tests.yml").read_text())
    assert job["permissions"] == ours["permissions"]
    (steps,) = (entry["steps"] for entry in job["jobs"].values())
    assert {step["uses"] for step in steps[:2]} <= {
        step["uses"] for entry in ours["jobs"].values() for step in entry["steps"] if "uses" in step
    }
    assert "trundle evaluate gate.yaml -o runs/gate" in [step.get("run") for step in steps]


def test_the_numbers_of_episodes_are_the_least_that_pass() -> None:
    rows = re.findall(r"^\| `success>=(0\.\d+)` \| ([\d,]+) \|$", GUIDE, re.MULTILINE)
    assert len(rows) == 4
    for share, text in rows:
        count = int(text.replace(",", ""))
        assert wilson(count, count)[0] >= float(share) > wilson(count - 1, count - 1)[0]


def test_its_picture_is_small() -> None:
    assert (DOCS / "images" / "evaluation_report.png").stat().st_size < 250_000
