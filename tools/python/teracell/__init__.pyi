from os import PathLike
from types import EllipsisType
from typing import Any, Callable, Mapping, NamedTuple, Sequence, SupportsIndex, overload

import numpy
from numpy.typing import NDArray

from ._errors import Error as Error, FormatError as FormatError, IoError as IoError, UsageError as UsageError

__version__: str

_Path = str | bytes | PathLike[str] | PathLike[bytes]
_Part = SupportsIndex | slice | EllipsisType | None
_Box = Sequence[int]  # z0, y0, x0, z1, y1, x1

class Axis(NamedTuple):
    name: str
    planes: NDArray[numpy.float64]
    samples: NDArray[numpy.float64]

class Material(NamedTuple):
    id: int
    name: str
    color: tuple[int, int, int, int]
    rank: int

class Patch(NamedTuple):
    number: int
    name: str
    body: str
    area: float

class Cells(NamedTuple):
    cells: int
    volume: float
    box: tuple[int, int, int, int, int, int] | None

class Part(NamedTuple):
    rank: int
    box: tuple[int, int, int, int, int, int]
    halo_box: tuple[int, int, int, int, int, int]
    weight: float
    neighbours: list[int]

class Partition(Sequence[Part]):
    path: str
    cells: tuple[int, int, int]
    align: int
    halo: int
    total: float
    method: str
    grid_hash: str
    def __init__(self, path: _Path) -> None: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, rank: SupportsIndex) -> Part: ...
    @overload
    def __getitem__(self, rank: slice) -> list[Part]: ...

class Level:
    number: int
    shape: tuple[int, int, int]
    dtype: numpy.dtype[Any]
    ndim: int
    materials: list[Material]
    @property
    def size(self) -> int: ...
    @property
    def axes(self) -> tuple[Axis, Axis, Axis]: ...
    def __len__(self) -> int: ...
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...
    def __getitem__(self, key: _Part | tuple[_Part, ...]) -> Any: ...
    def read(self, box: _Box, halo: int | Sequence[int] = 0, out: NDArray[Any] | None = None, outside: int = 0,
             map: Sequence[int] | Mapping[int | str, int] | None = None, order: str = "C", threads: int = 0) -> NDArray[Any]: ...
    def runs(self, box: _Box | None = None) -> NDArray[numpy.int64]: ...
    def uniform(self, box: _Box | None = None) -> int | None: ...
    def dask(self, chunks: Any = "auto") -> Any: ...
    def xarray(self, chunks: Any = "auto") -> Any: ...

class Grid(Level):
    path: str
    report: dict[str, Any]
    def __init__(self, path: _Path, cache_dir: _Path | None = None, cache_dir_size: int | None = None, endpoint: str | None = None,
                 allow_http: bool = False) -> None: ...
    @property
    def levels(self) -> int: ...
    @property
    def units(self) -> str: ...
    @property
    def hash(self) -> str: ...
    @property
    def ray_axis(self) -> int: ...
    @property
    def info(self) -> dict[str, Any]: ...
    @property
    def patches(self) -> list[Patch]: ...
    def fractions(self, material: int | str, box: _Box | None = None, outside: float = 0.0, threads: int = 0) -> NDArray[numpy.float64]: ...
    def links(self, box: _Box | None = None, axis: str = "x") -> tuple[
        NDArray[numpy.int64], NDArray[numpy.uint32], NDArray[numpy.uint32], NDArray[numpy.int64]]: ...
    def leaves(self, box: _Box | None = None, coarsest: int = 8, layers: int = 2, *, want: str | Mapping[str, int] | None = None,
               threads: int = 0) -> NDArray[numpy.void]: ...
    def level(self, number: int) -> Level: ...
    def stats(self, box: _Box | None = None) -> list[Cells]: ...
    def column(self, axis: str | int, at: tuple[int, int]) -> NDArray[numpy.int64]: ...

def open(path: _Path, *, cache_dir: _Path | None = None, cache_dir_size: int | None = None, endpoint: str | None = None,
         allow_http: bool = False) -> Grid: ...
def mesh(scene: _Path | Sequence[_Path] | Mapping[str, Any], output: _Path, *, folder: _Path = ".", units: str | None = None, by_part: bool = False,
         cells: int | tuple[int, int, int] | None = None,
         step: float | None = None, pad: int | None = None, axis: str | None = None, engine: str | None = None, threads: int = 0,
         memory: int | None = None, tmp: _Path | None = None, thin: bool = False,
         fractions: Sequence[int] | None = None, links: bool = False, resume: bool = False, deflection: float | str | None = None, angle: float | None = None,
         face_patches: bool = False, cad_memory: int | None = None, cad_seconds: float | None = None,
         progress: Callable[[str, float], object] | None = None) -> Grid: ...
