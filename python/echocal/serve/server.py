"""The server of the page: on this machine only, for pages of its own only."""

import socket
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

from echocal.errors import UsageError
from echocal.keywords import on_page
from echocal.serve.fields import FIELDS

HOST, PORT = "127.0.0.1", 8477
_NAMES = (HOST, "localhost")

Scope = MutableMapping[str, Any]
App = Callable[[Scope, Any, Any], Awaitable[None]]


class OwnPagesOnly:
    """Refuses requests that a page of another site makes, or that reach the server by another name.

    A page of a site could otherwise send requests to servers of the machine that shows it.
    """

    def __init__(self, app: App, port: int) -> None:
        self.app = app
        self.hosts = {f"{name}:{port}" for name in _NAMES}

    async def __call__(self, scope: Scope, receive: Any, send: Any) -> None:
        """Pass a request on, or answer it with 403."""
        if scope["type"] not in ("http", "websocket") or self.is_own(dict(scope["headers"])):
            await self.app(scope, receive, send)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await send({"type": "http.response.start", "status": 403, "headers": []})
            await send({"type": "http.response.body", "body": b"only from this machine"})

    def is_own(self, headers: dict[bytes, bytes]) -> bool:
        """Whether a request is for this server, and from a page of it."""
        origin = headers.get(b"origin", b"").decode("latin-1").removeprefix("http://")
        return headers.get(b"host", b"").decode("latin-1") in self.hosts and origin in {"", *self.hosts}


def serve(port: int = PORT, *, show: bool = True) -> None:
    """Serve the page until Ctrl-C.

    The port is on the loopback interface. Raises `UsageError` if NiceGUI is not installed, or the port is
    taken.
    """
    try:
        from nicegui import app, ui
    except ImportError:
        raise UsageError("the page needs NiceGUI: pip install 'echocal[serve]'") from None
    from echocal.serve.page import Page

    with socket.socket() as tried:
        tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            tried.bind((HOST, port))
        except (OSError, OverflowError) as error:
            raise UsageError(f"port {port} cannot be used ({error}); choose another one") from None
    app.add_middleware(OwnPagesOnly, port=port)
    with on_page(FIELDS):
        ui.run(
            root=lambda: Page(ui).build(),
            host=HOST,
            port=port,
            title="echocal",
            favicon="📏",
            dark=None,
            show=show,
            reload=False,
            show_welcome_message=False,
        )
