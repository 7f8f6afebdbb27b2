"""``echocal``, and ``python -m echocal``: the command line."""

import sys

from echocal import __version__

__all__ = ["main"]


def main() -> None:
    """Tell the version at once; run any other command."""
    if sys.argv[1:] == ["--version"]:
        print(f"echocal {__version__}")
        return
    from echocal.cli import main as run

    run()


if __name__ == "__main__":
    main()
