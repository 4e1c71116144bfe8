"""The materials of a grid, by id and by name."""
import collections

import numpy

from ._arguments import shown, whole
from ._errors import UsageError

Material = collections.namedtuple("Material", "id name color rank")
Material.__doc__ = """A material: its id, its name, its colour (red, green, blue, alpha) and its rank, 0 for the strongest."""


class Materials(list):
    """A list of Material by id, which takes names, too: materials["steel"].id, "steel" in materials."""

    def __getitem__(self, key):
        if not isinstance(key, str):
            return super().__getitem__(key)
        if key not in self:
            raise KeyError(self._unknown(key))
        return self[self.id_of(key)]

    def __contains__(self, key):
        return any(m.name == key for m in self) if isinstance(key, str) else super().__contains__(key)

    @property
    def names(self):
        return [m.name for m in self]

    def id_of(self, material):
        """The id of a material that is given by its id, its name, or as a Material."""
        if isinstance(material, Material):
            material = material.id
        if isinstance(material, str):
            if material not in self:
                raise UsageError(self._unknown(material))
            return self.names.index(material)
        if isinstance(material, (bool, numpy.bool_)):
            raise UsageError(f"material: expected an id or a name, found {shown(material)}")
        return whole("material", material, 0, len(self) - 1)

    def _unknown(self, name):
        return f"material: expected a name of {', '.join(self.names)}, found {shown(name)}"
