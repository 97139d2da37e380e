"""The tables of a finished collection, written by one of those who shared the work."""

import fcntl
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from preshape.data.tables import write_data_set
from preshape.data.trial_table import TableOrigin
from preshape.grasps.space import GraspSpace
from sim.finished_scenes import FinishedScene, refusal, to_tables

log = logging.getLogger(__name__)


def write_tables(
    finished: Iterator[FinishedScene],
    origin: TableOrigin,
    space: GraspSpace,
    output: Path,
    lock: Path,
    *,
    wait: bool,
) -> None:
    """Write both tables, unless another process is writing them.

    Args:
        finished: the scenes in the order of their numbers.
        origin, space: what the tables are about.
        output: their folder.
        lock: the file that all who write them lock.
        wait: whether to wait for the others and write them again.

    Raises:
        InputError: if they cannot be written.
    """
    with _one_at_a_time(lock, wait=wait) as my_turn:
        if not my_turn:
            log.info("Enough trials; another shard writes the table: %s", output)
            return
        scenes, trials = to_tables(finished, origin, space)
        write_data_set(output, scenes, trials)
    n_lifted, n_executed = trials.lifted.sum(), len(trials.executed)
    log.info("Lifted %d of %d executed trials on %d scenes: %s", n_lifted, n_executed, len(scenes), output)


@contextmanager
def _one_at_a_time(lock: Path, *, wait: bool) -> Iterator[bool]:
    """Keep other processes out of the body.

    Args:
        lock: the file that they all lock.
        wait: whether to wait for them. Otherwise the body is told False if one of them is in it.

    Raises:
        InputError: if the file cannot be locked.
    """
    try:
        handle = lock.open("a")
        fcntl.flock(handle, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        free = True
    except BlockingIOError:
        free = False
    except OSError as error:
        raise refusal("locked", lock, error) from error
    with handle:
        yield free
