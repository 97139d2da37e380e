"""Where the viewer listens."""

import socket

import psutil
import pytest

from preshape.errors import InputError
from preshape.viewer.server import ServerSettings, open_server


def test_only_this_machine_can_look() -> None:
    server = open_server(ServerSettings(port=0))
    try:
        listening = [c for c in psutil.Process().net_connections("inet") if c.status == psutil.CONN_LISTEN]
        assert {c.laddr.ip for c in listening if c.laddr.port == server.get_port()} == {"127.0.0.1"}
        with pytest.raises(InputError, match="cannot listen"):
            open_server(ServerSettings(port=server.get_port()))
    finally:
        server.stop()


@pytest.mark.parametrize("settings", [ServerSettings(port=70_000), ServerSettings(host="nowhere.invalid")])
def test_an_address_that_is_none_is_refused(settings: ServerSettings) -> None:
    with pytest.raises(InputError, match="cannot listen"):
        open_server(settings)


def test_port_is_free_again_after_the_end() -> None:
    server = open_server(ServerSettings(port=0))
    port = server.get_port()
    server.stop()
    with socket.create_server(("127.0.0.1", port)):
        pass
