"""The command line program."""

import signal
import sys

from . import _native
from ._values import quiet_window_system


def main() -> None:
    """Runs ``anamorph`` on the process's arguments, and ends the process."""
    # the program has its own way to end on Ctrl-C
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    with quiet_window_system():
        code = _native.program(["anamorph", *sys.argv[1:]])
    sys.exit(code)
