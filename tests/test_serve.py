"""The page in the browser: driven as a person would, on a phone's width; and what the server refuses."""

import asyncio
import importlib
import io
import json
import os
import re
import socket
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.error import URLError
from urllib.request import Request, urlopen

import numpy as np
import pandas as pd
import pytest
from browsed import Text, chromium

import echocal
from echocal.keywords import on_page
from echocal.serve.fields import BASE, DISTANCES, FIELDS, SPEED, TEMPERATURE
from echocal.serve.server import OwnPagesOnly
from echocal.serve.session import Session

Run = Callable[..., tuple[int, str]]
PHONE = {"width": 390, "height": 844}
SEEN = """() => { window.seen = new Set(); new MutationObserver(() => {
  const stage = document.querySelector("[role=status]");
  if (stage?.textContent) window.seen.add(stage.textContent);
}).observe(document.body, {subtree: true, childList: true, characterData: true}); }"""


def log(random: np.random.Generator) -> str:
    """A log whose columns have names that say no quantity: an offset of 10 mm at three distances."""
    true = np.repeat([0.5, 1.5, 3.0], 60)
    table = pd.DataFrame(
        {
            "SR_U": true + 10e-3 + random.normal(0.0, 1e-3, true.size),
            "Asp": random.uniform(5.0, 35.0, true.size),
            "tape": true,
        }
    )
    return table.to_csv(index=False)


def test_a_session_does_what_the_commands_do(random: np.random.Generator) -> None:
    session, text = Session(), log(random)
    session.open("my log.csv", text.encode())
    for column, request in (("SR_U", "reading_m"), ("Asp", "temperature_C"), ("tape", "distance_m")):
        session.take(column, request)
    session.diagnose(base="linear")
    assert session.diagnosis is not None
    columns = {"SR_U": "reading_m", "Asp": "temperature_C", "tape": "distance_m"}
    alone = echocal.diagnose(pd.read_csv(io.StringIO(text)), base="linear", columns=columns)
    assert session.diagnosis.posterior == alone.posterior
    products = session.products()
    page = Text(products["my log report.html"]).seen
    assert "echocal diagnose 'my log.csv' --base linear --column SR_U=reading_m" in page
    assert json.loads(products["my log model.json"])["schema"] == "echocal.model/1"
    corrected = pd.read_csv(io.StringIO(products["my log corrected.csv"]))
    assert abs((corrected["corrected_distance_m"] - corrected["tape"]).mean()) < 1e-3
    with zipfile.ZipFile(io.BytesIO(session.firmware("c99", temperature=(0.5, 0.0, 40.0)))) as files:
        assert "echocal_correction.c" in {Path(name).name for name in files.namelist()}
    session.close()
    assert not session.folder.exists()


def test_a_change_of_a_column_forgets_the_diagnosis(random: np.random.Generator) -> None:
    session = Session()
    session.open(
        "log.csv", log(random).replace("SR_U,Asp,tape", "reading_m,temperature_C,distance_m").encode()
    )
    session.diagnose(base="linear")
    session.take("temperature_C", "ignore")
    assert session.taken_for["temperature_C"] == "ignore"
    with pytest.raises(echocal.EchocalError, match="not diagnosed"):
        session.products()
    session.close()


def test_a_session_takes_what_no_column_holds(random: np.random.Generator) -> None:
    """The temperature, the ruler values of placements, the height of a level."""
    session = Session()
    reading = np.repeat([0.51, 1.21, 2.51], 40) + random.normal(0.0, 1e-3, 120)
    session.open("bench.csv", pd.DataFrame({"reading_m": reading}).to_csv(index=False).encode())
    session.say(temperature="20+-2")
    session.diagnose(base="linear", placements="0.5,1.2,2.5")
    assert "--at temperature=20+-2" in Text(session.products()["bench report.html"]).seen
    with pytest.raises(echocal.UsageError, match="for a column that holds a level"):
        session.say(temperature="20+-2", mount_height=2.6)
    session.open("tank.csv", pd.DataFrame({"level_m": 2.6 - reading}).to_csv(index=False).encode())
    session.say(temperature="20", mount_height=2.6)
    assert session.taken_for["level_m"] == "level_m below 2.6 m"
    session.diagnose(base="linear", placements="0.5,1.2,2.5")
    assert "corrected_level_m" in session.products()["tank corrected.csv"]
    session.close()


def test_messages_have_the_words_of_the_fields(random: np.random.Generator) -> None:
    """Each refusal, and each note, names what is on the page; a flag only where the page has no field."""
    told: list[str] = []
    with on_page(FIELDS):
        session = Session()
        for columns, request in (
            ({}, {}),
            ({"SR_U": "reading_m"}, {}),
            ({"SR_U": "reading_m", "Asp": "temperature_C"}, {}),
            ({"SR_U": "level_m", "Asp": "temperature_C", "tape": "distance_m"}, {}),
            ({"SR_U": "reading_m", "Asp": "temperature_C", "tape": "ignore"}, {"reference_distance": 150.0}),
            ({"SR_U": "reading_m", "Asp": "temperature_C", "tape": "ignore"}, {}),
            ({"SR_U": "reading_m", "Asp": "temperature_C", "tape": "distance_m"}, {}),
            ({"SR_U": "reading_m", "Asp": "temperature_C"}, {"constant_distance": True, "placements": "1"}),
        ):
            session.open("my log.csv", log(random).encode())
            try:
                for column, meant in columns.items():
                    session.take(column, meant)
                session.diagnose(**request)
                assert session.diagnosis is not None
                told += session.diagnosis.notes
            except echocal.EchocalError as error:
                told.append(str(error))
            assert session.inspection is not None
            told += [*session.inspection.notes, session.inspection.refusal]
    known = re.compile(r"echocal [a-z]+ .*|--\S+[^-]* of the command")
    flags = [text for text in told if re.search(r"--[a-z]", known.sub("", text))]
    assert not flags, flags
    assert any(f'"{SPEED}": 343' in text for text in told), told
    assert any(f'"{TEMPERATURE}": 20+-2' in text for text in told), told
    assert any(f'choose "{DISTANCES["constant"]}"' in text for text in told), told
    assert any("choose distance_m beside 'NAME'" in text or "beside '" in text for text in told)


def test_the_speed_of_the_readings_has_a_field(random: np.random.Generator) -> None:
    session, text = Session(), log(random)
    session.open("my log.csv", text.encode())
    for column, request in (("SR_U", "reading_m"), ("Asp", "temperature_C"), ("tape", "distance_m")):
        session.take(column, request)
    session.say(reading_speed="343")
    session.diagnose(base="linear")
    assert session.diagnosis is not None
    columns = {"SR_U": "reading_m", "Asp": "temperature_C", "tape": "distance_m"}
    alone = echocal.diagnose(pd.read_csv(io.StringIO(text)), columns=columns, reading_speed=343)
    assert session.diagnosis.posterior == alone.posterior
    products = session.products()
    assert "--reading-speed 343" in Text(products["my log report.html"]).seen
    corrected = echocal.correct(
        pd.read_csv(io.StringIO(text)), alone.model, columns=columns, reading_speed=343
    ).table["corrected_distance_m"]
    found = pd.read_csv(io.StringIO(products["my log corrected.csv"]))["corrected_distance_m"]
    np.testing.assert_allclose(found, corrected, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("host", "origin", "answered"),
    [
        ("127.0.0.1:8477", None, True),
        ("localhost:8477", "http://localhost:8477", True),
        ("example.org:8477", None, False),  # a name that a site points to this machine
        ("127.0.0.1:8477", "http://example.org", False),
        ("127.0.0.1:8477", "null", False),
    ],
)
def test_only_pages_of_its_own_are_answered(host: str, origin: str | None, answered: bool) -> None:
    reached: list[str] = []
    sent: list[dict[str, object]] = []

    async def app(scope: object, receive: object, send: object) -> None:
        reached.append("app")

    async def send(message: dict[str, object]) -> None:
        sent.append(message)

    headers = [(b"host", host.encode()), *([] if origin is None else [(b"origin", origin.encode())])]
    for kind in ("http", "websocket"):
        asyncio.run(OwnPagesOnly(app, 8477)({"type": kind, "headers": headers}, None, send))
    assert len(reached) == 2 * answered
    assert [m.get("status", m.get("code")) for m in sent][::2] == ([] if answered else [403, 1008])


def test_a_port_that_is_taken_is_told(run: Run) -> None:
    pytest.importorskip("nicegui")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        code, said = run("serve", "--port", str(port), "--no-browser")
    assert (code, f"port {port} cannot be used" in said) == (2, True)


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """The server in a process and a folder of its own."""
    pytest.importorskip("nicegui")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    folder = tmp_path / "served"
    folder.mkdir()
    command = [sys.executable, "-m", "echocal", "serve", "--port", str(port), "--no-browser"]
    with (tmp_path / "said.txt").open("w") as said:
        own = {name: value for name, value in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
        server = subprocess.Popen(command, cwd=folder, stdout=said, stderr=said, env=own)
    try:
        for _ in range(300):
            try:
                with urlopen(Request(f"http://127.0.0.1:{port}/"), timeout=5):
                    break
            except (URLError, ConnectionError):
                assert server.poll() is None, (tmp_path / "said.txt").read_text()
                time.sleep(0.2)
        yield f"http://127.0.0.1:{port}"
    finally:
        server.terminate()
        server.wait(30)
    assert not list(folder.iterdir())  # nothing is left in the user's folder
    assert "Traceback" not in (tmp_path / "said.txt").read_text()


def columns_of(picture: bytes, count: int) -> Any:
    """A long picture in columns beside each other, with few colors."""
    image = importlib.import_module("PIL.Image")
    whole = image.open(io.BytesIO(picture)).convert("RGB")
    wide, high = whole.width, -(-whole.height // count)
    beside = image.new("RGB", ((wide + 10) * count - 10, high), "grey")
    for place in range(count):
        top = high * place
        beside.paste(whole.crop((0, top, wide, min(top + high, whole.height))), ((wide + 10) * place, 0))
    return beside.quantize(64)


@pytest.mark.slow
def test_a_phone_from_a_log_to_its_c(address: str, random: np.random.Generator, tmp_path: Path) -> None:
    """A log is chosen, its columns are put right, the report is read, and all files are taken away."""
    playwright = pytest.importorskip("playwright.sync_api")
    (tmp_path / "my log.csv").write_text(log(random))
    (tmp_path / "no log.csv").write_bytes(b"")
    columns = {"SR_U": "reading_m", "Asp": "temperature_C"}
    said: list[str] = []
    asked: list[str] = []
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        page = browser.new_context(viewport=PHONE, has_touch=True, color_scheme="dark").new_page()
        page.set_default_timeout(60_000)
        page.on("console", lambda m: said.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.on("websocket", lambda opened: asked.append(opened.url.replace("ws://", "http://", 1)))
        page.goto(address)
        page.set_input_files("input[type=file]", tmp_path / "no log.csv")
        playwright.expect(page.get_by_role("alert")).not_to_be_empty()
        page.set_input_files("input[type=file]", tmp_path / "my log.csv")
        for place, (column, request) in enumerate(columns.items()):
            field = page.get_by_role("combobox", name=column)
            field.fill(request)
            page.get_by_role("option", name=request, exact=True).click()
            page.get_by_text("as you say").nth(place).wait_for()
        playwright.expect(page.get_by_text("180 of 180 rows can be used")).to_be_visible()
        playwright.expect(page.get_by_role("alert")).to_be_hidden()
        page.get_by_label(BASE).fill("343 bananas")
        page.get_by_role("button", name="Diagnose").click()
        playwright.expect(page.get_by_role("alert")).to_contain_text("343 bananas")
        page.get_by_label(BASE).fill("331.4+0.6*T")
        page.evaluate(SEEN)
        page.get_by_role("button", name="Diagnose").click()
        report = page.frame_locator("iframe")
        assert "zero_error" in report.locator(".verdict").inner_text()
        report.locator("svg.chart text.tick").first.wait_for()
        assert page.evaluate("window.seen.size") >= 1  # a stage of the diagnosis, as it went by
        if where := os.environ.get("ECHOCAL_SCREENSHOT"):  # docs/serve.png
            columns_of(page.screenshot(full_page=True), 3).save(where, optimize=True)
        wide = "document.documentElement.scrollWidth > document.documentElement.clientWidth"
        assert not page.evaluate(wide)
        assert not report.locator("body").evaluate(f"() => {wide}")
        taken = {}
        for name in ("report.html", "model.json", "corrected.csv", "firmware.zip"):
            with page.expect_download() as download:
                page.get_by_role("button", name=name).click()
            taken[name] = download.value.path().read_bytes()
            assert download.value.suggested_filename == f"my log {name}"
        browser.close()
    assert said == []
    assert {url for url in asked if not url.startswith((address, "data:", "blob:", "about:"))} == set()
    (tmp_path / "model.json").write_bytes(taken["model.json"])
    effects = echocal.Model.load(tmp_path / "model.json").effects
    assert {"zero_error", "fixed_delay"} & set(effects)  # which of the two is a draw
    assert b"corrected_distance_m" in taken["corrected.csv"].splitlines()[0]
    assert b"<title>echocal: my log.csv" in taken["report.html"]
    assert zipfile.is_zipfile(io.BytesIO(taken["firmware.zip"]))


@pytest.mark.slow
def test_a_raw_log_with_what_no_column_holds(
    address: str, random: np.random.Generator, tmp_path: Path
) -> None:
    playwright = pytest.importorskip("playwright.sync_api")
    reading = np.repeat([0.51, 1.21, 2.51], 40) + random.normal(0.0, 1e-3, 120)
    pd.DataFrame({"reading_m": reading}).to_csv(tmp_path / "bench.csv", index=False)
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        page = browser.new_context(viewport=PHONE, has_touch=True).new_page()
        page.set_default_timeout(60_000)
        page.goto(address)
        page.set_input_files("input[type=file]", tmp_path / "bench.csv")
        page.get_by_label("temperature of the air").fill("20+-2")
        page.get_by_label("ruler values").fill("0.5, 1.2, 2.5")
        page.get_by_label("mount height").fill("2.6")
        page.get_by_role("button", name="Diagnose").click()
        playwright.expect(page.get_by_role("alert")).to_contain_text("for a column that holds a level")
        page.get_by_label("mount height").fill("")
        page.get_by_role("button", name="Diagnose").click()
        report = page.frame_locator("iframe")
        report.locator(".verdict").wait_for()
        assert "temperature=20+-2" in report.locator("body").inner_text()
        if where := os.environ.get("ECHOCAL_SCREENSHOT_BESIDE"):
            page.screenshot(path=where, full_page=True)
        wide = "document.documentElement.scrollWidth > document.documentElement.clientWidth"
        assert not page.evaluate(wide)
        browser.close()
