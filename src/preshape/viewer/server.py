"""The web server of the viewer."""

import logging
import socket
from contextlib import AbstractContextManager, redirect_stdout
from dataclasses import dataclass
from io import StringIO

from viser import ViserServer

from preshape.errors import InputError


@dataclass(frozen=True)
class ServerSettings:
    """Where the viewer listens.

    Args:
        host: address; 127.0.0.1 is reached from this machine alone.
        port: number of the port; 0 for any that is free.
    """

    host: str = "127.0.0.1"
    port: int = 8080


def quiet() -> AbstractContextManager[object]:
    """Keeps what viser prints beside our own lines from the terminal."""
    return redirect_stdout(StringIO())


def open_server(settings: ServerSettings) -> ViserServer:
    """Start the server.

    Raises:
        InputError: if the address cannot be listened on, for instance because another program does.
    """
    _check_free(settings)
    # A browser that is closed while it connects is nobody's error.
    logging.getLogger("websockets").setLevel(logging.CRITICAL)
    with quiet():
        server = ViserServer(host=settings.host, port=settings.port, label="preshape", verbose=False)
    if settings.port and server.get_port() != settings.port:  # someone took it meanwhile, and viser moved on
        server.stop()
        raise _not_free(settings, "it was taken meanwhile")
    server.gui.configure_theme(control_width="large", show_logo=False)
    server.gui.main_panel.dock_right()
    return server


def _check_free(settings: ServerSettings) -> None:
    try:
        with socket.create_server((settings.host, settings.port)):
            pass
    except (OSError, OverflowError) as error:
        raise _not_free(settings, str(error)) from error


def _not_free(settings: ServerSettings, why: str) -> InputError:
    return InputError(
        f"The viewer cannot listen there: {why}",
        where=f"{settings.host}:{settings.port}",
        fix="end the other program, or choose another port with port=8081 (port=0 takes any that is free)",
    )
