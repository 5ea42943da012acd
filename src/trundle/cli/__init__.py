"""The command line, `trundle VERB …`: one file per verb, each imported when it is called.

Exit codes: 0 done, 1 the robot did not reach the goal or a requirement was not met, 2 bad input, 130 stopped by Ctrl-C.
"""

from trundle.cli.entry import main

__all__ = ["main"]
