"""What one visit of the page does with one log. It draws nothing."""

import io
import shutil
import tempfile
import warnings
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from echocal.correct import correct
from echocal.diagnose import Diagnosis, diagnose
from echocal.diagnose.progress import Progress
from echocal.errors import DomainWarning, UsageError
from echocal.firmware import generate
from echocal.keywords import command_line
from echocal.model.document import text_of
from echocal.observations.inspection import Inspection, inspect_log
from echocal.observations.names import EXTRA, IGNORE
from echocal.observations.options import ReadOptions
from echocal.observations.units import NAMES
from echocal.outputs import csv_text
from echocal.report.html import report_page

CHOICES = ("", *NAMES, EXTRA, IGNORE)
"""What a column can be taken for; nothing, where it is no quantity."""


@dataclass
class Session:
    r"""A log and what was made of it. The file stays in a folder of its own until `close`.

    Examples
    --------
    >>> session = Session()
    >>> rows = "".join(f"{1.5 + 0.001 * (row % 3)},20\n" for row in range(40))
    >>> session.open("desk.csv", ("reading_m,temperature_C\n" + rows).encode())
    >>> session.taken_for
    {'reading_m': 'reading_m', 'temperature_C': 'temperature_C'}
    >>> session.diagnose(reference_distance=1.5)
    >>> sorted(session.products())
    ['desk corrected.csv', 'desk model.json', 'desk report.html']
    >>> session.close()
    """

    folder: Path = field(default_factory=lambda: Path(tempfile.mkdtemp(prefix="echocal-")))
    name: str = ""  # name of the log
    inspection: Inspection | None = None  # what its columns are taken for
    diagnosis: Diagnosis | None = None
    notes: list[str] = field(default_factory=list)
    """What the last firmware assumes beyond the range of its law."""
    _stated: dict[str, str] = field(default_factory=dict)
    _asked: dict[str, Any] = field(default_factory=dict)
    _beside: dict[str, Any] = field(default_factory=dict)

    def close(self) -> None:
        """Remove the folder."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def open(self, name: str, content: bytes) -> None:
        """Take a log in place of the one before, and look at it.

        Raises `DataError` if it cannot be read as a table of any kind.
        """
        self.name, self.inspection, self.diagnosis = Path(name).name, None, None
        self._stated, self._beside = {}, {}
        self._path.write_bytes(content)
        self.inspection = inspect_log(self._path, self._options())

    def take(self, column: str, request: str) -> None:
        """Say what a column holds, one of `CHOICES`, and look at the log again."""
        self._stated[column] = request or EXTRA
        self.diagnosis = None
        self.inspection = inspect_log(self._path, self._options())

    def say(
        self, *, temperature: str = "", mount_height: float | None = None, reading_speed: str = ""
    ) -> None:
        """Say what no column holds, and look at the log again.

        The temperature of the air [degC] is as ``20+-2``, empty where a column has it; the height of the
        sensor above the zero of a level is in m; the law or the speed [m/s] that the readings were made with
        is empty for the default. Raises `UsageError` if it is no number, or nothing asks for it.
        """
        told: dict[str, Any] = {"at": {"temperature": temperature} if temperature.strip() else None}
        told |= {"mount_height": mount_height, "reading_speed": reading_speed.strip() or None}
        self._beside = {name: own for name, own in told.items() if own is not None}
        self.diagnosis = None
        self.inspection = inspect_log(self._path, self._options())

    @property
    def taken_for(self) -> dict[str, str]:
        """What each column is taken for."""
        return {column.name: column.proposal.request for column in self._looked_at.columns}

    def diagnose(self, progress: Progress | None = None, **request: Any) -> None:
        """Diagnose the log as its columns are taken now; `request` is as of `echocal.diagnose`."""
        self.diagnosis = None
        self._asked = {name: value for name, value in request.items() if value is not None}
        self.diagnosis = diagnose(self._looked_at.table, progress=progress, **self._asked, **self._reading())

    def products(self) -> dict[str, str]:
        """The report, the model and the corrected table, by the names of their files."""
        found, stem = self._diagnosed, Path(self.name).stem
        read = {"reading_speed": self._asked.get("reading_speed"), **self._reading()}
        corrected = correct(self._looked_at.table, found.model, **read)
        return {
            f"{stem} report.html": report_page(found, self.name, self._command()),
            f"{stem} model.json": text_of(found.model),
            f"{stem} corrected.csv": csv_text(corrected.table),
        }

    def firmware(self, target: str, **request: Any) -> bytes:
        """C that follows the model, as a zip archive; `request` is as of `echocal.firmware.generate`.

        Raises `BoundError` if no form meets the largest error.
        """
        with warnings.catch_warnings(action="always", category=DomainWarning, record=True) as caught:
            made = generate(self._diagnosed.model, target, **request)
        self.notes = list(dict.fromkeys(str(one.message) for one in caught))
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as written:
            for name, text in made.files.items():
                written.writestr(name, text)
        return archive.getvalue()

    @property
    def _path(self) -> Path:
        return self.folder / (self.name or "log")

    @property
    def _looked_at(self) -> Inspection:
        if self.inspection is None:
            raise UsageError("there is no log yet: choose one first")
        return self.inspection

    @property
    def _diagnosed(self) -> Diagnosis:
        if self.diagnosis is None:
            raise UsageError("the log is not diagnosed yet")
        return self.diagnosis

    def _options(self) -> ReadOptions:
        return ReadOptions(columns=self._stated, **self._beside)

    def _reading(self) -> dict[str, Any]:
        looked_at = self._looked_at
        return {"columns": looked_at.requests, "missing": looked_at.missing, **self._beside}

    def _command(self) -> str:
        """The command that makes the same report."""
        looked_at = self._looked_at
        columns = [f"{name}={request}" for name, request in looked_at.requests.items()]
        missing = [f"{name}={code}" for name, codes in looked_at.missing.items() for code in codes]
        at = [f"{name}={own}" for name, own in self._beside.get("at", {}).items()]
        height = self._beside.get("mount_height")
        options = {
            **self._asked,
            "at": at,
            "mount_height": height,
            "reading_speed": self._beside.get("reading_speed"),
            "column": columns,
            "missing": missing,
            "report": "report.html",
        }
        return command_line("diagnose", self.name, **options)
