"""The disk, the shipped data and the MLflow store."""

import os
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

from preshape.health.finding import Finding, Status

GIGABYTE = 1e9
SHIPPED_TABLES = ("scenes.parquet", "trials.parquet")
PARQUET_MAGIC = b"PAR1"


def check_disk(folder: Path, *, warn_below_gb: float = 5.0, fail_below_gb: float = 1.0) -> Finding:
    """Whether runs and caches have room."""
    free_gb = shutil.disk_usage(folder).free / GIGABYTE
    detail = f"{free_gb:.1f} GB free at {folder}"
    if not os.access(folder, os.W_OK):
        return Finding("Disk", Status.FAIL, f"{folder} cannot be written to", f"sudo chown -R $USER {folder}")
    if free_gb >= warn_below_gb:
        return Finding("Disk", Status.OK, detail)
    status = Status.WARN if free_gb >= fail_below_gb else Status.FAIL
    return Finding("Disk", status, detail, "make clean (caches), delete old runs in outputs/")


def check_shipped_table(folder: Path) -> Finding:
    """Whether the trial table that the project ships is there and whole."""
    for name in SHIPPED_TABLES:
        problem = _parquet_problem(folder / name)
        if problem:
            fix = f"git restore {folder / name}"
            return Finding("Shipped trial table", Status.FAIL, f"{folder / name} {problem}", fix)
    return Finding("Shipped trial table", Status.OK, str(folder))


def check_mlflow_store(database: Path, tracking_uri: str | None) -> Finding:
    """Whether the store of training runs can be used.

    Args:
        database: the SQLite file that is used when nothing else is set.
        tracking_uri: value of MLFLOW_TRACKING_URI, if it is set.
    """
    if tracking_uri and "://" not in tracking_uri.replace("file://", ""):
        return Finding(
            "MLflow store",
            Status.FAIL,
            f"MLFLOW_TRACKING_URI={tracking_uri} is a folder, which MLflow no longer accepts",
            f"unset MLFLOW_TRACKING_URI, or set it to sqlite:///{database}",
        )
    if tracking_uri:
        return Finding("MLflow store", Status.OK, f"{tracking_uri} (not contacted)")
    if not database.exists():
        return Finding("MLflow store", Status.OK, f"{database} will be made by the first training")
    try:
        with closing(sqlite3.connect(f"file:{database}?mode=ro", uri=True)) as connection:
            (runs,) = connection.execute("SELECT count(*) FROM runs").fetchone()
    except sqlite3.Error as error:
        fix = f"mv {database} {database}.broken (the next training makes a new one)"
        return Finding("MLflow store", Status.FAIL, f"{database}: {error}", fix)
    return Finding("MLflow store", Status.OK, f"{database} with {runs} runs")


def _parquet_problem(path: Path) -> str | None:
    if not path.is_file():
        return "is missing"
    with path.open("rb") as file:
        begin = file.read(len(PARQUET_MAGIC))
        file.seek(0, os.SEEK_END)
        file.seek(max(0, file.tell() - len(PARQUET_MAGIC)))
        whole = begin == file.read() == PARQUET_MAGIC
    return None if whole else "is not a whole Parquet file"
