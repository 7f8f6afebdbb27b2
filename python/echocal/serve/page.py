"""The page: a log, its columns, the request, the report, and files to take away."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from echocal.errors import EchocalError
from echocal.observations.inspection import ColumnFacts
from echocal.serve.fields import (
    BASE,
    DISTANCE,
    DISTANCES,
    HEIGHT,
    LARGEST,
    PLACEMENTS,
    SPEED,
    STEP,
    TEMPERATURE,
)
from echocal.serve.session import CHOICES, Session

_MOST_BYTES = 200_000_000
_TARGETS = ("c99", "avr", "cortex-m0", "cortex-m3", "cortex-m4f", "rv32", "rv32e")


class Page:
    """One visitor's page."""

    def __init__(self, ui: Any) -> None:
        self.ui, self.session = ui, Session()
        self.stage: tuple[str, float] = ("", 0.0)

    def build(self) -> None:
        """Draw the first step; what follows is drawn when there is something to show."""
        ui = self.ui
        ui.context.client.on_delete(self.session.close)
        ui.colors(primary="#2a85a6")
        with ui.column().classes("w-full max-w-4xl mx-auto"):
            ui.label("echocal").classes("text-2xl")
            ui.label("What does an ultrasonic distance sensor get wrong? Nothing leaves this machine.")
            upload = ui.upload(
                label="Drop a log here, or choose one with +",
                on_upload=self._open,
                on_rejected=lambda: self._say("the file is larger than 200 MB: use echocal diagnose"),
                max_file_size=_MOST_BYTES,
                auto_upload=True,
            )
            upload.classes("w-full")
            self.error = ui.label().classes("text-negative whitespace-pre-wrap w-full")
            self.error.props("role=alert").set_visibility(False)
            self.columns = ui.column().classes("w-full")
            self.result = ui.column().classes("w-full")
        self.timer = ui.timer(0.1, self._tick, active=False)

    async def _open(self, event: Any) -> None:
        content = await event.file.read()
        self.result.clear()
        self.columns.clear()
        if await self._tried(partial(self.session.open, event.file.name, content)):
            event.sender.reset()
            self._show_columns()
            self._show_request()

    async def _tried(self, work: Callable[[], Any]) -> bool:
        """Work beside the page; say what a user can mend, in place of a traceback."""
        from nicegui import run

        self._say("")
        try:
            await run.io_bound(work)
        except EchocalError as error:
            self._say(str(error))
            return False
        except Exception:
            self._say("This is a fault of echocal. The terminal that serves the page says more.")
            raise
        return True

    def _say(self, text: str) -> None:
        self.error.set_text(text)
        self.error.set_visibility(bool(text))

    def _show_columns(self) -> None:
        ui, found = self.ui, self.session.inspection
        assert found is not None
        with self.columns:
            self.listed = ui.column().classes("w-full gap-0")
        self._list_columns()

    def _list_columns(self) -> None:
        ui, found = self.ui, self.session.inspection
        assert found is not None
        self.listed.clear()
        with self.listed:
            ui.label(f"{self.session.name}: {found.kind}, {found.rows} rows").classes("text-xl")
            ui.label("Each column, and what it is taken for. Change what is wrong.")
            for column in found.columns:
                self._column(column)
            for note in found.notes:
                ui.label(f"note: {note}").classes("text-sm")
            usable = f"{found.usable} of {found.rows} rows can be used."
            ui.label(found.refusal or usable).classes("text-negative" if found.refusal else "")

    def _column(self, column: ColumnFacts) -> None:
        ui, proposal = self.ui, column.proposal
        because = f"a guess: {proposal.reason}" if proposal.guess else proposal.reason
        missing = f"; {column.missing} missing" if column.missing else ""
        with ui.row().classes("w-full items-center no-wrap border-b py-1"):
            with ui.column().classes("gap-0 min-w-0 flex-1"):
                ui.label(column.name).classes("font-bold break-all")
                ui.label(f"{_values(column)}{missing}").classes("text-sm opacity-80")
                ui.label(because).classes("text-sm " + ("text-warning" if proposal.guess else "opacity-80"))
            select = ui.select(
                {choice: choice or "no quantity" for choice in CHOICES},
                value=proposal.request if proposal.request in CHOICES else "",
                with_input=True,
                on_change=lambda event, name=column.name: self._take(name, event.value),
            )
            select.props(f'dense aria-label="{_attribute(column.name)}"').classes("w-44 shrink-0")

    async def _take(self, column: str, request: str | None) -> None:
        self.result.clear()
        if await self._tried(partial(self.session.take, column, request or "")):
            self._list_columns()

    def _show_request(self) -> None:
        ui = self.ui
        with self.columns:
            ui.label("The distance of the target").classes("text-xl mt-4")
            self.distance = ui.radio(DISTANCES, value="column")
            self.known = ui.number(DISTANCE, format="%g").props("dense").classes("w-40")
            self.known.bind_visibility_from(self.distance, "value", value="known")
            self.placements = ui.input(PLACEMENTS)
            self.placements.props('dense hint="0.5, 1.2, 2.5"').classes("w-full")
            self.placements.bind_visibility_from(self.distance, "value", value="column")
            ui.label("What no column holds").classes("text-xl mt-4")
            with ui.row().classes("items-end"):
                self.temperature = ui.input(TEMPERATURE)
                self.temperature.props('dense hint="20+-2, with its uncertainty"').classes("w-64")
                self.height = ui.number(HEIGHT, format="%g")
                self.height.props("dense").classes("w-72")
            ui.label("The device").classes("text-xl mt-4")
            self.speed = ui.input(SPEED)
            self.speed.props('dense hint="what the device used; empty: linear"').classes("w-full")
            self.base = ui.input(BASE, value="linear")
            self.base.props('dense hint="linear, cramer, 343"').classes("w-full")
            self.start = ui.button("Diagnose", on_click=self._diagnose).classes("mt-4")
            self.bar = ui.linear_progress(0.0, show_value=False).props("instant-feedback")
            self.doing = ui.label().props("role=status")
            self.bar.set_visibility(False)

    async def _diagnose(self) -> None:
        self.result.clear()
        where = self.distance.value
        request = {
            "base": self.base.value or None,
            "constant_distance": where == "constant" or None,
            "reference_distance": self.known.value if where == "known" else None,
            "placements": (self.placements.value or None) if where == "column" else None,
        }
        beside = {"temperature": self.temperature.value or "", "mount_height": self.height.value}
        beside["reading_speed"] = self.speed.value or ""
        if not await self._tried(partial(self.session.say, **beside)):
            return
        self._list_columns()
        self.stage = ("reading", 0.0)
        self._working(True)
        try:
            done = await self._tried(partial(self.session.diagnose, self._progress, **request))
        finally:
            self._working(False)
        if done:
            await self._show_result()

    def _working(self, now: bool) -> None:
        self.start.set_enabled(not now)
        self.bar.set_visibility(now)
        self.doing.set_text("")
        self.timer.active = now

    def _progress(self, what: str, done: int, total: int) -> None:
        self.stage = (what, done / max(total, 1))

    def _tick(self) -> None:
        what, part = self.stage
        self.doing.set_text(what)
        self.bar.set_value(part)

    async def _show_result(self) -> None:
        ui = self.ui
        products: dict[str, str] = {}

        def work() -> None:
            products.update(self.session.products())

        if not await self._tried(work):
            return
        with self.result:
            ui.label("Report").classes("text-xl mt-4")
            with ui.row():
                for name, text in products.items():
                    ui.button(
                        name.removeprefix(f"{Path(self.session.name).stem} "),
                        icon="download",
                        on_click=lambda name=name, text=text: ui.download.content(text, name),
                    ).props("outline no-caps")
            (report,) = (text for name, text in products.items() if name.endswith(".html"))
            frame = ui.element("iframe").classes("w-full border").style("height: 80vh; color-scheme: normal")
            frame.props["srcdoc"] = report
            frame.props["title"] = "report"
            self._show_firmware()

    def _show_firmware(self) -> None:
        ui = self.ui
        ui.label("C for a microcontroller").classes("text-xl mt-4")
        with ui.row().classes("items-end"):
            target = ui.select(list(_TARGETS), value="c99", label="core").classes("w-32")
            low = ui.number("from [degC]", value=-20, format="%g").classes("w-24")
            high = ui.number("to [degC]", value=60, format="%g").classes("w-24")
            step = ui.number(STEP, value=0.0625, format="%g").classes("w-48")
            most = ui.number(LARGEST, value=0.5, format="%g").classes("w-40")

        async def make() -> None:
            made: list[bytes] = []

            def work() -> None:
                codes = (step.value or 0.0, low.value or 0.0, high.value or 0.0)
                largest = 1e-3 * (most.value or 0.0)
                made.append(self.session.firmware(target.value, temperature=codes, max_error=largest))

            button.set_enabled(False)
            try:
                if await self._tried(work):
                    notes.set_text("\n".join(f"note: {note}" for note in self.session.notes))
                    ui.download.content(made[0], f"{Path(self.session.name).stem} firmware.zip")
            finally:
                button.set_enabled(True)

        button = ui.button("firmware.zip", icon="download", on_click=make).props("outline no-caps")
        notes = ui.label().classes("text-sm whitespace-pre-wrap")


def _values(column: ColumnFacts) -> str:
    if column.median is None:
        return ", ".join(column.examples)
    return f"{column.least:.4g} to {column.most:.4g} {column.unit}".rstrip()


def _attribute(text: str) -> str:
    """A text between double quotes in NiceGUI's properties."""
    return text.replace("\\", "").replace('"', "'")
