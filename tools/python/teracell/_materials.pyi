from typing import NamedTuple, SupportsIndex, overload

class Material(NamedTuple):
    id: int
    name: str
    color: tuple[int, int, int, int]
    rank: int

class Materials(list[Material]):
    @overload
    def __getitem__(self, key: SupportsIndex | str) -> Material: ...
    @overload
    def __getitem__(self, key: slice) -> list[Material]: ...
    def __contains__(self, key: object) -> bool: ...
    @property
    def names(self) -> list[str]: ...
    def id_of(self, material: int | str | Material) -> int: ...
