"""Anything may come in: it is read, or refused in one sentence, at once, whatever is damaged."""

import json
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.errors import DataError, UsageError
from echocal.observations.layout import Layout
from echocal.watch.parser import Parser

LONGEST = 10.0  # s of the processor for one input of some kilobytes
INPUTS = 25  # of each kind, in a run; the seed is another one in each commit

HEAD = "time,echo_us,temperature_C,note\n"
ROWS = "".join(f'2024-05-01T12:{n:02d}:00,{11_600 + n}.5,20.{n},"a, b"\n' for n in range(30))
TEXTS = (
    HEAD + ROWS,
    (HEAD + ROWS).replace(",", ";").replace(".", ","),
    "".join(f"12:00:{n:02d}.199 -> Distance: {n + 10}.5 cm  Temp = 20.{n} C\n" for n in range(30)),
    "".join(json.dumps({"t": n, "sonar": {"cm": 12.5 + n}, "temperature_C": 20}) + "\n" for n in range(30)),
    json.dumps([{"echo_us": 11_680 + n, "temperature_C": 20.0} for n in range(30)]),
    '"TOA5","a","b"\n"TIMESTAMP","echo_us","temperature_C"\n"TS","us","C"\n"","Smp","Smp"\n'
    + "".join(f'"2024-05-01 12:{n:02d}:00",{11_600 + n},20\n' for n in range(30)),
    "".join(f"tank,site=roof distance=12.{n},temperature=20.1 17000000000000000{n:02d}\n" for n in range(30)),
    "".join(f"(1{n}, 20.5, 'x')\n" for n in range(10, 40)),
)
PIECES = (
    b"", b"\0", b"\xff", b'"', b"'", b"\r", b"\n", b"\r\n", b",", b";", b"\t", b"#", b"{", b"[", b"}", b"-",
    b"e", b"nan", b"1e999", b"\xc2", b"\xef\xbb\xbf", b"=", b"(", b"(" * 300, b"[" * 2000, b" " * 3000,
    b"a b " * 900, b"9" * 400, b"\xe2\x88\x92", b"null", b":", b"\\ud800", b"99:99", b"2024-13-45",
)  # fmt: skip
"""The fixed corpus of what is put into a sound input."""


@contextmanager
def in_time() -> Iterator[None]:
    def stop(*_: object) -> None:
        message = f"more than {LONGEST} s"
        raise AssertionError(message)

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def damaged(data: bytes, random: np.random.Generator) -> bytes:
    """The same with some pieces in it, bits flipped, cut, or a part of it twice."""
    for _ in range(random.integers(1, 4)):
        begin, end = sorted(random.integers(len(data) + 1, size=2).tolist())
        kind = random.integers(5)
        if kind == 0:
            data = data[:begin] + PIECES[random.integers(len(PIECES))] + data[begin:]
        elif kind == 1 and data:
            place = min(begin, len(data) - 1)
            data = data[:place] + bytes([data[place] ^ 1 << random.integers(8)]) + data[place + 1 :]
        elif kind == 2:
            data = data[:begin]
        elif kind == 3:
            data = data[:end] + data[begin:end] + data[end:]
        else:
            data = data[:begin] + data[begin : end : 1 + int(random.integers(3))] + data[end:]
    return data


def corpus(random: np.random.Generator) -> Iterator[bytes]:
    """Each sound text with each piece at its begin; then fresh ones."""
    for number, piece in enumerate(PIECES):
        text = TEXTS[number % len(TEXTS)].encode()
        yield piece + text
        yield text[: len(text) // 2] + piece + text[len(text) // 2 :]
    for text in TEXTS:
        for _ in range(INPUTS // 3):
            yield damaged(text.encode(), random)


def told(work: Callable[[], object], given: object) -> None:
    """Run it: an error is one of ours, in words."""
    said = "read"
    try:
        with in_time():
            work()
    except (DataError, UsageError) as error:
        said = str(error)
    except Exception as error:
        message = f"{type(error).__name__} ({error}) of {given!r}"
        raise AssertionError(message) from error
    assert 0 < len(said) < 5000


MODEL = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})


@pytest.fixture(autouse=True)
def _own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.filterwarnings("ignore")
def test_texts(random: np.random.Generator) -> None:
    for data in corpus(random):
        Path("log.csv").write_bytes(data)
        told(lambda: echocal.read_observations("log.csv"), data)
        told(lambda: echocal.correct_files("log.csv", "out.csv", MODEL, processes=1), data)


def test_messages(random: np.random.Generator) -> None:
    for data in corpus(random):
        for only_json in (False, True):
            parser = Parser("log", Layout(), only_json=only_json)
            told(lambda p=parser, d=data: list(p.batches(d, final=True)), data)  # type: ignore[misc]


@pytest.mark.filterwarnings("ignore")
def test_footers(random: np.random.Generator) -> None:
    table = pa.table({"echo_us": np.linspace(11_000, 12_000, 50), "temperature_C": np.full(50, 20.5)})
    pq.write_table(table, "log.parquet", row_group_size=20)
    whole = Path("log.parquet").read_bytes()
    begin = len(whole) - 8 - int.from_bytes(whole[-8:-4], "little")
    for _ in range(4 * INPUTS):
        foot = damaged(whole[begin:-8], random)
        data = whole[:begin] + foot + len(foot).to_bytes(4, "little") + b"PAR1"
        Path("log.parquet").write_bytes(data)
        told(lambda: echocal.correct_files("log.parquet", "o.parquet", MODEL, processes=1), foot)


@pytest.mark.filterwarnings("ignore")
def test_model_files(random: np.random.Generator) -> None:
    MODEL.save("model.json")
    whole = Path("model.json").read_bytes()
    for number in range(4 * INPUTS):
        given = PIECES[number] + whole if number < len(PIECES) else damaged(whole, random)
        Path("model.json").write_bytes(given)
        told(lambda: echocal.Model.load("model.json"), given)


@pytest.mark.filterwarnings("ignore")
def test_options(random: np.random.Generator) -> None:
    Path("log.csv").write_text(HEAD + ROWS)
    names = (
        "reading_speed",
        "missing",
        "trust",
        "time_zone",
        "decimal",
        "encoding",
        "time_format",
        "columns",
    )
    for name in names:
        for piece in random.choice(np.array(PIECES, dtype=object), 8, replace=False):
            text = piece.decode("latin-1")
            given = [text] if name in ("missing", "trust") else {"note": text} if name == "columns" else text
            told(lambda n=name, g=given: echocal.read_observations("log.csv", **{n: g}), (name, given))  # type: ignore[misc]
