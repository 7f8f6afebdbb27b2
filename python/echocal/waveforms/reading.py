"""Captures from files: NumPy's .npy, WAV, and columns of lists in Parquet."""

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import wavfile

from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.waveforms.captures import positive

SAMPLE_RATE_COLUMN = "sample_rate_Hz"
"""Column or metadata of a Parquet file that holds the sample rate [Hz]."""

_TOLERANCE = 1e-9  # relative: a sample rate that is written in another way is the same one

Read = tuple[NDArray[Any], float | None]


def read_waveforms(
    path: str | Path, sample_rate: float | None = None, *, column: str | None = None
) -> tuple[NDArray[Any], float]:
    """Read captures and their sample rate.

    Parameters
    ----------
    path : str or Path
        What the file is, its first bytes tell:

        - ``.npy``: an array of real numbers, the last axis is the time. It has no sample rate.
        - WAV: each channel is a capture. Integers are scaled to -1 .. 1 of full scale.
        - Parquet: a column of lists of numbers of one length, one capture a row. The sample rate is in the
          column or in the metadata ``sample_rate_Hz``.
    sample_rate : float, optional
        Samples per second [Hz], for files that do not say it.
    column : str, optional
        Column of a Parquet file; needed where several hold lists of numbers.

    Returns
    -------
    waveform : ndarray, shape (..., N)
        Captures, in full scale (WAV) or as they are stored. A row of Parquet without a list is NaN.
    sample_rate : float
        Samples per second [Hz].

    Raises
    ------
    UsageError
        If the sample rate is missing or another than the file's, or the column is to be chosen.
    DataError
        If the file cannot be read, or does not hold captures of one length.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import numpy as np
    >>> import echocal
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "captures.npy"
    >>> np.save(path, np.zeros((3, 1000), np.int16))
    >>> waveform, sample_rate = echocal.read_waveforms(path, sample_rate=500e3)
    >>> waveform.shape, sample_rate
    ((3, 1000), 500000.0)
    """
    path = Path(path)
    given = None if sample_rate is None else positive("sample_rate", sample_rate, "Hz")
    waveform, stated = _reader(path)(path, column)
    if stated is not None and given is not None and abs(given - stated) > _TOLERANCE * stated:
        raise UsageError(
            f"sample_rate is {given:g} Hz, and {path} says {stated:g} Hz: leave it out, or give the samples "
            "as an array if the file is wrong"
        )
    rate = given if stated is None else stated
    if rate is None:
        raise UsageError(f"{path} has no sample rate; give it: {keyword('sample_rate')} [Hz]")
    return waveform, rate


def _reader(path: Path) -> Callable[[Path, str | None], Read]:
    """Return what reads a file, by its first bytes."""
    try:
        with path.open("rb") as file:
            begin = file.read(12)
    except FileNotFoundError:
        raise DataError(f"no file {path}") from None
    except (OSError, ValueError) as error:
        raise DataError(f"{path} cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if begin.startswith(b"\x93NUMPY"):
        return _npy
    if begin[:4] in (b"RIFF", b"RIFX", b"RF64") and begin[8:] == b"WAVE":
        return _wav
    if begin.startswith(b"PAR1"):
        return _parquet
    what = "is empty" if not begin else "is neither .npy nor WAV nor Parquet"
    raise DataError(f"{path} {what}; captures are read from these three")


def _refuse_column(path: Path, column: str | None) -> None:
    if column is not None:
        raise UsageError(f"{path} has no columns, and '{column}' is asked for; leave column out")


def _npy(path: Path, column: str | None) -> Read:
    _refuse_column(path, column)
    try:
        found = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise DataError(f"{path} cannot be read: {error}") from None
    except MemoryError:
        message = f"{path} has, by its header, more samples than fit into memory; split it, if that is right"
        raise DataError(message) from None
    if not found.size:
        raise DataError(f"{path} holds an array of the shape {found.shape}; nothing to time")
    if found.dtype.kind not in "fiu" or found.ndim == 0:
        raise DataError(
            f"{path} holds {found.dtype} of the shape {found.shape}; captures are arrays of real numbers"
        )
    return found, None


def _wav(path: Path, column: str | None) -> Read:
    _refuse_column(path, column)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", wavfile.WavFileWarning)  # of chunks that are no samples
            warnings.filterwarnings("error", "Reached EOF", wavfile.WavFileWarning)
            rate, samples = wavfile.read(path)
    except Exception as error:  # the reader has no error of its own for a file that is cut off
        message = f"{path} begins like WAV and cannot be read: {str(error) or type(error).__name__}"
        raise DataError(message) from None
    if not samples.size or not rate > 0:
        raise DataError(f"{path} has {len(samples)} samples at {rate} Hz; nothing to time")
    return np.ascontiguousarray(_of_full_scale(samples).T), float(rate)


def _of_full_scale(samples: NDArray[Any]) -> NDArray[Any]:
    """Samples in full scale; 8 bits have no sign, 24 bits stand in the upper ones of 32."""
    kind = samples.dtype
    if kind.kind == "u":
        half = 2.0 ** (8 * kind.itemsize - 1)
        return (samples - half) / half
    if kind.kind == "i":
        return samples / 2.0 ** (8 * kind.itemsize - 1)
    return samples


def _parquet(path: Path, column: str | None) -> Read:
    pa = _arrow()
    with _readable(path, pa), path.open("rb") as raw:
        schema = pa.parquet.read_schema(raw)
        name = list_column(path, schema, column)
        beside = [SAMPLE_RATE_COLUMN] if SAMPLE_RATE_COLUMN in schema.names else []
        table = pa.parquet.read_table(raw, columns=[name, *beside])
    rates = table.column(SAMPLE_RATE_COLUMN).unique().to_pylist() if beside else []
    told = {**(schema.metadata or {}), **(schema.field(name).metadata or {})}.get(SAMPLE_RATE_COLUMN.encode())
    return _rows(path, name, table.column(name), pa), _rate(path, [*rates, *([told] if told else [])])


def columns_beside(path: str | Path) -> dict[str, NDArray[Any]]:
    """Return the columns of a Parquet file beside its captures, without lists; none for other files.

    Raises `DataError` if it cannot be read.
    """
    path = Path(path)
    if _reader(path) is not _parquet:
        return {}
    pa = _arrow()
    with _readable(path, pa), path.open("rb") as raw:
        schema = pa.parquet.read_schema(raw)
        names = [field.name for field in schema if not pa.types.is_nested(field.type)]
        table = pa.parquet.read_table(raw, columns=names)
    return {name: table.column(name).to_numpy() for name in names if name != SAMPLE_RATE_COLUMN}


def full_scale_of(path: str | Path) -> float | None:
    """Return full scale in the unit that a file is read in: 1 for WAV; None for others, which do not say."""
    return 1.0 if _reader(Path(path)) is _wav else None


@contextmanager
def _readable(path: Path, pa: Any) -> Iterator[None]:
    try:
        yield
    except (OSError, pa.ArrowException) as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__)
        raise DataError(f"{path} begins like Parquet and cannot be read: {reason}") from None


def _rate(path: Path, stated: list[Any]) -> float | None:
    rates = sorted({_number(path, rate) for rate in stated})
    if len(rates) > 1:
        message = f"{path} has several sample rates ({rates[0]:g} to {rates[-1]:g} Hz); split it by them"
        raise DataError(message)
    return positive(SAMPLE_RATE_COLUMN, rates[0], "Hz") if rates else None


def _number(path: Path, rate: Any) -> float:
    try:
        return float(rate)
    except (TypeError, ValueError):
        told = rate.decode(errors="replace") if isinstance(rate, bytes) else rate
        raise DataError(f"{path}: {SAMPLE_RATE_COLUMN} is {told!r}, which is no number") from None


def list_column(path: Path, schema: Any, column: str | None) -> str:
    """Return the name of the column of captures.

    Raises `UsageError` if several columns could be meant, or the column asked for is none, and `DataError` if
    there is none.
    """
    candidates = [field.name for field in schema if _holds_numbers(field.type)]
    if column is not None:
        if column in candidates:
            return column
        lists = f"there are {', '.join(candidates)}" if candidates else "there is none"
        raise UsageError(f"{path} has no column '{column}' of lists of numbers; {lists}")
    if not candidates:
        raise DataError(f"{path} has no column of lists of numbers; its columns: {', '.join(schema.names)}")
    if len(candidates) > 1:
        raise UsageError(
            f"{path} has several columns of lists of numbers: {', '.join(candidates)}; "
            f"choose one: {keyword('column')}"
        )
    return str(candidates[0])


def _holds_numbers(kind: Any) -> bool:
    types = _arrow().types
    lists = types.is_list(kind) or types.is_large_list(kind) or types.is_fixed_size_list(kind)
    return bool(lists and (types.is_floating(kind.value_type) or types.is_integer(kind.value_type)))


def _rows(path: Path, name: str, column: Any, pa: Any) -> NDArray[Any]:
    """Lists of one length as rows; a row without a list, and a value that is null, is NaN."""
    lengths = pa.compute.list_value_length(column).to_numpy()
    known = np.flatnonzero(np.isfinite(lengths))
    if not len(known) or not lengths[known[0]]:
        raise DataError(f"{path}: column '{name}' has {len(lengths)} rows and no sample")
    count = int(lengths[known[0]])
    other = known[lengths[known] != count]
    if len(other):
        raise DataError(
            f"{path}: column '{name}' has {count} samples in row {known[0] + 1} and "
            f"{int(lengths[other[0]])} in row {other[0] + 1}; captures need one length: pad or cut them"
        )
    values = pa.compute.list_flatten(column).to_numpy()
    if len(known) == len(lengths):
        return np.asarray(values).reshape(len(lengths), count)
    rows = np.full((len(lengths), count), np.nan)
    rows[known] = np.asarray(values).reshape(len(known), count)
    return rows


def _arrow() -> Any:
    """Return the Arrow library. Raises `UsageError` if it is not installed."""
    try:
        for part in ("compute", "parquet"):
            import_module(f"pyarrow.{part}")
        return import_module("pyarrow")
    except ImportError:
        raise UsageError("Parquet needs pyarrow: pip install 'echocal[batch]'") from None
