"""Which scenes are needed, which are finished, and who works on which."""

import logging
import math
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import numpy as np

from preshape.errors import InputError
from sim.finished_scenes import FinishedScene, SceneBlock

UNFINISHED = -1

log = logging.getLogger(__name__)


class Goal(Protocol):
    """When enough scenes are finished."""

    @property
    def wanted(self) -> int:
        """What the counts of the scenes, from scene 0 on, must add up to; at least 1."""

    @property
    def unit(self) -> str:
        """What is counted."""

    @property
    def note(self) -> str:
        """What else there is to say about the scenes counted so far."""

    def count(self, finished: FinishedScene) -> int:
        """What a finished scene adds."""


class SceneClaims:
    """The scenes of one run, shared by all processes that work in its folder.

    Needed are the scenes from 0 to the first with which the goal's counts add up: the same ones, whoever
    finishes them in whatever order. Scenes are claimed in blocks of consecutive numbers; a block belongs to
    one process until that releases it or ends.

    Args:
        folder: the folder of the run's finished scenes.
        block_size: number of scenes in a block, the same for all that work in the folder.
        limit: number of scenes after which the goal is given up.
        goal: when enough scenes are finished.

    Raises:
        InputError: if the folder cannot be read.
    """

    def __init__(self, folder: Path, block_size: int, limit: int, goal: Goal) -> None:
        self.goal = goal
        self._folder, self._size = folder, block_size
        self._counts = np.full(limit, UNFINISHED)
        self._counted = self._finished = 0
        self._mine: dict[int, SceneBlock] = {}
        self._to_do: deque[int] = deque()
        self._told: set[str] = set()
        there = {path.name for path in folder.glob("*.jsonl")}
        for number in range(math.ceil(limit / block_size)):
            block = self._block(number)
            if block.path.name in there:
                self._note(block.read().finished)

    @property
    def counted(self) -> int:
        """Sum of the counts of the finished scenes."""
        return self._counted

    @property
    def complete(self) -> bool:
        """Whether all needed scenes are finished."""
        return self.counted >= self.goal.wanted and bool((self._counts[: self._end()] != UNFINISHED).all())

    @property
    def exhausted(self) -> bool:
        """Whether all scenes that may be tried are finished, and are not enough."""
        return self.counted < self.goal.wanted and self._finished == len(self._counts)

    def next(self) -> int | None:
        """Number of a needed scene that is this process's to finish; None if there is none now.

        Raises:
            InputError: if no block can be claimed because its file cannot be written.
        """
        while self._to_do or self._claim():
            number = self._to_do.popleft()
            if number < self._end():
                return number
        return None

    def add(self, finished: FinishedScene) -> None:
        """Keep a scene that `next` gave and that is finished now; it is safe on disk when this returns.

        Raises:
            InputError: if it cannot be written.
        """
        number = finished.scene_id // self._size
        block = self._mine[number]
        block.add(finished)
        self._note({finished.scene_id: finished})
        if not self._missing(block):
            self._mine.pop(number).release()

    def look(self) -> None:
        """Take note of what other processes have finished."""
        for block in self._unfinished():
            self._note(block.read().finished)

    def finished(self) -> Iterator[FinishedScene]:
        """The needed scenes in the order of their numbers, once `complete`.

        Raises:
            InputError: if someone has deleted or altered their files in the meantime.
        """
        end = self._end()
        for number in range(math.ceil(end / self._size)):
            block = self._block(number)
            finished = block.read().finished
            for scene_id in range(block.numbers.start, min(block.numbers.stop, end)):
                if scene_id not in finished:
                    raise InputError(
                        f"Scene {scene_id} was finished, and is missing or damaged now",
                        where=block.path,
                        fix="start the same command again; it makes the scene again",
                    )
                yield finished[scene_id]

    def close(self) -> None:
        """Release all blocks."""
        while self._mine:
            self._mine.popitem()[1].release()

    def _block(self, number: int) -> SceneBlock:
        first = number * self._size
        numbers = range(first, min(first + self._size, len(self._counts)))
        return SceneBlock(self._folder / f"scenes_{first:07d}.jsonl", numbers)

    def _end(self) -> int:
        """Number after the last scene that is needed, as far as is known: it only ever falls."""
        if self.counted < self.goal.wanted:
            return len(self._counts)
        sums = np.maximum(self._counts, 0).cumsum()
        return int(np.searchsorted(sums, self.goal.wanted)) + 1

    def _unfinished(self) -> Iterator[SceneBlock]:
        """The blocks with needed scenes that this process has not claimed."""
        open_numbers = np.flatnonzero(self._counts[: self._end()] == UNFINISHED) // self._size
        yield from (self._block(number) for number in np.unique(open_numbers) if number not in self._mine)

    def _missing(self, block: SceneBlock) -> list[int]:
        return [number for number in block.numbers if self._counts[number] == UNFINISHED]

    def _note(self, finished: dict[int, FinishedScene]) -> None:
        for number, scene in finished.items():
            if number < len(self._counts) and self._counts[number] == UNFINISHED:
                self._counts[number] = self.goal.count(scene)
                self._counted += int(self._counts[number])
                self._finished += 1

    def _claim(self) -> bool:
        for block in self._unfinished():
            claimed = block.claim()
            content = block.read()
            self._note(content.finished)
            missing = self._missing(block)
            if not claimed:
                self._tell(f"{content.owner} works on the same scenes; they are shared.")
            elif not missing:
                block.release()
            else:
                if content.damaged:
                    self._tell(f"{block.path}: {content.damaged} damaged; what they held is made again.")
                self._mine[block.numbers.start // self._size] = block
                self._to_do.extend(missing)
                return True
        return False

    def _tell(self, message: str) -> None:
        if message not in self._told:
            self._told.add(message)
            log.warning("%s", message)
