import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of real measurements, which stands beside the repository and never in it."""
    beside = Path(__file__).parents[2] / "shared"
    folder = Path(os.environ.get("ECHOCAL_SHARED", beside))
    if not folder.is_dir():
        pytest.skip(f"real measurements are absent: no folder {folder} (set ECHOCAL_SHARED)")
    return folder
