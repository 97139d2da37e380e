"""The table of looks: colours, wording and picture of each item of the grocery set."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

METAL = "#b9bcc2"
TABLE = Path(__file__).with_name("grocery_looks.csv")


@dataclass(frozen=True)
class Look:
    """One row of the table.

    Args:
        colours: sRGB "#rrggbb" of each material.
        brand, product: what is printed on the label, made of the words of the name.
        style: key of `artwork.STYLES`; empty for things without print.
        letters: key of `lettering.FONTS`.
        picture: key of `pictograms.PICTOGRAMS`; empty for none.
    """

    colours: Mapping[str, str]
    brand: str
    product: str
    style: str
    letters: str
    picture: str


def _look(row: Mapping[str, str]) -> Look:
    words = row["name"].split("_")
    brand_words = int(row["brand_words"])
    return Look(
        {"rim": METAL, "collar": row["body"], **{key: row[key] for key in ("body", "label", "cap")}},
        " ".join(words[:brand_words]).title(),
        " ".join(words[brand_words:]),
        row["style"],
        row["letters"],
        row["picture"],
    )


def read_looks() -> Mapping[str, Look]:
    """The looks by name."""
    with TABLE.open(newline="") as file:
        return {row["name"]: _look(row) for row in csv.DictReader(file)}
