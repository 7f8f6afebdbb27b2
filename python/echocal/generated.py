"""What `echocal.firmware.generate` returns: files, report, and the bit-exact twin."""

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal import _core
from echocal.checksums import CHECKSUMS, list_of
from echocal.errors import UsageError
from echocal.keywords import keyword
from echocal.outputs import replace_all

__all__ = ["Firmware"]


@dataclass(frozen=True)
class Firmware:
    """A generated function, its proof and its bit-exact twin.

    Attributes
    ----------
    files : dict of str to str
        Text by path: ``echocal_golden.csv``, ``report.json`` and the files of the packaging, for plain C
        ``echocal_correction.h``, ``echocal_correction.c`` and the program of ``selftest``. With another name
        than ``echocal`` they begin with that.
    report : dict
        What was proven, as in ``report.json``.
    """

    files: dict[str, str]
    report: dict[str, Any]
    _twin: _core.Firmware = field(repr=False)

    @property
    def unit(self) -> str:
        """Unit of what the function returns."""
        return str(self.report["device"]["output"]["unit"])

    def outputs(
        self,
        echo: ArrayLike,
        temperature_code: ArrayLike,
        humidity_code: ArrayLike | None = None,
        further_code: ArrayLike | None = None,
    ) -> NDArray[np.int32]:
        """Return the outputs of the C function, bit for bit, in its `unit`.

        Parameters
        ----------
        echo : array_like of int, shape (...)
            Echo time codes [us]; ticks of the timer if a tick is not 1 us.
        temperature_code : array_like of int, shape (...)
            Temperature codes, broadcast against `echo`.
        humidity_code : array_like of int, shape (...), optional
            Humidity codes, if the function takes them.
        further_code : array_like of int, shape (...), optional
            Codes of the further input, if the function takes one.

        Returns
        -------
        ndarray of int32, shape (...)
            Distance in `unit`; the smallest ``int32`` for codes out of range.

        Raises
        ------
        UsageError
            If codes are not integers or do not broadcast; if codes of a condition are missing or superfluous.
        """
        return self._evaluated(echo, temperature_code, humidity_code, further_code)[0]

    def status(
        self,
        echo: ArrayLike,
        temperature_code: ArrayLike,
        humidity_code: ArrayLike | None = None,
        further_code: ArrayLike | None = None,
    ) -> NDArray[np.uint8]:
        """Return whether the function accepts codes, or why not, as its ``echocal_status`` does.

        Parameters are those of `outputs`.

        Returns
        -------
        ndarray of uint8, shape (...)
            Position in ``report["statuses"]``; 0 where the output is a distance.

        Raises
        ------
        UsageError
            In the cases of `outputs`.

        Examples
        --------
        >>> from echocal import Model, firmware
        >>> made = firmware.generate(Model("cramer"), temperature=(0.5, -20, 60))
        >>> [made.report["statuses"][code] for code in made.status([0, 50, 11_690, 30_000], 40)]
        ['no echo', 'too near', 'ok', 'too far']
        """
        return self._evaluated(echo, temperature_code, humidity_code, further_code)[1]

    def filtered(
        self, distances: ArrayLike, statuses: ArrayLike
    ) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
        """Return what the median filter of the firmware gives for measurements in order, from a new state.

        Parameters
        ----------
        distances : array_like of int, shape (n,)
            What `outputs` returned, in its `unit`.
        statuses : array_like of int, shape (n,)
            What `status` returned.

        Returns
        -------
        outputs : ndarray of int32, shape (n,)
            Medians; the smallest ``int32`` where there is none.
        statuses : ndarray of uint8, shape (n,)
            0 where there is a median; 254: too few distances yet; 255: too few of them within the gate.
            Others: the status of the last measurement without a distance.

        Raises
        ------
        UsageError
            If the firmware has no filter, or the measurements are not integers that the C function takes.

        Examples
        --------
        >>> from echocal import Model, firmware
        >>> made = firmware.generate(Model("cramer"), temperature=(0.5, -20, 60), median=3)
        >>> [column.tolist() for column in made.filtered([1000, 9000, 1002, -(2**31)], [0, 0, 0, 1])]
        [[-2147483648, 1000, 1002, 1002], [254, 0, 0, 0]]
        """
        columns: list[Any] = []
        for name, given, kind in (("distances", distances, np.int32), ("statuses", statuses, np.uint8)):
            column, limits = np.asarray(given), np.iinfo(kind)
            if column.ndim != 1 or column.dtype.kind not in "iu":
                raise UsageError(
                    f"{name} has dtype {column.dtype} and shape {column.shape}: give a column of integers"
                )
            outside = np.flatnonzero((column < limits.min) | (column > limits.max))
            if len(outside):
                row = int(outside[0])
                raise UsageError(
                    f"{name} is {column[row]} in row {row}, outside {limits.min} .. {limits.max}"
                )
            columns.append(np.ascontiguousarray(column, dtype=kind))
        if len(columns[0]) != len(columns[1]):
            lengths = f"{len(columns[0])} distances and {len(columns[1])} statuses"
            raise UsageError(f"{lengths}: give one of each for a measurement")
        found = self._twin.filtered(*columns)
        if found is None:
            raise UsageError(f"this firmware has no median filter: generate it with {keyword('median', 5)}")
        return found

    def _evaluated(
        self,
        echo: ArrayLike,
        temperature_code: ArrayLike,
        humidity_code: ArrayLike | None,
        further_code: ArrayLike | None,
    ) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
        """Outputs and statuses."""
        device = self.report["device"]
        given = {device["echo"]["name"]: np.asarray(echo), "temperature_code": np.asarray(temperature_code)}
        others = {axis["quantity"] == "relative_humidity": axis["name"] for axis in device["conditions"][1:]}
        for humid, codes in ((True, humidity_code), (False, further_code)):
            if (humid in others) != (codes is not None):
                what = "humidity_code" if humid else others.get(False, "further_code")
                raise UsageError(f"this function takes {'a' if humid in others else 'no'} {what}")
            if codes is not None:
                given[others[humid]] = np.asarray(codes)
        for name, code in given.items():
            if code.dtype.kind not in "iu":
                raise UsageError(f"{name} must be integer codes, but has dtype {code.dtype}")
        try:
            codes = np.broadcast_arrays(*(code.astype(np.int64) for code in given.values()))
        except ValueError:
            shapes = ", ".join(f"{name} {code.shape}" for name, code in given.items())
            raise UsageError(f"shapes do not broadcast: {shapes}") from None
        flat = [np.ascontiguousarray(code).reshape(-1) for code in codes]
        outputs, statuses = self._twin.evaluate(flat)
        return outputs.reshape(codes[0].shape), statuses.reshape(codes[0].shape)

    def distance_um(
        self,
        echo_us: ArrayLike,
        temperature_code: ArrayLike,
        humidity_code: ArrayLike | None = None,
        further_code: ArrayLike | None = None,
    ) -> NDArray[np.int32]:
        """Return the outputs of a function that counts micrometers [um], as `outputs` does.

        Returns
        -------
        ndarray of int32, shape (...)
            Distance [um]; the smallest ``int32`` for codes out of range.

        Raises
        ------
        UsageError
            If the function returns another unit, and in the cases of `outputs`.
        """
        if self.unit != "um":
            raise UsageError(f"this function returns {self.unit}: take outputs(...)")
        return self.outputs(echo_us, temperature_code, humidity_code, further_code)

    def ranked_by(self) -> tuple[int, int]:
        """Return bytes and cycles by the cost model of the search; they are not measured.

        Returns
        -------
        tuple of int
            Bytes, cycles or instructions.
        """
        return self._twin.ranked_by()

    def save(self, directory: str | os.PathLike[str]) -> list[Path]:
        """Write the files into a directory. A missing directory is created.

        Returns
        -------
        list of Path
            The files, and ``SHA256SUMS`` with their checksums. Files that an earlier call generated into the
            same directory stay in that list, unless they were edited since.

        Raises
        ------
        UsageError
            If the directory cannot be written.
        """
        folder = Path(directory)
        return replace_all(folder, {**self.files, CHECKSUMS: list_of(self.files, folder)})
