"""What a user has is not destroyed: inputs never, other files only with --force, old files not by halves."""

import gzip
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.outputs import replacing

EXAMPLES = Path(__file__).parents[1] / "examples"
Run = Callable[..., tuple[int, str]]

OUTPUTS = {
    "diagnose": ("diagnose", "w.csv", "--save-model", "OUT"),
    "diagnose json": ("diagnose", "w.csv", "--json", "OUT"),
    "calibrate": ("calibrate", "w.csv", "--fit", "zero_error", "--law", "linear", "--out", "OUT"),
    "calibrate json": ("calibrate", "w.csv", "--fit", "zero_error", "--law", "linear", "--json", "OUT"),
    "verify": ("verify", "w.csv", "--maximum-permissible-error-mm", "200", "--json", "OUT"),
    "correct": ("correct", "w.csv", "--law", "linear", "--out", "OUT"),
    "correct json": ("correct", "w.csv", "--law", "linear", "-o", "corrected.csv", "--json", "OUT"),
}
"""A command for each output, OUT in the place of its name."""


@pytest.fixture
def run(run: Run) -> Run:
    """Run a command line beside a table w.csv: exit code and stderr."""
    shutil.copy(EXAMPLES / "study_table2.csv", "w.csv")
    return run


def words(name: str, out: str, *more: str) -> list[str]:
    return [out if word == "OUT" else word for word in OUTPUTS[name]] + ["-q", *more]


def names() -> set[str]:
    return {path.name for path in Path().iterdir()}


@pytest.mark.parametrize("way", ["itself", "path", "symbolic link", "hard link"])
@pytest.mark.parametrize("name", OUTPUTS)
def test_an_input_is_never_an_output(name: str, way: str, run: Run) -> None:
    out = {"itself": "w.csv", "path": "../" + Path.cwd().name + "/w.csv"}.get(way, "other.csv")
    if way == "symbolic link":
        Path(out).symlink_to("w.csv")
    elif way == "hard link":
        os.link("w.csv", out)
    before = Path("w.csv").read_bytes(), names()
    for force in ((), ("--force",)):
        code, told = run(*words(name, out, *force))
        assert code == 2
        assert told.startswith(f"echocal: {words(name, out)[-3]} {out} is an input of this command (w.csv")
        assert told.count("\n") == 1
    assert (Path("w.csv").read_bytes(), names()) == before


@pytest.mark.parametrize("option", ["--model", "--base", "--column"])
def test_whatever_a_command_reads_is_an_input(option: str, run: Run) -> None:
    echocal.Model("linear").save("m.json")
    Path("map.toml").write_text('reading_m = "reading in m"\n')
    read = "map.toml" if option == "--column" else "m.json"
    command = {
        "--model": ("correct", "w.csv", "-o", "corrected.csv"),
        "--base": ("diagnose", "w.csv"),
        "--column": ("diagnose", "w.csv"),
    }[option]
    before = Path(read).read_bytes()
    code, told = run(*command, option, read, "--json", read, "--force")
    assert (code, told) == (
        2,
        f"echocal: --json {read} is an input of this command ({read}); choose another name\n",
    )
    assert Path(read).read_bytes() == before


def test_a_file_of_an_input_folder_is_an_input(run: Run) -> None:
    Path("logs").mkdir()
    pd.read_csv("w.csv").to_parquet("logs/may.parquet")
    before = Path("logs/may.parquet").read_bytes()
    code, told = run("correct", "logs", "-o", "done", "--json", "logs/may.parquet", "--force")
    assert code == 2
    assert "is an input" in told
    assert Path("logs/may.parquet").read_bytes() == before


@pytest.mark.parametrize("name", OUTPUTS)
def test_what_the_command_did_not_make_needs_force(name: str, run: Run) -> None:
    Path("mine.csv").write_text("my notes\n")
    code, told = run(*words(name, "mine.csv"))
    assert code == 2
    assert "mine.csv exists, and this command did not make it from this input" in told
    assert "--force" in told
    assert Path("mine.csv").read_text() == "my notes\n"
    assert run(*words(name, "mine.csv", "--force")) == (0, "")
    assert Path("mine.csv").read_text() != "my notes\n"


@pytest.mark.parametrize("name", OUTPUTS)
def test_what_the_command_made_is_made_again(name: str, run: Run) -> None:
    for _ in range(2):
        assert run(*words(name, "out.csv")) == (0, "")


def test_a_model_of_another_table_or_an_edited_one_needs_force(run: Run) -> None:
    shutil.copy("w.csv", "new.csv")
    assert run("diagnose", "w.csv", "--save-model", "m.json", "-q") == (0, "")
    old = Path("m.json").read_text()
    code, told = run("diagnose", "new.csv", "--save-model", "m.json", "-q")
    assert (code, Path("m.json").read_text()) == (2, old)
    assert "--save-model m.json exists" in told
    assert run("calibrate", "w.csv", "--fit", "zero_error", "--law", "linear", "-o", "m.json", "-q")[0] == 2
    Path("m.json").write_text(old.replace('"value": ', '"value": 1', 1))
    assert run("diagnose", "w.csv", "--save-model", "m.json", "-q")[0] == 2
    assert run("diagnose", "new.csv", "--save-model", "m.json", "-q", "--force") == (0, "")
    assert echocal.Model.load("m.json").provenance["table"] == "new.csv"


def test_a_note_in_a_model_is_kept(run: Run) -> None:
    assert run("diagnose", "w.csv", "--save-model", "m.json", "-q") == (0, "")
    noted = json.loads(Path("m.json").read_text())
    noted["data"]["note"] = "unit 7, north wall"
    Path("m.json").write_text(json.dumps(noted))
    assert run("diagnose", "w.csv", "--save-model", "m.json", "-q")[0] == 2
    assert json.loads(Path("m.json").read_text()) == noted


def test_tables_of_one_name_are_two_tables(run: Run) -> None:
    for site in ("north", "south"):
        Path(site).mkdir()
        shutil.copy("w.csv", f"{site}/log.csv")
    for _ in range(2):
        assert run("diagnose", "north/log.csv", "--save-model", "m.json", "-q") == (0, "")
    assert run("diagnose", "south/log.csv", "--save-model", "m.json", "-q")[0] == 2
    assert echocal.Model.load("m.json").provenance["table"] == "north/log.csv"


@pytest.mark.parametrize("name", ["deep.json", "broken.csv.gz", "broken.nc", "broken.parquet"])
def test_a_file_that_no_reader_can_read_is_kept(name: str, run: Run) -> None:
    content = {
        "deep.json": b"[" * 200_000,
        "broken.csv.gz": gzip.compress(b"a,b\n1,2\n")[:-10] + b"\xff" * 10,
        "broken.nc": b"\x89HDF\r\n\x1a\n" + b"\0" * 100,
        "broken.parquet": b"PAR1" + b"\xff" * 100 + b"PAR1",
    }[name]
    Path(name).write_bytes(content)
    command = (
        ["diagnose", "w.csv", "--json"] if name == "deep.json" else ["sweep", "--temperature", "0:9:1", "-o"]
    )
    if name == "broken.csv.gz":
        command = ["correct", "w.csv", "--law", "linear", "-o"]
    code, told = run(*command, name, "-q")
    assert (code, told.count("\n")) == (2, 1)
    assert f"{name} exists, and this command did not make it" in told
    assert Path(name).read_bytes() == content


def test_an_empty_file_holds_nothing_to_keep(run: Run) -> None:
    Path("made-by-mktemp").touch()
    assert run("diagnose", "w.csv", "--json", "made-by-mktemp", "-q") == (0, "")


@pytest.mark.parametrize("ending", ["CSV", "CSV.GZ", "PARQUET"])
def test_endings_in_capitals_are_made_again(ending: str, run: Run) -> None:
    for _ in range(2):
        assert run("correct", "w.csv", "--law", "linear", "-o", f"out.{ending}", "-q") == (0, "")


def test_two_outputs_are_two_files(run: Run) -> None:
    code, told = run("diagnose", "w.csv", "--save-model", "a.json", "--json", "./a.json")
    assert (code, told) == (2, "echocal: --save-model and --json both name a.json; choose two names\n")
    assert names() == {"w.csv"}


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["csv", "parquet", "nc"])
def test_a_sweep_is_made_again_and_nothing_else_is_replaced(ending: str, run: Run) -> None:
    command = ("sweep", "--temperature", "0:50:10", "-o", f"s.{ending}", "-q")
    for picture in ("png", "svg", "pdf"):
        for _ in range(2):
            assert run(*command, "--plot", f"s.{picture}") == (0, "")
    Path(f"s.{ending}").write_text("mine")
    assert run(*command)[0] == 2
    assert Path(f"s.{ending}").read_text() == "mine"


@pytest.mark.slow
def test_pictures_of_others_are_kept(run: Run) -> None:
    plots = ("diagnose", "w.csv", "--plots", "plots", "-q")
    for _ in range(2):
        assert run(*plots) == (0, "")
    from matplotlib.figure import Figure

    Figure().savefig("plots/gain.png")
    mine = Path("plots/gain.png").read_bytes()
    code, told = run(*plots)
    assert (code, Path("plots/gain.png").read_bytes()) == (2, mine)
    assert "--plots plots/gain.png exists" in told


def test_an_edited_file_of_a_firmware_is_kept(run: Run) -> None:
    command = ("firmware", str(EXAMPLES / "tank_model.json"), "-o", "made", "--temperature-lsb", "0.5", "-q")
    for _ in range(2):
        assert run(*command, "--package", "platformio") == (0, "")
    listed = subprocess.run(["sha256sum", "--check", "--quiet", "SHA256SUMS"], cwd="made", check=False)
    assert listed.returncode == 0
    sketch = next(Path("made").rglob("main.cpp"))
    sketch.write_text("/* my pins */\n" + sketch.read_text())
    mine = sketch.read_text()
    code, told = run(*command, "--package", "platformio")
    assert (code, sketch.read_text()) == (2, mine)
    assert f"{sketch} exists" in told
    assert run(*command, "--package", "platformio", "--force") == (0, "")
    assert sketch.read_text() != mine
    Path("other").mkdir()
    Path("other/report.json").write_text("mine")
    assert run(*command[:3], "other", *command[4:])[0] == 2
    assert {path.name for path in Path("other").iterdir()} == {"report.json"}
    assert Path("other/report.json").read_text() == "mine"


def test_a_list_of_checksums_of_the_users_own_is_no_proof(run: Run) -> None:
    Path("own/made").mkdir(parents=True)
    mine = Path("own/made/echocal_correction.c")
    mine.write_text("/* by hand */\n")
    digest = hashlib.sha256(mine.read_bytes()).hexdigest()
    for listed, name in (("own/SHA256SUMS", "made/echocal_correction.c"), ("own/made/SHA256SUMS", mine.name)):
        Path(listed).write_text(f"{digest}  {name}\n")
        model, lsb = str(EXAMPLES / "tank_model.json"), ("--temperature-lsb", "0.5")
        assert run("firmware", model, "-o", "own/made", *lsb, "-q")[0] == 2
        assert mine.read_text() == "/* by hand */\n"


def test_packages_in_one_folder_are_each_made_again(run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    command = ("firmware", str(EXAMPLES / "tank_model.json"), "-o", "made", "--temperature-lsb", "0.5")
    assert run(*command, "--package", "arduino", "-q") == (0, "")
    assert run(*command, "-q") == (0, "")
    assert run(*command, "--package", "arduino", "-q") == (0, "")
    listed = subprocess.run(["sha256sum", "--check", "--quiet", "SHA256SUMS"], cwd="made", check=False)
    assert listed.returncode == 0
    assert "selftest/echocal_selftest_main.c" in Path("made/SHA256SUMS").read_text()


@pytest.mark.slow
def test_the_study_is_made_again_and_other_pages_are_kept(run: Run) -> None:
    for _ in range(2):
        assert run("study", "--out", "pages", "--json", "study.json", "--quiet")[0] == 0
    Path("pages/study.md").write_text("mine")
    assert run("study", "--out", "pages", "--quiet")[0] == 2
    assert Path("pages/study.md").read_text() == "mine"


def test_the_list_of_causes_is_made_again(run: Run) -> None:
    for command in (("effects",), ("effects", "list"), ("effects", "show", "humidity")):
        assert run(*command, "--json", "causes.json", "-q") == (0, "")
    Path("causes.json").write_text('[{"id": 3}]')
    assert run("effects", "--json", "causes.json", "-q")[0] == 2


@pytest.mark.parametrize(
    "error", [OSError(28, "No space left on device"), KeyboardInterrupt(), MemoryError()]
)
def test_the_old_file_stays_whatever_ends_the_work(error: BaseException, tmp_path: Path) -> None:
    old = tmp_path / "a.json"
    old.write_text("old")

    def break_off() -> None:
        with replacing(old) as unfinished:
            unfinished.write_text("half")
            raise error

    with pytest.raises((echocal.UsageError, KeyboardInterrupt, MemoryError)):
        break_off()
    assert (old.read_text(), [path.name for path in tmp_path.iterdir()]) == ("old", ["a.json"])


@pytest.mark.slow
def test_a_full_disk_leaves_no_file(tmp_path: Path) -> None:
    """A real refusal of the system in the middle of a file: its largest size is reached."""
    old = tmp_path / "out.csv"
    temperature = np.linspace(0.0, 40.0, 20_000)
    pd.DataFrame({"echo_us": 11660.0, "temperature_C": temperature}).to_csv(tmp_path / "in.csv", index=False)
    limited = "import resource, signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN); "
    limited += "resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000)); "
    limited += "import sys; sys.argv = ['echocal', *sys.argv[1:]]; from echocal.cli import main; main()"
    command = [sys.executable, "-c", limited, "correct", "in.csv", "-o", "out.csv", "--law", "linear"]
    for before in (None, "corrected_distance_m,unusable\n1,\n"):
        if before is not None:
            old.write_text(before)
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert run.returncode == 2, run.stderr
        assert run.stderr.splitlines()[-1] == "echocal: out.csv cannot be written: File too large"
        assert (old.read_text() if old.exists() else None) == before
        assert {path.name for path in tmp_path.iterdir()} == {"in.csv", *(["out.csv"] if before else [])}


@pytest.mark.slow
def test_ctrl_c_leaves_the_old_file(tmp_path: Path) -> None:
    temperature = np.linspace(0.0, 40.0, 400_000)
    pd.DataFrame({"echo_us": 11660.0, "temperature_C": temperature}).to_csv(tmp_path / "in.csv", index=False)
    old = "corrected_distance_m,unusable\n1,\n"
    (tmp_path / "out.csv").write_text(old)
    command = [sys.executable, "-m", "echocal", "correct", "in.csv", "-o", "out.csv", "--law", "linear"]
    started = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    while started.poll() is None and not list(tmp_path.glob("*.unfinished")):
        time.sleep(0.005)
    started.send_signal(signal.SIGINT)
    assert started.wait(60) != 0
    assert (tmp_path / "out.csv").read_text() == old
    assert {path.name for path in tmp_path.iterdir()} == {"in.csv", "out.csv"}


@pytest.mark.slow
def test_processes_that_write_one_file_leave_a_whole_one(tmp_path: Path) -> None:
    """They shared one temporary name: rows and zeros of several were mixed in a file that looked whole."""
    temperature = np.linspace(0.0, 40.0, 100_000)
    pd.DataFrame({"echo_us": 11660.0, "temperature_C": temperature}).to_csv(tmp_path / "in.csv", index=False)
    command = [
        sys.executable,
        "-m",
        "echocal",
        "correct",
        "in.csv",
        "-o",
        "out.csv.gz",
        "--law",
        "linear",
        "-q",
    ]
    running = [subprocess.Popen(command, cwd=tmp_path) for _ in range(4)]
    assert [process.wait(120) for process in running] == [0] * 4
    with gzip.open(tmp_path / "out.csv.gz", "rt") as file:
        corrected = pd.read_csv(file)
    assert len(corrected) == 100_000
    assert corrected["corrected_distance_m"].notna().all()
    assert {path.name for path in tmp_path.iterdir()} == {"in.csv", "out.csv.gz"}


def test_links_permissions_and_devices(tmp_path: Path) -> None:
    real, link = tmp_path / "real.json", tmp_path / "link.json"
    real.write_text("old")
    real.chmod(0o640)
    link.symlink_to(real)
    echocal.Model("linear").save(link)
    assert link.is_symlink()
    assert echocal.Model.load(real).law == "linear"
    assert real.stat().st_mode & 0o777 == 0o640
    real.chmod(0o664)  # more than the process gives to new files
    echocal.Model("linear").save(link)
    assert real.stat().st_mode & 0o777 == 0o664
    echocal.Model("linear").save("/dev/null")
    assert not Path("/dev/null").is_file()


@pytest.mark.parametrize("option", ["--json", "--save-model", "--plots"])
def test_a_name_that_is_too_long(option: str, run: Run) -> None:
    code, told = run("diagnose", "w.csv", option, "n" * 256, "-q")
    assert (code, told) == (2, f"echocal: {'n' * 256} cannot be written: File name too long\n")


@pytest.mark.parametrize("name", ["n" * 256, "a\0b.json", "half \ud800.json"])
def test_names_that_no_file_can_have(name: str) -> None:
    with pytest.raises(echocal.UsageError, match="cannot be written"):
        echocal.Model("linear").save(name)


def test_the_former_name_of_save_model_still_writes_and_says_so(run: Run) -> None:
    code, told = run("diagnose", "w.csv", "--model", "m.json")
    assert code == 0
    assert "--model, where it writes, is now --save-model" in told
    assert Path("m.json").exists()
    code, told = run("diagnose", "w.csv", "--model", "m.json", "--save-model", "n.json")
    assert code == 2
    assert "give one of them" in told
