"""Parquet files that say what they hold, and are refused when they hold something else."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from jaxtyping import Float

from preshape.errors import InputError
from preshape.files import atomic_path

METADATA_KEY = b"preshape"


@dataclass(frozen=True)
class TableFormat:
    """One kind of table file.

    Args:
        kind: what its rows are (`trials`).
        version: raised whenever old files could be misread.
        maker: command that writes such files.
    """

    kind: str
    version: int
    maker: str


def write_table(
    path: str | Path, table_format: TableFormat, columns: Mapping[str, pa.Array], about: Mapping[str, Any]
) -> None:
    """Write columns atomically, with `about` in the file's metadata.

    Raises:
        InputError: if the place cannot be written to.
    """
    metadata = {"kind": table_format.kind, "version": table_format.version, **about}
    table = pa.table(dict(columns)).replace_schema_metadata({METADATA_KEY: json.dumps(metadata)})
    with atomic_path(path) as temporary:
        pq.write_table(table, temporary, compression="zstd")


def read_table(path: str | Path, table_format: TableFormat) -> tuple[pa.Table, dict[str, Any]]:
    """Read a table of this format.

    Returns:
        The table, and what `write_table` was told about it.

    Raises:
        InputError: if the file is missing, unreadable, or of another kind or version.
    """
    path = Path(path)
    table = _read_parquet(path, table_format)
    return table, _metadata(table, path, table_format)


def check_columns(
    table: pa.Table, columns: Mapping[str, pa.DataType], path: str | Path, table_format: TableFormat
) -> None:
    """Refuse a table that has not exactly these columns, or empty cells in them.

    Raises:
        InputError: naming the columns at fault.
    """
    found = {field.name: field.type for field in table.schema}
    names = sorted(found.keys() | columns.keys())
    for problem, at_fault in (
        ("missing, additional or mistyped columns", [n for n in names if found.get(n) != columns.get(n)]),
        ("empty cells", [n for n in found if table[n].null_count]),
    ):
        if at_fault:
            raise InputError(
                f"The table of {table_format.kind} has {problem}: {', '.join(at_fault)}",
                where=path,
                fix=f"write it with `{table_format.maker}`",
            )


def vectors(rows: Float[np.ndarray, "n k"]) -> pa.Array:
    """One vector of k doubles per row."""
    return pa.FixedSizeListArray.from_arrays(pa.array(rows.ravel()), rows.shape[1])


def vector_type(length: int) -> pa.DataType:
    """Type of the column that `vectors` makes."""
    return pa.list_(pa.float64(), length)


def to_vectors(column: pa.ChunkedArray) -> Float[np.ndarray, "n k"]:
    """The rows of a column of vectors."""
    array = column.combine_chunks()
    values: np.ndarray = array.flatten().to_numpy(zero_copy_only=False)
    return values.reshape(len(column), column.type.list_size).copy()


def _read_parquet(path: Path, table_format: TableFormat) -> pa.Table:
    if not path.is_file():
        raise InputError(
            f"There is no table of {table_format.kind}",
            where=path,
            fix=f"give the folder of a data set, or collect one with `{table_format.maker}`",
        )
    try:
        return pq.ParquetFile(path).read()
    except (OSError, pa.ArrowException) as error:
        raise InputError(
            f"The table of {table_format.kind} cannot be read: {error}",
            where=path,
            fix=f"copy it again, or collect it with `{table_format.maker}`",
        ) from error


def _metadata(table: pa.Table, path: Path, table_format: TableFormat) -> dict[str, Any]:
    try:
        about = json.loads((table.schema.metadata or {})[METADATA_KEY])
        kind, version = about.pop("kind"), about.pop("version")
    except (KeyError, ValueError, AttributeError, TypeError, RecursionError) as error:
        raise InputError(
            f"The Parquet file is not a table of {table_format.kind} of this project",
            where=path,
            fix=f"give a file that `{table_format.maker}` wrote",
        ) from error
    if (kind, version) != (table_format.kind, table_format.version):
        raise InputError(
            f"The file holds {kind}, version {version}; "
            f"wanted are {table_format.kind}, version {table_format.version}",
            where=path,
            fix=f"use the release that wrote it, or write it anew with `{table_format.maker}`",
        )
    return dict(about)
