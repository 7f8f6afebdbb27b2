"""``python -m echocal`` is ``echocal``."""

from echocal.cli import main

if __name__ == "__main__":
    main()
