"""Run a fuzz target, or all of them, for some time.

PYTHONPATH=tests python -m fuzz cost_field --seconds 600
scripts/sanitize.sh --fuzz cost_field --seconds 600           with the kernels under ASan and UBSan
"""

from __future__ import annotations

import argparse

from fuzz.loop import play
from fuzz.targets import TARGETS


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"of {', '.join(TARGETS)}; none means all")
    parser.add_argument("--seconds", type=float, default=60.0, help="for each target")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    for name in options.targets or TARGETS:
        if name not in TARGETS:
            parser.error(f"no target {name!r}; there are {', '.join(TARGETS)}")
        rounds = play(TARGETS[name].one_round, seed=options.seed, seconds=options.seconds)
        print(f"{name}: {rounds} rounds, seed {options.seed}, {options.seconds:g} s, no finding", flush=True)


if __name__ == "__main__":
    main()
