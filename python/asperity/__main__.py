"""The command `asperity`: `python -m asperity` and the script of this name."""

import sys

from ._core import _command


def main() -> None:
    """Runs the command with the arguments of the process, and ends the process."""
    sys.exit(_command(sys.argv[1:]))


if __name__ == "__main__":
    main()
