"""Rules of arduino-lint for a library of the Library Manager, as far as they need no network.

Written from the rules that it publishes; it is a program in Go that no package of Python or Debian has.
"""

import re
from collections.abc import Iterator
from pathlib import Path

REQUIRED = (
    "name",
    "version",
    "author",
    "maintainer",
    "sentence",
    "paragraph",
    "category",
    "url",
    "architectures",
)
OPTIONAL = ("includes", "depends", "dot_a_linkage", "precompiled", "ldflags")
CATEGORIES = {"Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing"}
CATEGORIES |= {"Data Storage", "Data Processing", "Other"}
NAME = re.compile(r"(?!arduino)[a-z][a-z0-9_.-]{0,15}", re.IGNORECASE)
SEMVER = re.compile(r"(0|[1-9]\d*)(\.(0|[1-9]\d*)){2}(-[0-9A-Za-z.-]+)?(\+[0-9A-Za-z-]+(\.[0-9A-Za-z-]+)*)?")
BASE = re.compile(r"[a-zA-Z0-9][a-zA-Z0-9_.-]*")
KEYWORDS = {"KEYWORD1", "KEYWORD2", "KEYWORD3", "LITERAL1", "LITERAL2"}


def properties(text: str) -> dict[str, str]:
    """Fields of a `library.properties`."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    pairs = [line.partition("=") for line in lines]
    assert all(equals for _, equals, _ in pairs), "LP001: each line is a field"
    return {key.strip(): value.strip() for key, _, value in pairs}


def broken(folder: Path) -> list[str]:
    """Every rule that a library breaks, errors and warnings."""
    return [*_of_fields(folder), *_of_files(folder), *_of_sketches(folder)]


def _of_fields(folder: Path) -> Iterator[str]:
    fields = properties((folder / "library.properties").read_text())
    yield from (f"missing field {name}" for name in REQUIRED if not fields.get(name))
    yield from (f"misspelled field {name}" for name in fields.keys() - {*REQUIRED, *OPTIONAL})
    name = fields.get("name", "")
    if not NAME.fullmatch(name) or re.search("arduino|library", name, re.IGNORECASE):
        yield f"name {name!r}: at most 16 letters, no space, no 'Arduino', no 'library'"
    headers = {path.name for path in (folder / "src").glob("*.h")}
    if f"{name}.h" not in headers:
        yield "no header has the library's name"
    if not SEMVER.fullmatch(fields.get("version", "")):
        yield f"version {fields.get('version')!r} is no semantic version"
    if "arduino" in fields.get("maintainer", "").lower():
        yield "maintainer contains 'Arduino'"
    if fields.get("paragraph", "").startswith(fields.get("sentence", "") or "\0"):
        yield "paragraph repeats sentence"
    if fields.get("category") not in CATEGORIES - {"Other"}:
        yield f"category {fields.get('category')!r}"
    if not re.fullmatch(r"https?://[\w.-]+(/[\w./-]*)?", fields.get("url", "")):
        yield f"url {fields.get('url')!r} is none"
    if not re.fullmatch(r"\*|[a-z0-9_]+(, ?[a-z0-9_]+)*", fields.get("architectures", "")):
        yield f"architectures {fields.get('architectures')!r}"
    yield from (
        f"included {one} is absent" for one in fields.get("includes", "").split(",") if one not in headers
    )


def _of_files(folder: Path) -> Iterator[str]:
    names = {path.name for path in folder.iterdir()}
    if not any(re.fullmatch(r"readme\.(md|txt|rst|adoc)", name, re.IGNORECASE) for name in names):
        yield "no README"
    if not any(re.fullmatch(r"licen[sc]e(\.(md|txt))?", name, re.IGNORECASE) for name in names):
        yield "no license file"
    yield from (f"{name} beside src" for name in names & {"utility", ".development", ".gitmodules"})
    for path in folder.rglob("*"):
        if path.suffix == ".exe" or path.is_symlink():
            yield f"{path.name} is a program or a link"
        if path.suffix in {".ino", ".h", ".c", ".cpp"} and not BASE.fullmatch(path.name):
            yield f"{path.name} has a prohibited letter"
    for line in (folder / "keywords.txt").read_text().splitlines():
        word, tab, kind = line.partition("\t")
        if (
            line.strip()
            and not line.startswith("#")
            and not (word.isidentifier() and tab and kind in KEYWORDS)
        ):
            yield f"keywords.txt: {line!r}"


def _of_sketches(folder: Path) -> Iterator[str]:
    sketches = sorted(folder.rglob("*.ino"))
    if not sketches:
        yield "no examples"
    for path in sketches:
        if path.parts[len(folder.parts)] not in {"examples", "extras"}:
            yield f"stray sketch {path.name}"
        if path.stem != path.parent.name:
            yield f"{path.name} is not named as its folder"
        if re.search(r'#\s*include\s*[<"](arduino|ARDUINO)\.h', path.read_text()):
            yield f"{path.name} includes Arduino.h in wrong case"
