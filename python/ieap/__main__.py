"""The program itself: ``python -m ieap run CAMPAIGN`` does what ``ieap run CAMPAIGN`` does."""

import signal
import sys

from . import _native


def main() -> int:
    # The engine listens to Ctrl-C by itself; Python's handler would wait until a verb is done.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.program(["ieap", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
