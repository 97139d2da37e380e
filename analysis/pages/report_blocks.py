"""What a report is made of: sections with tables, figures, pictures and what has not been measured yet."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from matplotlib.figure import Figure


@dataclass(frozen=True)
class Cell:
    """A cell of a table that is more than text.

    Args:
        text: what it says.
        style: `paper`, `best` or `missing`; told by its type face and mark, colour only repeats it.
    """

    text: str
    style: str = ""


Row = Sequence[str | Cell]


@dataclass(frozen=True)
class Table:
    """A table.

    Args:
        name: its anchor.
        title: what it shows.
        header: headings of the columns; the first column names the rows.
        rows: as many cells as headings.
        sources: names of the result files behind it.
        paper: where the paper shows the same; empty if nowhere.
        note: how to read it.
    """

    kind: ClassVar[str] = "table"
    name: str
    title: str
    header: Sequence[str]
    rows: Sequence[Row]
    sources: Sequence[str]
    paper: str = ""
    note: str = ""


@dataclass(frozen=True, eq=False)
class Chart:
    """A figure that is drawn, and written as PDF, too.

    Args:
        name: its anchor, and the name of the PDF.
        title: what it shows.
        figure: the drawing.
        alt: the same in words, for who cannot see it.
        sources, paper, note: as for tables.
    """

    kind: ClassVar[str] = "chart"
    name: str
    title: str
    figure: Figure
    alt: str
    sources: Sequence[str]
    paper: str = ""
    note: str = ""


@dataclass(frozen=True)
class Picture:
    """A picture that is shipped.

    Args:
        name: its anchor.
        title: what it shows.
        path: PNG or WebP file.
        alt: the same in words.
        command: what made it.
        paper, note: as for tables.
    """

    kind: ClassVar[str] = "picture"
    name: str
    title: str
    path: Path
    alt: str
    command: str
    paper: str = ""
    note: str = ""


@dataclass(frozen=True)
class Missing:
    """Something of the paper that has no result of ours yet.

    Args:
        title: what it would show.
        commands: what measures it, in order; empty if no command can.
        paper: what the paper says, and where.
        so_far: what is there of it.
    """

    kind: ClassVar[str] = "missing"
    title: str
    commands: Sequence[str]
    paper: str
    so_far: str = ""


Block = Table | Chart | Picture | Missing


@dataclass(frozen=True)
class Section:
    """A section of the report.

    Args:
        name: its anchor.
        title: its heading.
        paper: section of the paper; empty if it has none.
        lead: paragraphs before the blocks.
        blocks: what it shows.
    """

    name: str
    title: str
    lead: Sequence[str]
    blocks: Sequence[Block]
    paper: str = ""
    missing: Sequence[Missing] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "missing", [block for block in self.blocks if isinstance(block, Missing)])
