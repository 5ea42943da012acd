import re

import pytest

from support.command_line import Trundle


@pytest.mark.parametrize(
    ("arguments", "message", "verb"),
    [
        (
            "plan m.yaml --start -13 0",
            "--start -13 0: write numbers with commas, without spaces: --start -13,0",
            "plan",
        ),
        (
            "plan m.yaml --goal 1, 2, 3 --json",
            "--goal 1, 2, 3: write numbers with commas, without spaces: --goal 1,2,3",
            "",
        ),
        ("run m.yaml --start 1 2 3", "--start 1 2 3: write numbers with commas, without spaces: --start 1,2,3", "run"),
        ("plan a b", "unexpected argument 'b'", "plan"),
        (
            "map build w --resolution 5cm",
            "--resolution 5cm: must be a number; write it .*: 0.05",
            "map build",
        ),
        ("map build w --resolution fine", "--resolution fine: must be a number", "map build"),
        ("plan m.yaml --deadline 200ms", "--deadline 200ms: must be a number; write .* or Hz: 0.2", "plan"),
        ("plan m.yaml --seed x", "--seed x: must be an integer", "plan"),
        ("plan m.yaml --seed 1.5", "--seed 1.5: must be an integer", "plan"),
        ("run m.yaml --seed 1.5", "--seed 1.5: must be an integer", "run"),
        ("map biuld w", 'Unknown command "biuld". Did you mean "build"', "map"),
        ("plan m.yaml --strat 1,2", "Unknown option: --strat. Did you mean --start", "plan"),
    ],
)
def test_a_command_line_that_cannot_be_read(trundle: Trundle, arguments: str, message: str, verb: str) -> None:
    done = trundle(*arguments.split())
    assert done.code == 2
    first, *_, last = done.err.splitlines()
    assert re.match(f"trundle: {message}", first)
    assert last.startswith(f"See: trundle {verb}")
    assert last.endswith(" --help")
