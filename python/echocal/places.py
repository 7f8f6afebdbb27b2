"""Where a file is: a path of a disk, or an object in a store by its URL."""

import hashlib
from pathlib import Path
from typing import Any

from echocal.errors import DataError, reading
from echocal.objects import Object, is_url

__all__ = ["Place", "exists", "file_digest", "place_of", "size_of", "stamp"]

Place = Path | Object


def place_of(path: str | Path) -> Place:
    """A file of a disk, or an object."""
    return Object(str(path)) if is_url(path) else Path(path)


def stamp(place: Place) -> dict[str, Any]:
    """Size [B] and version (on a disk: time of the last change [ns]) of a file.

    Raises `DataError` if it cannot be read.
    """
    if isinstance(place, Object):
        return place.stamp()
    with reading(place):
        facts = place.stat()
    return {"size": facts.st_size, "mtime_ns": facts.st_mtime_ns}


def size_of(place: Place) -> int:
    """Size of a file [B]; 0 where it cannot be known, as its reader will say."""
    try:
        return int(stamp(place)["size"])
    except DataError:
        return 0


def exists(place: Place) -> bool:
    """Whether a file is there."""
    return place.exists() if isinstance(place, Object) else place.is_file()


def file_digest(place: Place) -> str:
    """SHA-256 of a file's content."""
    if isinstance(place, Object):
        return place.digest()
    with place.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
