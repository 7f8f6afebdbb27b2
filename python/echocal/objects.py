"""Files in an object store, by their URL: ``s3://bucket/path``, or any other that fsspec knows.

An object is there as a whole or not at all: a store shows it when its last byte has arrived. So nothing is
renamed here, and an object is fetched to a file, worked on there, and put back.
"""

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from echocal.errors import DataError, EchocalError, OutputError, UsageError

__all__ = ["Object", "is_url"]

_PIECE = 1 << 22  # bytes that are read at a time
_VERSIONS = ("ETag", "etag", "md5Hash", "mtime", "LastModified", "last_modified", "updated", "created")
"""What a store calls that which changes with the content, the best first."""


def is_url(path: object) -> bool:
    """Whether a path is a URL.

    Examples
    --------
    >>> is_url("s3://bucket/log.csv"), is_url("logs/log.csv")
    (True, False)
    """
    scheme, colon, _ = str(path).partition("://")
    return bool(colon) and scheme.replace("+", "").isalnum()


@dataclass(frozen=True, order=True)
class Object:
    """An object, or a folder of objects; it need not exist."""

    url: str

    def __str__(self) -> str:
        return self.url

    def __truediv__(self, below: object) -> "Object":
        return Object(f"{self.url.rstrip('/')}/{below}")

    @property
    def name(self) -> str:
        """Last part of the URL."""
        return self.url.rstrip("/").rpartition("/")[2]

    def exists(self) -> bool:
        """Whether there is an object of this name."""
        with self._reading() as (files, path):
            return bool(files.isfile(path))

    def is_folder(self) -> bool:
        """Whether there are objects below this name, and none of it."""
        with self._reading() as (files, path):
            return not files.isfile(path) and bool(files.isdir(path))

    def stamp(self) -> dict[str, Any]:
        """Size [B] and version of the content. Raises `DataError` if there is none, or the store refuses."""
        with self._reading() as (files, path):
            return _stamp(files.info(path))

    def stamps(self) -> dict[str, dict[str, Any]]:
        """Size [B] and version of each object below a folder by its name, from a list of the store."""
        with self._reading() as (files, path):
            found = files.find(path, detail=True)
        return {one[len(path.rstrip("/")) + 1 :]: _stamp(facts) for one, facts in found.items()}

    def digest(self) -> str:
        """SHA-256 of the content."""
        total = hashlib.sha256()
        with self._reading() as (files, path), files.open(path, "rb") as content:
            while piece := content.read(_PIECE):
                total.update(piece)
        return total.hexdigest()

    def read_text(self, most: int | None = None) -> str:
        """The content as a text in UTF-8; at most so many bytes from its beginning."""
        with self._reading() as (files, path):
            return bytes(files.cat_file(path, start=0, end=most)).decode("utf-8", errors="replace")

    def write_text(self, text: str) -> None:
        """Put a text in UTF-8."""
        with self._writing() as (files, path):
            files.pipe_file(path, text.encode())

    def fetch(self, file: Path) -> None:
        """Copy the content into a file."""
        with self._reading() as (files, path):
            files.get_file(path, str(file))

    def put(self, file: Path) -> None:
        """Make a file the content."""
        with self._writing() as (files, path):
            files.put_file(str(file), path)

    def below(self, pattern: str = "**") -> list[str]:
        """Names below a folder, of all objects or of those that match."""
        with self._reading() as (files, path):
            if pattern == "**":
                found = files.find(path)
            else:
                found = [one for one in files.glob(f"{path.rstrip('/')}/{pattern}") if files.isfile(one)]
            return sorted(one[len(path.rstrip("/")) + 1 :] for one in found)

    @contextmanager
    def _reading(self) -> Iterator[tuple[Any, str]]:
        try:
            yield _files(self.url)
        except EchocalError:
            raise
        except FileNotFoundError:
            raise DataError(f"no file {self.url}") from None
        except Exception as error:  # of the store: no rights, no network, ...
            raise DataError(f"{self.url} cannot be read: {error}") from None

    @contextmanager
    def _writing(self) -> Iterator[tuple[Any, str]]:
        try:
            yield _files(self.url)
        except EchocalError:
            raise
        except Exception as error:
            raise OutputError(f"{self.url} cannot be written: {error}") from None


def _stamp(facts: Mapping[str, Any]) -> dict[str, Any]:
    version = next((str(facts[name]) for name in _VERSIONS if facts.get(name)), "")
    return {"size": int(facts["size"]), "version": version}


def _files(url: str) -> tuple[Any, str]:
    """The store of a URL, and the path in it; what others write there is seen at once."""
    try:
        from fsspec.core import url_to_fs

        files, path = url_to_fs(url, use_listings_cache=False)
    except ImportError as error:
        raise UsageError(f"{url} needs a library: {error}; pip install 'echocal[s3]' for s3://") from None
    except ValueError as error:
        raise UsageError(f"{url} cannot be used: {error}") from None
    return files, path
