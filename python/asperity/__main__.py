"""The command `asperity`: `python -m asperity` and the script of this name."""

import signal
import sys

from ._core import _command


def main() -> None:
    """Runs the command with the arguments of the process, and ends the process."""
    # The command handles interrupts. The handler of Python, called as well, would raise KeyboardInterrupt
    # at the end.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_command(sys.argv[1:]))


if __name__ == "__main__":
    main()
