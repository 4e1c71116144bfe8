"""Debian's python3-zarr, dask and xarray over fsspec: Zarr v2."""
import unittest

import dask.array
import fsspec
import numpy
import xarray
import zarr

from support import GRIDS, LEVELS, SERVER, Case, exported, levels

AXES = ("x", "y", "z")


def planes(axis):
    if axis["type"] == "graded":
        return numpy.array(axis["planes"])
    return axis["min"] + (axis["first"] + numpy.arange(axis["cells"] + 1)) * axis["step"]


def centres(axis, sample):
    if axis["type"] == "graded":
        p = planes(axis)
        return p[:-1] + sample * (p[1:] - p[:-1])
    return axis["min"] + ((axis["first"] + numpy.arange(axis["cells"])) + sample) * axis["step"]


def open_level(grid, level):
    return xarray.open_zarr(f"{SERVER}/xarray/{grid}/{level}", consolidated=True)


class Zarr(Case):
    def test_every_level_is_as_exported(self):
        for grid, level in LEVELS:
            with self.subTest(grid=grid, level=level):
                array = zarr.open_array(f"{SERVER}/zarr2/{grid}/{level}", mode="r")
                self.assertEqual(array.fill_value, 0)
                self.assert_same(array[:], exported(grid, level))

    def test_the_group_names_its_levels(self):
        for grid in GRIDS:
            group = zarr.open_group(f"{SERVER}/zarr2/{grid}", mode="r")
            datasets = group.attrs["multiscales"][0]["datasets"]
            # The last listed level is the first that is a single block. Coarser levels exist, but are not listed.
            many = [str(l["level"]) for l in GRIDS[grid]["levels"] if max(l["cells"]) > 64]
            self.assertEqual([d["path"] for d in datasets], many + [str(len(many))])
            self.assert_same(group["3"][:], exported(grid, 3))

    def test_slices_and_points(self):
        for grid in GRIDS:
            array, expected = zarr.open_array(f"{SERVER}/zarr2/{grid}/0", mode="r"), exported(grid, 0)
            for where in [numpy.s_[:, 63:65, ::7], numpy.s_[-1], numpy.s_[..., -1], numpy.s_[2:7, -3:, 250:]]:
                self.assert_same(array[where], expected[where])
            at = tuple(numpy.random.default_rng(1).integers(0, n, 300) for n in expected.shape)
            self.assert_same(array.vindex[at], expected[at])

    def test_dask(self):
        for grid in GRIDS:
            array, expected = dask.array.from_zarr(f"{SERVER}/zarr2/{grid}/0"), exported(grid, 0)
            self.assert_same(array.compute(), expected)
            counts = dask.array.bincount(array.ravel(), minlength=len(GRIDS[grid]["materials"])).compute()
            self.assertEqual(counts.tolist(), numpy.bincount(expected.ravel(), minlength=len(GRIDS[grid]["materials"])).tolist())


class Xarray(Case):
    def test_every_level_is_as_exported(self):
        for grid, level in LEVELS:
            with self.subTest(grid=grid, level=level):
                label = open_level(grid, level)["label"]
                self.assertEqual(label.dims, ("z", "y", "x"))
                self.assert_same(label.values, exported(grid, level))  # integers: no cell is taken for a missing value, which would make them floats

    def test_coordinates_are_those_of_the_cells(self):
        for grid in GRIDS:
            data = open_level(grid, 0)
            for name, axis, sample in zip(AXES, GRIDS[grid]["grid"]["axes"], GRIDS[grid]["grid"]["sample"]):
                self.assert_same(data[name].values, centres(axis, sample))
                self.assertEqual(data[name].attrs["units"], GRIDS[grid]["units"])

    def test_coordinates_of_coarse_cells_are_in_their_middle(self):
        for grid, level in LEVELS:
            if level == 0:
                continue
            with self.subTest(grid=grid, level=level):
                data = open_level(grid, level)
                for name, axis in zip(AXES, GRIDS[grid]["grid"]["axes"]):
                    p = planes(axis)
                    ends = numpy.append(p[:-1][::2 ** level], p[-1])
                    self.assert_same(data[name].values, (ends[:-1] + ends[1:]) / 2)

    def test_places_are_found_by_coordinate(self):
        for grid in GRIDS:
            data, expected, axes = open_level(grid, 0), exported(grid, 0), GRIDS[grid]["grid"]["axes"]
            for part in (0.1, 0.37, 0.5, 0.93):
                at = {name: planes(axis)[0] + part * (planes(axis)[-1] - planes(axis)[0]) for name, axis in zip(AXES, axes)}
                index = [numpy.abs(centres(axis, 0.5) - at[name]).argmin() for name, axis in zip(AXES, axes)]
                self.assertEqual(data["label"].sel(at, method="nearest").compute().item(), expected[index[2], index[1], index[0]])

    def test_a_level_needs_no_listing(self):
        address = f"{SERVER}/xarray/parts/2"
        self.assert_same(zarr.open_consolidated(address)["label"][:], exported("parts", 2))
        for key in ("nothing", "label/9/9/9", "label/0/0", "label/00/0/0"):
            self.assertNotIn(key, fsspec.get_mapper(address))


if __name__ == "__main__":
    unittest.main()
