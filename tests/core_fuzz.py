"""Call everything in `echocal._core` with arguments that make no sense, in a process of its own.

    python core_fuzz.py SEED SECONDS PLACE

First every argument of every function gets every wrong value once, then several at once, until the
time is over. Arrays end where readable memory ends, so that a read beyond them ends the process, as
does a call that takes too long. PLACE is a file that always holds the call under way.
"""

import itertools
import os
import random
import resource
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from core_fuzz_calls import CALLS, Call, guard

LONGEST = 5.0  # s of the processors, that one call may take
TOGETHER = 300  # calls with several wrong arguments, at least
MEMORY = 6 << 30  # bytes, that the process may ask for
SAME = ("every second", "the other order", "misaligned", "one byte off", "foreign order", "read-only")


def wrong(value: Any, chance: random.Random) -> Iterator[tuple[str, Any]]:
    """Every wrong value in place of a right one, each with a name."""
    yield "None", None
    yield "an object", object()
    match value:
        case np.ndarray():
            yield from wrong_arrays(value)
        case bool():
            yield from [("7", 7), ("text", "yes")]
        case int():
            each = [
                -1,
                0,
                value + 1,
                999,
                1 << 24,
                2**31,
                2**32 - 1,
                2**32,
                2**63 - 1,
                2**63,
                2**64 - 1,
                2**70,
            ]
            yield from ((str(one), one) for one in (*each, 1.5, float("nan"), "1", True))
        case float():
            each = [0.0, -1.0, 1e308, -1e308, 5e-324, float("nan"), float("inf"), -float("inf"), 10**400]
            yield from ((str(one)[:9], one) for one in (*each, 1j, "1"))
        case str() | bytes():
            yield from wrong_texts(value)
        case list() | tuple():
            yield from wrong_lists(list(value), chance)
        case dict():
            yield "empty", {}
            yield "a list", list(value)
            for key in value:
                yield f"no {key}", {k: v for k, v in value.items() if k != key}
                for name, one in wrong(value[key], chance):
                    yield f"{key}: {name}", {**value, key: one}
        case _:
            yield from [("0", 0), ("text", "x"), ("an array", np.ones(3)), ("a list", [1.0])]


def wrong_texts(value: str | bytes) -> Iterator[tuple[str, Any]]:
    each: list[Any] = ["", "\0", "é", "\ud800", "9" * 4000, "nan", "1e999", "cramer|linear", "-331*T", "x:y"]
    each += [b"", b"\0", b"\xff", b"9" * 4000, 7]
    if isinstance(value, bytes):
        each += [value[:-1], value + b"\r", value * 3, bytearray(value)]
    yield from ((ascii(one)[:12], one) for one in each)


def wrong_arrays(array: np.ndarray) -> Iterator[tuple[str, Any]]:
    kind, flat = array.dtype, array.reshape(-1)
    yield "shorter", guard(flat[:-1])
    yield "longer", guard(np.append(flat, flat[-1:]))
    yield "one row", guard(flat[:1])
    yield "empty", np.empty((0,) * array.ndim, kind)
    yield "0-d", np.array(flat[0])
    yield "2-D", guard(flat.reshape(2, -1) if flat.size % 2 == 0 else flat.reshape(1, -1))
    yield "4-D", guard(array.reshape(1, 1, 1, -1))
    yield "every second", np.repeat(array, 2, axis=-1)[..., ::2]
    yield "backwards", array[..., ::-1]
    yield "the other order", np.asfortranarray(array)
    packed = np.zeros(array.shape, [("gap", "i1"), ("it", kind)])
    packed["it"] = array
    yield "misaligned", packed["it"]
    shifted = np.zeros(array.nbytes + 1, "u1")[1:].view(kind).reshape(array.shape)
    shifted[...] = array
    yield "one byte off", shifted
    yield "foreign order", array.astype(kind.newbyteorder())
    fixed = array.copy()
    fixed.flags.writeable = False
    yield "read-only", fixed
    yield "one value", np.broadcast_to(flat[:1], array.shape)
    for other in ("f4", "f8", "i8", "i4", "u4", "u8", "?", "c16", "O", "U3", "M8[s]", "m8[s]", "V8"):
        if np.dtype(other) != kind:
            timely = other in ("M8[s]", "m8[s]", "V8")
            yield other, np.zeros(array.shape, other) if timely else array.astype(other)
    extremes: list[Any] = [0]
    if kind.kind in "iu":
        least, most = np.iinfo(kind).min, np.iinfo(kind).max
        extremes += [one for one in (1, array.size, 1 << 23, most, least) if one <= most]
    if kind.kind == "f":
        extremes += [np.nan, np.inf, -np.inf, np.finfo(kind).max, np.finfo(kind).smallest_subnormal, -1.0]
    for extreme in extremes:
        yield f"all {extreme}", guard(np.full(array.shape, extreme, kind))
        some = array.copy()
        some.reshape(-1)[-1] = extreme
        yield f"last {extreme}", guard(some)
    yield "a list", array.tolist()
    yield "ragged", [[1.0, 2.0], [3.0]]
    yield "masked", np.ma.array(array, mask=True)
    yield "a number", 1.0


def wrong_lists(values: list[Any], chance: random.Random) -> Iterator[tuple[str, Any]]:
    yield "empty", []
    yield "shorter", values[:-1]
    yield "longer", [*values, *values[-1:]]
    yield "twice", values + values
    yield "backwards", values[::-1]
    yield "nested", [values]
    yield "text", "text"
    yield "a dict", {"a": 1}
    yield "an array", np.ones(len(values))
    for at in sorted({0, len(values) - 1}) if values else []:
        for name, one in wrong(values[at], chance):
            yield f"[{at}] {name}", [*values[:at], one, *values[at + 1 :]]


def complaint(call: Call, expected: Any = None) -> str:
    """Call once: an exception is an answer, unless it is a panic; columns of several lengths need one.

    A result must be the expected one, where this is given.
    """
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        result = call.run()
    except Exception:
        return ""
    except BaseException as error:  # a panic is none
        return f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        call.restore()
    if expected is not None and not alike(result, expected):
        return "the result is another one"
    found = call.lengths()
    return f"accepts columns of lengths {found}" if len(found) > 1 else ""


def alike(one: Any, other: Any) -> bool:
    """Whether two results have the same numbers; objects of the core are not looked into."""
    match one, other:
        case (list() | tuple(), list() | tuple()):
            return len(one) == len(other) and all(map(alike, one, other))
        case (np.ndarray() | float(), np.ndarray() | float()):
            return np.array_equal(one, other, equal_nan=True)
    return True


def cases(chance: random.Random, end: float) -> Iterator[tuple[str, Call, Any]]:
    """Every wrong argument by itself, then several at once until the time is over.

    Each comes with the result that it must have, if any, where the values are right.
    """
    for name, make in CALLS.items():
        expected = make().run()
        for at, right in enumerate(make().arguments):
            for label, value in wrong(right, chance):
                call = make()
                call.arguments[at] = value
                yield f"{name}, argument {at}: {label}", call, expected if label.endswith(SAME) else None
    for count in itertools.count():
        if count >= TOGETHER and time.monotonic() > end:
            return
        name = chance.choice(list(CALLS))
        call, told = CALLS[name](), name
        for at in {chance.randrange(len(call.arguments)) for _ in range(3)} if call.arguments else ():
            label, call.arguments[at] = chance.choice(list(wrong(call.arguments[at], chance)))
            told += f", argument {at}: {label}"
        yield told, call, None


def main(seed: int, seconds: float, place: Path) -> int:
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    complaints, count = [], 0
    with place.open("wb", buffering=0) as under_way:
        for told, call, expected in cases(random.Random(seed), time.monotonic() + seconds):
            os.pwrite(under_way.fileno(), told.encode("ascii", "replace").ljust(2000), 0)
            found = complaint(call, expected)
            complaints += [f"{told}: {found}"] if found else []
            count += 1
    print(f"{count} calls, seed {seed}", *complaints, sep="\n")
    return len(complaints)


if __name__ == "__main__":
    sys.exit(min(main(int(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3])), 1))
