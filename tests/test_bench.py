"""``echocal bench``: a ruler experiment at a terminal, by typing, by a pipe and by a serial port."""

import os
import pty
import re
import select
import subprocess
import sys
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.bench.lines import Port
from echocal.cli import app
from echocal.errors import DataError, UsageError

LATE = echocal.Model("linear", {"fixed_delay": {"delay": 85e-6}})
DEVICE = echocal.Model("linear")
ALIKE = {"fixed_delay", "zero_error"}  # at room temperature
AIR = 21.3
PROMPT = re.compile(
    r"put the target at ([\d.]+) m\. Distance by the ruler, in m \(Enter: [\w.]+; done ends\): $"
)
ENOUGH = re.compile(r"this is enough: .*done ends\): $")
TYPE = re.compile(r"then an empty line:\s*$")


def echoes(place: float, count: int, random: np.random.Generator) -> list[int]:
    """Echo times of a placement that is 1 mm off by chance [us]."""
    air = np.full(count, AIR)
    reading = LATE.indicate(np.full(count, place + random.normal(0, 1e-3)), temperature=air)
    echo = DEVICE.time_of_flight(reading + random.normal(0, 1e-3, count), temperature=air)
    return [round(1e6 * one) for one in echo]


def talk(folder: Path, words: list[str], answer: Callable[[str], str | None]) -> str:
    """What a person at a terminal sees; `answer` types a text when it knows what to say to what is there."""
    master, slave = pty.openpty()
    shell = {**os.environ, "COLUMNS": "300", "TERM": "dumb"}
    command = [sys.executable, "-m", "echocal", "bench", *words]
    process = subprocess.Popen(command, cwd=folder, stdin=slave, stdout=slave, stderr=slave, env=shell)
    os.close(slave)
    seen = ""
    while select.select([master], [], [], 120.0)[0]:
        try:
            part = os.read(master, 4096)
        except OSError:
            break
        if not part:
            break
        seen += part.decode()
        said = answer(seen)
        if said is not None:
            os.write(master, said.encode())
    assert process.wait(60) == 0, seen
    return seen


def named_delay(folder: Path, seen: str) -> pd.DataFrame:
    """The table, of an experiment that ended with the delay named."""
    assert "named: trigger, comparator" in seen or "named: the program adds a constant" in seen, seen
    assert (folder / "ruler-report.html").is_file()
    table = pd.read_csv(folder / "ruler.csv", comment="#")
    diagnosis = echocal.diagnose(table, **({} if "temperature_C" in table else {"at": {"temperature": AIR}}))
    assert diagnosis.verdict == "named"
    assert ALIKE & {diagnosis.causes[0].id, *diagnosis.causes[0].indistinguishable_from}
    return table


@pytest.mark.slow
@pytest.mark.statistical
def test_a_person_types_readings_until_it_is_enough(tmp_path: Path, random: np.random.Generator) -> None:
    places: list[float] = []
    state = {"answered": 0}

    def answer(seen: str) -> str | None:
        new = seen[state["answered"] :]
        said = None
        if found := PROMPT.search(new):
            places.append(float(found[1]))
            said = "one meter\n" if len(places) == 2 else f"{places[-1] + 0.004:.3f}\n"
        elif TYPE.search(new):
            lines = [str(one) for one in echoes(places[-1] + 0.004, 12, random)]
            said = "\n".join([*lines[:5], "Out of range", *lines[5:]]) + "\n\n"
        elif re.search(r"what are they\? \(echo_us,temperature_C\): $", new):
            said = "echo_us\n"
        elif new.endswith("such as 20+-2: "):
            said = "21.3+-0.5\n"
        elif ENOUGH.search(new):
            said = "\n"
        if said is not None:
            state["answered"] = len(seen)
        return said

    seen = talk(tmp_path, ["-n", "12"], answer)
    assert "'one meter' is no distance" in seen
    del places[1]  # where the answer made no sense
    assert places[:6] == [3.0, 0.3, 0.949, 3.0, 0.3, 0.949], "far and near take turns"
    assert "12 of 13 lines have an echo" in seen
    assert seen.count("so far ") == len(places) - 2
    table = named_delay(tmp_path, seen)
    assert len(table) == 13 * len(places), "a line without an echo is a row"
    assert table["echo_us"].isna().sum() == len(places)
    assert table["stand"].tolist() == np.repeat(np.arange(1, len(places) + 1), 13).tolist()
    assert table["distance_m"].iloc[0] == 3.004, "what the ruler says, not what was proposed"


@contextmanager
def board(lines: Callable[[], str], pause: float = 0.01) -> Iterator[str]:
    """A pty in the place of a serial port: the board starts when the port is opened."""
    master, slave = pty.openpty()
    name = os.ttyname(slave)
    tty.setraw(slave)
    os.close(slave)
    stop, hung_up = threading.Event(), select.poll()
    hung_up.register(master, select.POLLHUP)

    def send() -> None:
        while hung_up.poll(0) and not stop.wait(pause):
            pass
        stop.wait(0.5)  # a boot loader
        while not stop.wait(pause) and not hung_up.poll(0):
            if select.select([], [master], [], 0)[1]:
                os.write(master, lines().encode() + b"\r\n")

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    try:
        yield name
    finally:
        stop.set()
        sender.join()
        os.close(master)


@pytest.mark.slow
@pytest.mark.statistical
def test_a_board_sends_them_and_some_have_no_echo(tmp_path: Path, random: np.random.Generator) -> None:
    """The board tells its names when it starts; what it sends while the target is moved is no reading."""
    pytest.importorskip("serial")
    now: dict[str, float] = {"at": 0.0, "sent": 0}
    places: list[float] = []
    state = {"answered": 0}

    def line() -> str:
        now["sent"] += 1
        if now["sent"] <= 2:
            return ("rst:0x1 (POWERON_RESET)", "echo_us,temperature_C")[int(now["sent"]) - 1]
        place = now["at"]
        if not place or now["sent"] % 6 == 0:
            return f"0,{AIR}"
        return f"{echoes(place, 1, random)[0]},{AIR}"

    def answer(seen: str) -> str | None:
        new = seen[state["answered"] :]
        if ENOUGH.search(new):
            state["answered"] = len(seen)
            return "done\n"
        if found := PROMPT.search(new):
            state["answered"] = len(seen)
            now["at"] = 0.0  # the target is under way
            time.sleep(0.1)
            places.append(float(found[1]))
            now["at"] = places[-1]
            time.sleep(0.05)
            return "\n"
        return None

    with board(line) as port:
        seen = talk(tmp_path, ["--port", port, "-n", "10", "-o", "ruler.csv"], answer)
    table = named_delay(tmp_path, seen)
    assert places[:4] == [3.0, 0.3, 0.949, 3.0]
    per_place = table[table["echo_us"] > 0].groupby("stand")["echo_us"].agg(["count", "std"])
    assert (per_place["count"] == 10).all()
    assert (table["echo_us"] == 0).any(), "a row without an echo is kept"
    assert (per_place["std"] < 40).all(), "no reading of a placement comes from the one before"


def piped(words: list[str], text: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["bench", *words], input=text)
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        return getattr(done.exception, "exit_code", 99), str(done.exception)
    return done.exit_code, done.output


def test_a_pipe_is_asked_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert piped([], "") == (3, "no placement was measured, so ruler.csv is not written")
    numbers = "1.0\n" + "5800\n5801\n5803\n" + "\n"
    code, said = piped([], numbers)
    assert code == 3
    assert "--names echo_us,temperature_C" in said
    code, said = piped(["--names", "echo_us"], numbers)
    assert code == 3
    assert '--at "temperature=20+-2"' in said
    code, said = piped([], "1 yard\n")
    assert code == 2
    assert "'1 yard' is no distance" in said
    code, said = piped([], "150\n")
    assert code == 2
    assert "150 cm is 1.5 m" in said
    assert not list(tmp_path.iterdir())
    (tmp_path / "ruler.csv").write_text("mine\n")
    assert piped([], numbers)[0] == 2
    assert (tmp_path / "ruler.csv").read_text() == "mine\n"


def test_the_table_of_an_earlier_experiment_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["--names", "echo_us", "--at", "temperature=21"]
    piped(words, "2.0\n11990\n11987\n11991\n\n")
    earlier = Path("ruler.csv").read_text()
    assert "11990" in earlier
    code, said = piped(words, "1.0\n5800\n5801\n5803\n\n")
    assert code == 2
    assert "ruler.csv exists" in said
    assert "--force" in said
    assert Path("ruler.csv").read_text() == earlier
    piped([*words, "--force"], "1.0\n5800\n5801\n5803\n\n")
    assert "5800" in Path("ruler.csv").read_text()


@pytest.mark.parametrize(
    ("names", "silent"),
    [("echo_us,status", "0,7"), *(("echo_us", silent) for silent in ("0", "-1", "38000", "65535"))],
)
def test_a_first_placement_without_an_echo_is_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, names: str, silent: str
) -> None:
    monkeypatch.chdir(tmp_path)
    rest = silent.partition(",")[1:]
    text = f"2.0\n{3 * (silent + chr(10))}\n"
    for place in (2.0, 0.5, 1.0):
        text += f"{place}\n" + "".join(f"{5825 * place + n:.0f}{''.join(rest)}\n" for n in range(4)) + "\n"
    code, said = piped(["--names", names, "--at", "temperature=21"], text)
    assert code == 0, said
    assert "at 2 m 0 of 3 lines have an echo" in said
    assert "measure this place again" in said
    table = pd.read_csv("ruler.csv", comment="#")
    assert table["distance_m"].tolist() == 3 * [2.0] + 4 * [2.0] + 4 * [0.5] + 4 * [1.0]
    assert table["stand"].tolist() == 3 * [1] + 4 * [2] + 4 * [3] + 4 * [4]
    assert table["echo_us"].tolist()[:3] == 3 * [int(silent.split(",")[0])]


def test_a_placement_that_cannot_be_used_for_another_reason_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, said = piped(["--names", "echo_us,temperature_C"], "2.0\n" + 3 * "11990,\n" + "\n")
    assert code == 3
    assert "temperature_C" in said


@pytest.mark.parametrize("locale", ["C", "C.UTF-8"])
def test_a_byte_that_is_no_text_is_in_its_row_alone(tmp_path: Path, locale: str) -> None:
    near = b"".join(b"%d\n" % (3070 + n % 4) for n in range(24))
    text = b"0.5\n" + near + b"\xff3071\n\n"
    words = [sys.executable, "-m", "echocal", "bench", "--names", "echo_us", "--at", "temperature=21"]
    shell = {**os.environ, "LC_ALL": locale}
    done = subprocess.run(words, input=text, cwd=tmp_path, env=shell, capture_output=True, check=False)
    assert b"at 0.5 m 24 of 25 lines have an echo" in done.stderr, done.stderr
    assert b"Traceback" not in done.stderr
    rows = (tmp_path / "ruler.csv").read_text("utf-8").splitlines()
    assert rows[-1] == "0.5,1,\N{REPLACEMENT CHARACTER}3071"
    assert len(rows) == 2 + 25


def test_a_line_that_the_end_of_the_input_cuts_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["--names", "echo_us", "--at", "temperature=21"]
    piped(words, "2.0\n11990\n11987\n11991\n\n0.5\n3071\n3069\n307")
    assert pd.read_csv("ruler.csv", comment="#")["echo_us"].tolist() == [11990, 11987, 11991, 3071, 3069]
    whole = subprocess.run(
        [sys.executable, "-m", "echocal", "bench", *words, "--force"],
        input="0.5\n3071\n3069\n3070\n307", capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert "the input ends within the line '307': it is left out" in whole.stderr
    assert "at 0.5 m 3 of 3 lines have an echo" in whole.stderr


def test_the_printed_example_of_a_pipe_ends_in_a_diagnosis(tmp_path: Path) -> None:
    page = (Path(__file__).parents[1] / "docs" / "bench.md").read_text()
    example = next(block for block in re.findall(r"```\w+\n(.*?)```", page, re.DOTALL) if "printf" in block)
    bin_first = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    shell = {**os.environ, "PATH": bin_first}
    done = subprocess.run(["bash", "-c", example], cwd=tmp_path, env=shell, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert b"9 of 9 rows are used" in done.stdout


@pytest.mark.parametrize("span", ["3", "3:0.3", "0:3", "a:b", "0.3:300"])
def test_a_span_is_two_distances(span: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert piped(["--span", span], "")[0] == 2


def test_a_distance_of_the_device_is_its_reading(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, random: np.random.Generator
) -> None:
    """The ruler is the reference, whatever the sketch calls its numbers."""
    monkeypatch.chdir(tmp_path)
    text = ""
    for place in (2.0, 0.5, 1.0, 2.0, 0.5, 1.0):
        values = 100 * (place + 0.012 + random.normal(0, 1e-3, 10))
        text += (
            f"{place}\n"
            + ("distance_cm\n" if not text else "")
            + "".join(f"{v:.1f}\n" for v in values)
            + "\n"
        )
    code, said = piped(["--at", "temperature=21.3", "--span", "0.5:2"], text)
    assert code == 0, said
    table = pd.read_csv("ruler.csv", comment="#")
    assert list(table) == ["distance_m", "stand", "reading_cm"]
    assert len(table) == 60


def test_a_port_that_is_silent_or_absent_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("serial")
    with pytest.raises(DataError, match="cannot be opened"):
        Port("/dev/absent", 9600)
    master, slave = pty.openpty()
    with pytest.raises(DataError, match=r"no line came from .* in 0.2 s at 9600 baud"):
        Port(os.ttyname(slave), 9600, wait=0.2)
    os.close(master)
    os.close(slave)
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(UsageError, match=r"pip install 'echocal\[serial\]'"):
        Port("/dev/ttyUSB0", 9600)


@pytest.mark.parametrize("silent", ["0", "-1", "38000", "36012", "Out of range"])
def test_a_time_out_is_a_row_and_no_echo(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, random: np.random.Generator, silent: str
) -> None:
    monkeypatch.chdir(tmp_path)
    text, count = "", int(random.integers(1, 4))
    for place in (2.0, 0.5, 1.0, 2.0, 0.5, 1.0):
        lines = [str(one) for one in echoes(place, 8, random)] + count * [silent]
        text += f"{place}\n" + "".join(f"{line}\n" for line in random.permutation(lines)) + "\n"
    code, said = piped(["--names", "echo_us", "--at", "temperature=21.3"], text)
    assert code == 0, said
    assert said.count(f"8 of {8 + count} lines have an echo") == 6
    assert len(pd.read_csv("ruler.csv", comment="#")) == 6 * (8 + count), "it is a row of the table"


def test_an_echo_from_far_away_is_no_time_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A ranger for 10 m has echoes of 58 ms."""
    monkeypatch.chdir(tmp_path)
    text = "".join(
        f"{place}\n" + "".join(f"{5825 * place + n:.0f}\n" for n in range(4)) + "\n"
        for place in (9.0, 3.0, 6.5)
    )
    code, said = piped(["--names", "echo_us", "--at", "temperature=21", "--span", "2:9"], text)
    assert code == 0, said
    assert said.count("4 of 4 lines have an echo") == 3
