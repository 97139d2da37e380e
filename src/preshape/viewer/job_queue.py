"""What the browser asks for, done one after the other in the main thread."""

import threading
from collections.abc import Callable

Job = Callable[[], None]


class JobQueue:
    """Jobs that wait. A job that is asked for again before it was done is done once.

    The browser's events come in threads of their own, while the simulator and the scene want one thread.
    """

    def __init__(self) -> None:
        self._waiting: dict[Job, None] = {}
        self._changed = threading.Condition()

    def put(self, job: Job) -> None:
        """Ask for a job; the latest comes last."""
        with self._changed:
            self._waiting.pop(job, None)
            self._waiting[job] = None
            self._changed.notify()

    def work_off(self) -> None:
        """Do all jobs that wait, and those that they ask for."""
        while (job := self._next(0.0)) is not None:
            job()

    def serve(self, idle: Job, period_s: float) -> None:
        """Do jobs as they come, and another one whenever none came for a while; returns at an interrupt.

        Args:
            idle: what is done then.
            period_s: how long a while is.
        """
        try:
            while True:
                (self._next(period_s) or idle)()
        except KeyboardInterrupt:
            return

    def _next(self, timeout_s: float) -> Job | None:
        with self._changed:
            if not self._waiting:
                self._changed.wait(timeout_s)
            job = next(iter(self._waiting), None)
            self._waiting.pop(job, None) if job else None
            return job
