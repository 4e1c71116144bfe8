"""Grids as xarray's datasets: xarray.open_dataset("g.tcell", engine="teracell"), or engine=teracell.xarray.Backend where the package's metadata
is not on Python's path."""
from __future__ import annotations

import functools
import json
import os
from collections.abc import Callable, Iterable
from typing import Any

import numpy
import xarray
from xarray.backends import BackendArray, BackendEntrypoint
from xarray.core import indexing

import teracell

DECODING = {"mask_and_scale", "decode_times", "decode_timedelta", "decode_coords", "use_cftime", "concat_characters"}
PREFERRED = 512  # cells along the edge of a block of dask, with chunks={}: 134 MB of bytes


class Backend(BackendEntrypoint):
    """A dataset with the variable `material` (z, y, x), the ids of materials, and the sample points of the cells as coordinates."""

    description = "Cartesian grids of materials (.tcell)"
    open_dataset_parameters = ("filename_or_obj", "drop_variables", "level", "cache_dir", "cache_dir_size", "endpoint", "allow_http")

    def open_dataset(  # type: ignore[override]
            self, filename_or_obj: Any, drop_variables: str | Iterable[str] | None = None, *, level: int = 0, cache_dir: Any = None,
            cache_dir_size: int | None = None, endpoint: str | None = None, allow_http: bool = False, **decoding: Any) -> xarray.Dataset:
        """Opens one level of a grid; the other options are those of teracell.open(). What other engines are told of decoding means nothing here."""
        if unknown := set(decoding) - DECODING:
            raise TypeError(f"open_dataset() got an unexpected keyword argument '{min(unknown)}'")
        reopen = functools.partial(
            teracell.open, filename_or_obj, cache_dir=cache_dir, cache_dir_size=cache_dir_size, endpoint=endpoint, allow_http=allow_http)
        grid = reopen()
        chosen = grid.level(level)
        chunks = {name: PREFERRED for name, n in zip("zyx", chosen.shape) if n > PREFERRED}
        cells = xarray.Variable(("z", "y", "x"), indexing.LazilyIndexedArray(Cells(grid, chosen, reopen)), attributes(chosen), {"preferred_chunks": chunks})
        dataset = xarray.Dataset({"material": cells}, coordinates(chosen), {"units": grid.units, "level": level, "hash": grid.hash})
        if drop_variables is not None:
            dataset = dataset.drop_vars(drop_variables, errors="ignore")
        dataset.set_close(grid.close)
        return dataset

    def guess_can_open(self, filename_or_obj: Any) -> bool:
        return isinstance(filename_or_obj, (str, os.PathLike)) and os.fspath(filename_or_obj).endswith(".tcell")


class Cells(BackendArray):
    """A level, of which xarray reads what it needs."""

    def __init__(self, grid: teracell.Grid, level: teracell.Level, reopen: Callable[[], teracell.Grid]) -> None:
        self.grid, self.level, self.reopen, self.hash = grid, level, reopen, grid.hash
        self.shape, self.dtype = level.shape, level.dtype

    def _open_again(self) -> None:
        """As other engines do, for a variable that has outlived its dataset."""
        grid = self.reopen()
        if grid.hash != self.hash:
            raise teracell.UsageError(f"{grid.path}: expected the grid with the hash {self.hash}, found {grid.hash}: it was replaced")
        self.grid, self.level = grid, grid.level(self.level.number)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        if self.grid.closed:
            self._open_again()
        if not isinstance(key, indexing.VectorizedIndexer):  # xarray 2023.1 would lose a cell of [::-9] on the way, so it is not asked
            return numpy.asarray(self.level._orthogonal(key.tuple))
        if all(isinstance(part, numpy.ndarray) for part in key.tuple):
            return self.level[key.tuple]  # points
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self.level._orthogonal)


def coordinates(level: teracell.Level) -> dict[str, tuple[str, Any, dict[str, str]]]:
    """The sample points along each axis."""
    return {axis.name: (axis.name, axis.samples, {"units": level.units, "axis": axis.name.upper()}) for axis in level.axes}


def attributes(level: teracell.Level) -> dict[str, Any]:
    """The materials: as JSON, by id, and as the CF conventions want them, where blanks in names are underscores."""
    names = level.materials.names
    return {"materials": json.dumps({str(id): name for id, name in enumerate(names)}), "flag_values": numpy.arange(len(names), dtype=level.dtype),
            "flag_meanings": " ".join("_".join(name.split()) for name in names)}
