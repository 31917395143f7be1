"""The web server of the page with sliders. It serves this machine only, until it is interrupted."""

import signal
import sys
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import quote

from drumlin.base.errors import BadInput, system_message_of_error
from drumlin.brake.brake import Brake
from drumlin.explore.answers import SliderSolver
from drumlin.explore.page import http_reply_to_requested_address

LOOPBACK_IP_ADDRESS = "127.0.0.1"
"""The IP address by which this machine calls itself: no other machine reaches the server."""

CONTENT_SECURITY_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "connect-src 'self'; img-src data:"
)
"""The security policy that the server sends with the page.

The page may run its own script and ask its own server. It may load nothing from other servers.
"""


class _Server(ThreadingHTTPServer):
    """A server with a thread for each connection that a browser keeps open.

    The server computes one answer at a time, since all answers share one cache.
    """

    daemon_threads = True

    def __init__(self, explorer: SliderSolver, name: str, port: int) -> None:
        super().__init__((LOOPBACK_IP_ADDRESS, port), _Handler)
        self.explorer, self.name = explorer, name
        # A thread holds this lock while it computes an answer.
        self.answering = threading.Lock()
        self.hosts = {f"{host}:{self.server_port}" for host in ("localhost", LOOPBACK_IP_ADDRESS)}

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Print the error of a request, but nothing where the browser has closed its connection."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """The handler of the requests that a browser sends."""

    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True
    timeout = 600  # s
    server: _Server

    def do_GET(self) -> None:
        """Send the reply to a browser's request for an address."""
        # A request for another host name was sent by a page of another site, and is refused.
        if self.headers.get("Host") not in self.server.hosts:
            self.send_error(403)
            return
        with self.server.answering:
            found = http_reply_to_requested_address(
                self.server.explorer, self.path, self.server.name
            )
        data = found.text.encode("utf-8", errors="replace")
        self.send_response(found.status)
        self.send_header("Content-Type", found.media_type)
        self.send_header("Content-Length", str(len(data)))
        self.send_header("Content-Security-Policy", CONTENT_SECURITY_POLICY)
        self.send_header("Cache-Control", "no-store")
        if found.file_name:
            name = f"attachment; filename*=UTF-8''{quote(found.file_name)}"
            self.send_header("Content-Disposition", name)
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, format: str, *args: object) -> None:
        """Print no line for a request: many lines would hide the printed address of the page."""


def serve_page_of_brake(brake: Brake, name: str, port: int, ready: Callable[[str], None]) -> None:
    """Serve a brake's page until the process is interrupted.

    Parameters
    ----------
    brake : the brake
    name : beginning of the name of a file that the page saves
    port : network port of the server; 0 for any free port
    ready : function that is called with the address of the page once the page can be opened

    Raises
    ------
    BadInput
        for a port that is not available, and for a brake that finite elements do not cover
    """
    explorer = SliderSolver(brake)
    if not 0 <= port <= 65535:
        raise BadInput(f"--port = {port}: must be from 1 to 65535, or 0 for any free one")
    try:
        server = _Server(explorer, name, port)
    except OSError as error:
        raise BadInput(
            f"--port = {port}: cannot be had ({system_message_of_error(error)}); "
            "0 takes any free one"
        ) from error
    with server:
        ready(f"http://localhost:{server.server_port}/")
        try:
            server.serve_forever(poll_interval=0.2)
        except KeyboardInterrupt:
            signal.signal(signal.SIGINT, signal.SIG_DFL)
