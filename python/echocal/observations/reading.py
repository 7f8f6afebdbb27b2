"""Read a table of measurements."""

import warnings
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from echocal.errors import DataWarning
from echocal.observations.options import ReadOptions
from echocal.observations.table import Observations

if TYPE_CHECKING:
    import pandas as pd

    from echocal.observations.found import Found, Join


def read_observations(
    source: Any,
    columns: Mapping[str, str] | str | Path | None = None,
    *,
    reading_speed: str | float | None = None,
    missing: Collection[Any] | Mapping[str, Any] = (),
    trust: Collection[str] = (),
    time_zone: str = ReadOptions.time_zone,
    skip_lines: int = ReadOptions.skip_lines,
    decimal: str | None = None,
    encoding: str = ReadOptions.encoding,
    time_format: str | None = None,
    at: Mapping[str, Any] | None = None,
    sheet: str | None = None,
    mount_height: float | None = None,
    reference: Any = None,
    reference_join: str = ReadOptions.reference_join,
) -> Observations:
    """Read a table of echoes: check it, convert it to SI units, account for every row.

    The names of columns include their units (``echo_us``, ``temperature_C``, ``humidity_percent``, ...);
    a name that begins like one of these and has no known unit is an error, never a guess. Other names are
    read by name and unit where both leave one meaning (``Temp (°C)``), and a note says so. Rows
    are never dropped and never reordered: a row that cannot be used has a reason code. In
    messages, row 1 is the first row below the header.

    Parameters
    ----------
    source : path, DataFrame, or mapping of str to array_like
        A log (docs/logs.md): delimited text, TOA5, a spreadsheet, JSON, lines of a serial monitor,
        ..., gzipped or not; a Parquet file; a table of pandas, polars, pyarrow or xarray; or columns by name.
    columns : mapping of str to str, or path of a TOML file, optional
        What other columns hold: a name (``{"SR_U": "reading_m"}``), a phrase (``"distance reading
        in m"``), ``"extra"`` for a column of another kind, or ``"ignore"``.
    reading_speed : str or float, optional
        Speed of sound that the firmware made readings with: a fixed speed [m/s] (``343``), an
        expression (``"331.3+0.606*T"``) or the name of a law. Default: ``"linear"``.
    missing : collection, or mapping of str to collection
        Error codes that mean "no value", in the file's units: for all columns (``[-9999]``) or by
        column (``{"Distance [mm]": [-500, 9999]}``).
    trust : collection of str
        Columns that are right although they look like another unit.
    time_zone : str
        IANA name of the zone of times without an offset.
    skip_lines : int
        Lines before the header, such as a logger's own first line.
    decimal : str, optional
        Decimal separator of a text file; default: seen in the file.
    encoding : str
        Encoding of a text file.
    time_format : str, optional
        How times are written, as of `datetime.strptime`: ``"%d.%m.%Y %H:%M"``. Default: seen in the column.
    at : mapping of str to float or str, optional
        Conditions that the table has no column for: ``{"temperature": "20+-2"}``, in degC, percent and hPa.
        What follows ``+-`` is the standard uncertainty.
    sheet : str, optional
        Sheet of a spreadsheet; default: the first with a table.
    mount_height : float, optional
        Height of the sensor above the zero of a level [m], where a column holds one (``level_m``,
        ``reference_level_m``): distance = mount height - level. Default: fitted, where the table has
        distances, too.
    reference : path or table, optional
        Another log that has the reference distances, or levels, at its own times: a tide gauge, a second
        logger. What `columns` says of a column is said of both logs.
    reference_join : {"interpolated", "nearest"}
        How its values come to the times of the rows; see docs/logs.md.

    Returns
    -------
    Observations
        As many rows as the source, in its order.

    Raises
    ------
    DataError
        If the source cannot be read, a unit is missing or unknown, a number is text, or a whole
        column is implausible.
    UsageError
        If a request names a column that is not there or no known quantity.

    Warns
    -----
    DataWarning
        If rows are unusable, with counts and reasons.

    Examples
    --------
    >>> import echocal
    >>> table = {"sensor": [2.071, 1.998, 1.899], "temperature_C": [0.0, 20.0, 50.0]}
    >>> data = echocal.read_observations(table, {"sensor": "distance reading in m"}, reading_speed="343")
    >>> data.echo_time
    array([0.0120758 , 0.01165015, 0.01107289])
    >>> len(data), list(data.conditions), data.notes
    (3, ['temperature'], ())
    """
    # slow import: only reading a table needs pandas
    from echocal.observations.assembly import Assembly
    from echocal.observations.at import conditions_at, sentences
    from echocal.observations.level import fitted
    from echocal.observations.numbers import Missing
    from echocal.observations.plan import make
    from echocal.observations.second_log import with_reference
    from echocal.observations.source import load

    how = ReadOptions(
        columns=columns,
        reading_speed=reading_speed,
        missing=missing,
        trust=trust,
        time_zone=time_zone,
        skip_lines=skip_lines,
        decimal=decimal,
        encoding=encoding,
        time_format=time_format,
        at=at,
        sheet=sheet,
        mount_height=mount_height,
        reference=reference,
        reference_join=reference_join,
    )
    table = load(source, how.layout, sheet=sheet)
    codes = Missing(missing)
    stated = conditions_at(how.at, table)
    asked, spread = how.requests_of(table.columns), None
    joins: dict[str, Join] = {}
    more: list[str] = []
    if reference is not None:
        table, asked, joins, spread, more = with_reference(table, asked, how)
    codes.refuse_unknown(table.columns)
    requests, found, said = understood(table, asked)
    requests, heights = fitted(table, requests, codes)
    planned = make(list(table.columns), requests, how.trust)
    trusted = {*how.trust, *found.sure}
    assembly = Assembly(table, planned, codes, trusted, time_zone, time_format=time_format)
    assembly.notes += [*found.notes, *said, *more, *heights]
    assembly.mark_corrupt(found.corrupt)
    observations = assembly.observations(reading_speed)
    quantities = {column: quantity for quantity, column in observations.source_names.items()}
    observations = replace(
        observations,
        mount_height_fitted=bool(heights),
        reference_join_uncertainty=spread,
        joined={quantities.get(name, name): join for name, join in {**found.joined, **joins}.items()},
        stated=stated,
        notes=(*observations.notes, *sentences(stated)),
    )
    if not observations.usable.all():
        warnings.warn("; ".join(observations.notes), DataWarning, stacklevel=2)
    return observations


def understood(table: "pd.DataFrame", asked: Mapping[str, str]) -> tuple[dict[str, str], "Found", list[str]]:
    """What columns hold by the user, the log, their names and units; what the log says; what to tell."""
    from echocal.observations.doubtful import doubtful_in, note_of
    from echocal.observations.found import found_in
    from echocal.observations.hints import completed

    found = found_in(table)
    doubtful = doubtful_in(table, {**found.requests, **asked})
    requests, said = completed(list(table.columns), asked, found, doubtful)
    several = note_of(table, set(asked))
    return requests, found, [*said, *([several] if several else [])]
