"""Running the viewer until it is interrupted."""

import logging
from collections.abc import Callable
from ipaddress import ip_address
from typing import Protocol, runtime_checkable

from viser import ViserServer

from preshape.viewer.job_queue import JobQueue
from preshape.viewer.server import ServerSettings, open_server, quiet

TICK_S = 1 / 30

log = logging.getLogger(__name__)


@runtime_checkable
class Session(Protocol):
    """What is shown."""

    def tick(self) -> None:
        """Is called whenever nothing else is to be done."""


def serve(settings: ServerSettings, build: Callable[[ViserServer, JobQueue], Session]) -> None:
    """Show a session in the browser until Ctrl-C.

    Args:
        settings: where to listen.
        build: puts the session together.

    Raises:
        InputError: if the address cannot be listened on, or the session cannot be put together.
    """
    server, jobs = open_server(settings), JobQueue()
    try:
        session = build(server, jobs)
        if not _is_loopback(settings.host):
            log.warning("Anyone who reaches this machine at %s can look and execute grasps", settings.host)
        log.info("Viewer: http://%s:%d (Ctrl-C ends it)", settings.host, server.get_port())
        jobs.serve(session.tick, TICK_S)
        log.info("The viewer has ended")
    finally:
        with quiet():
            server.stop()


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
