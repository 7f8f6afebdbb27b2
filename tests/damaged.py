"""Damaged files: flipped bits, cuts, changed lengths and fields; what a correction makes of them.

python tests/damaged.py footer --count 100000 --seed 1      a long run by hand; also: parquet, text
"""

import argparse
import collections
import copy
import csv
import gzip
import io
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import echocal
from echocal.correct import correct_files
from echocal.correct.parquet import thrift
from echocal.correct.results import RESULTS

MODEL = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})
EXTREMES = [
    0,
    1,
    -1,
    2,
    7,
    8,
    127,
    128,
    255,
    2**15,
    2**31 - 1,
    2**31,
    2**32,
    2**62,
    2**63 - 1,
    -(2**63),
    2**64,
]
Random = np.random.Generator


def parquet_seeds(random: Random) -> list[bytes]:
    """Small files that together have what a footer may have."""
    rows = 40
    echo = pa.array(np.round(random.uniform(2000, 20_000, rows), 1))
    plain = {
        "echo_us": echo,
        "temperature_C": pa.array(np.round(random.uniform(0, 30, rows), 1)),
        "id": pa.array([f"s{row % 3}" for row in range(rows)]).dictionary_encode(),
    }
    nested = {
        **plain,
        "list": pa.array([[1, 2], None, [], [3]] * (rows // 4)),
        "struct": pa.array([{"a": 1, "b": "x"}, None] * (rows // 2)),
        "gap": pa.array([None, 1.5] * (rows // 2)),
    }
    ways: list[tuple[dict[str, Any], dict[str, Any]]] = [
        (plain, {}),
        (plain, {"row_group_size": 9, "compression": "zstd", "write_page_index": True}),
        (nested, {"row_group_size": 25, "write_page_index": True, "data_page_version": "2.0"}),
        (nested, {"use_dictionary": False, "compression": "none", "write_page_checksum": True}),
        (plain, {"sorting_columns": [pq.SortingColumn(0)], "store_schema": False}),
    ]
    found = []
    for columns, options in ways:
        sink = io.BytesIO()
        pq.write_table(pa.table(columns), sink, **options)
        found.append(sink.getvalue())
    return found


def text_seeds(random: Random) -> list[bytes]:
    """Small texts of several kinds."""
    rows = [
        f"2026-01-02 03:04:{row:02},{random.uniform(2000, 20_000):.1f},{random.uniform(0, 30):.1f}"
        f',"a, ""{row}""",ü'
        for row in range(30)
    ]
    text = "\n".join(["time,echo_us,temperature_C,remark,kind", *rows, ""])
    plain = "\r\n".join(f"{random.integers(2000, 20_000)}\t{random.integers(30)}" for _ in range(30))
    several = 'echo_us;temperature_C;remark\n11660;20,5;"two\nlines"\n# comment\n11670;21,5;x\n11680;;\n'
    return [
        text.encode(),
        f"echo_us\ttemperature_C\r\n{plain}\r\n".encode(),
        several.encode(),
        gzip.compress(text.encode(), mtime=0),
        text.encode("cp1252"),
    ]


def spoiled(data: bytes, random: Random) -> bytes:
    """Some bytes changed, cut out, doubled, or put in."""
    out = bytearray(data)
    for _ in range(int(random.integers(1, 4))):
        at = int(random.integers(len(out) + 1))
        length = int(random.choice([1, 1, 2, 8, 100]))
        match int(random.integers(7)):
            case 0 | 1:
                if at < len(out):
                    out[at] ^= 1 << int(random.integers(8))
            case 2:
                out[at : at + length] = random.bytes(length)
            case 3:
                del out[at : at + length]
            case 4:
                out[at:at] = out[max(at - length, 0) : at]
            case 5:
                out[at:at] = bytes(length)
            case 6:
                del out[at:]
        if not out:
            out = bytearray(b"\0")
    return bytes(out)


def with_footer(data: bytes, footer: bytes) -> bytes:
    """A Parquet file with another footer."""
    length = int.from_bytes(data[-8:-4], "little")
    return data[: len(data) - 8 - length] + footer + len(footer).to_bytes(4, "little") + b"PAR1"


def spoiled_footer(data: bytes, random: Random) -> bytes:
    """A Parquet file whose footer is damaged: its bytes, its fields, or its length."""
    length = int.from_bytes(data[-8:-4], "little")
    footer = data[len(data) - 8 - length : len(data) - 8]
    match int(random.integers(5)):
        case 0 | 1:
            return with_footer(data, spoiled(footer, random))
        case 2 | 3:
            struct = thrift.read(footer)
            for _ in range(int(random.integers(1, 3))):
                _spoil(struct, random)
            return with_footer(data, thrift.write(struct))
        case _:
            told = int(random.choice([*EXTREMES[:13], length + 1, length - 1, len(data)])) % 2**32
            return data[:-8] + told.to_bytes(4, "little") + b"PAR1"


def _spoil(struct: thrift.Struct, random: Random) -> None:
    """Change one field, anywhere in a structure."""
    fields = list(_fields(struct))
    held, field = fields[int(random.integers(len(fields)))]
    kind, value = held[field]
    match int(random.integers(6)):
        case 0:
            del held[field]
        case 1:
            held[field] = (thrift.I64, EXTREMES[int(random.integers(len(EXTREMES)))])
        case 2:
            other, own = fields[int(random.integers(len(fields)))]
            held[field] = copy.deepcopy(other.get(own, (kind, value)))
        case 3:
            held[int(random.integers(1, 20))] = held.pop(field)
        case 4 if kind == thrift.LIST:
            element, values = value
            held[field] = (
                kind,
                (element, [*values, *values[: int(random.integers(3))]][int(random.integers(3)) :]),
            )
        case 4 | 5 if kind in thrift.INTEGERS:
            held[field] = (kind, value + int(random.choice([-100, -1, 1, 100])))
        case _:
            held[field] = (thrift.BINARY, random.bytes(5))


def _fields(struct: thrift.Struct) -> Iterator[tuple[thrift.Struct, int]]:
    for field, (kind, value) in list(struct.items()):
        yield struct, field
        if kind == thrift.STRUCT:
            yield from _fields(value)
        elif kind == thrift.LIST and value[0] == thrift.STRUCT:
            for one in value[1]:
                yield from _fields(one)


SIGNS = [b'"', b"\0", b"\r", b"\n", b"\x85", b"\x0c", b"\x1c", b"\xe2\x80\xa8", b"#", b"\xef\xbb\xbf"]
SIGNS += ["°µé;\n".encode(encoding) for encoding in ("latin-1", "utf-16", "utf-8")]


def spoiled_text(data: bytes, random: Random) -> bytes:
    """A text with flipped bytes, cuts, NULs, lone marks, or a piece in another encoding."""
    match int(random.integers(6)):
        case 0 | 1:
            return spoiled(data, random)
        case 2 | 3:
            at = int(random.integers(len(data)))
            return data[:at] + SIGNS[int(random.integers(len(SIGNS)))] + data[at:]
        case 4:
            return data[: int(random.integers(1, len(data) + 1))]
        case _:
            marks = [at for at, sign in enumerate(data) if sign in b'",\n;\t']
            at = marks[int(random.integers(len(marks)))]
            return data[:at] + data[at + 1 :]


KINDS: dict[str, tuple[Callable[[Random], list[bytes]], Callable[[bytes, Random], bytes], str]] = {
    "footer": (parquet_seeds, spoiled_footer, "parquet"),
    "parquet": (parquet_seeds, spoiled, "parquet"),
    "text": (text_seeds, spoiled_text, "csv"),
}


def tried(kind: str, count: int, random: Random, folder: Path, to: str = "") -> collections.Counter[str]:
    """Correct so many damaged files of a kind, and a sound one after them; what became of them.

    Raises
    ------
    AssertionError
        If the sound one is not corrected, or an output cannot be read or has other rows than were told.
    """
    seeds, damage, ending = KINDS[kind]
    sound = seeds(random)
    logs = folder / "in"
    logs.mkdir()
    for number in range(count):
        data = damage(sound[int(random.integers(len(sound)))], random)
        (logs / f"{number:07}.{ending}").write_bytes(data)
    (logs / f"z.{ending}").write_bytes(sound[0])
    summary = correct_files(logs, folder / "out", MODEL, processes=1)
    assert summary.results[f"z.{ending}"]["error"] is None
    assert len(summary.results) == count + 1
    found: collections.Counter[str] = collections.Counter()
    for place, result in summary.results.items():
        error = result["error"]
        if error is not None:
            foreseen = "please report it" not in error["text"]
            found["set aside" if foreseen else error["text"].replace(result["source"], "it")] += 1
            assert not (folder / "out" / place).exists()
            continue
        found["corrected"] += 1
        assert _rows(folder / "out" / place) == result["rows"], place
    return found


def _rows(path: Path) -> int:
    if path.suffix == ".parquet":
        return pq.ParquetFile(path).read(["corrected_distance_m"]).num_rows
    with path.open("rb") as file:
        zipped = file.read(2) == b"\x1f\x8b"
    with (gzip.open if zipped else open)(path, "rt", encoding="utf-8-sig", newline="") as file:
        text = file.read()
    place = text.index(RESULTS[0])
    rows = csv.reader(io.StringIO(text, newline=""), delimiter=text[place - 1], skipinitialspace=True)
    whole = next(row for row in rows if RESULTS[0] in row)
    count = 0
    for row in rows:
        if len(row) == len(whole):  # no comment, no blank line
            *_, distance, _, status, same = row
            assert (distance == "") == (status != "")
            assert status == same
            assert distance == "" or float(distance.replace(",", ".")) >= 0.0
            count += 1
    return count


def main() -> None:
    """A long run, in portions."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("kind", choices=KINDS)
    options.add_argument("--count", type=int, default=1000)
    options.add_argument("--seed", type=int, required=True)
    given = options.parse_args()
    total: collections.Counter[str] = collections.Counter()
    begun = time.monotonic()
    for portion in range(0, given.count, 500):
        with tempfile.TemporaryDirectory() as folder:
            random = np.random.default_rng([given.seed, portion])
            total += tried(given.kind, min(500, given.count - portion), random, Path(folder))
        print(portion, round(time.monotonic() - begun), dict(total), file=sys.stderr, flush=True)
    print(dict(total))


if __name__ == "__main__":
    main()
