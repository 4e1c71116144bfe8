"""xarray and dask on grids: the engine, lazy arrays, and names of tasks."""
import pickle
import shutil
import unittest

import dask
import dask.array
import numpy
import teracell
import teracell.xarray
import xarray

from support import folder, grids


class Engine(unittest.TestCase):
    def test_a_dataset_has_the_cells_and_their_sample_points(self):
        grid = teracell.open(grids[0])
        for options in ({"engine": "teracell"}, {"engine": teracell.xarray.Backend}, {}):
            with xarray.open_dataset(grids[0], **options) as dataset:
                self.assertEqual(dataset.material.dims, ("z", "y", "x"))
                numpy.testing.assert_array_equal(dataset.material.values, grid[...])
                for axis in grid.axes:
                    numpy.testing.assert_array_equal(dataset[axis.name], axis.samples)
                    self.assertEqual(dataset[axis.name].attrs["units"], grid.units)
                self.assertEqual(dataset.attrs, {"units": "m", "level": 0, "hash": grid.hash})
                self.assertEqual(dataset.material.attrs["flag_meanings"], "air explosive grandstand structure")
                self.assertEqual(dataset.material.attrs["flag_values"].tolist(), [0, 1, 2, 3])

    def test_levels_and_variables_are_chosen(self):
        level = teracell.open(grids[0]).level(2)
        with xarray.open_dataset(grids[0], engine="teracell", level=2) as dataset:
            numpy.testing.assert_array_equal(dataset.material, level[...])
        self.assertEqual(list(xarray.open_dataset(grids[0], engine="teracell", drop_variables="material")), [])
        with self.assertRaisesRegex(ValueError, "level: expected 0 to"):
            xarray.open_dataset(grids[0], engine="teracell", level=99)
        with self.assertRaises(FileNotFoundError):
            xarray.open_dataset(folder / "none.tcell", engine="teracell")

    def test_selections_are_those_of_an_array_in_memory(self):
        cells = teracell.open(grids[1])[...]
        in_memory = xarray.open_dataset(grids[1], engine="teracell").load().material
        numpy.testing.assert_array_equal(in_memory, cells)
        points = {name: xarray.DataArray([3, 9, 3, 1], dims="point") for name in "zyx"}
        for ask in (
            lambda a: a.isel(z=3),
            lambda a: a.isel(z=-1, x=[4, 2, 2, -1]),
            lambda a: a.isel(z=[1, 0], y=[7, 3], x=slice(None, None, -9)),
            lambda a: a.isel(points),
            lambda a: a.isel(z=points["z"], x=points["x"]),
            lambda a: a.isel(x=[]),
            lambda a: a.isel(z=2, y=3, x=4),
            lambda a: a.sel(x=0.7, y=3, z=5, method="nearest"),
            lambda a: a.sel(x=slice(-20, 30)),
            lambda a: a[::2, 4],
            lambda a: a[::2, 4][3],
            lambda a: (a == 2).sum(),
            lambda a: a.where(a == 3, drop=True),
            lambda a: a.coarsen(z=2, y=3, x=5, boundary="trim").max(),
        ):
            with xarray.open_dataset(grids[1], engine="teracell") as dataset:
                xarray.testing.assert_identical(ask(dataset.material), ask(in_memory))

    def test_only_what_is_selected_is_read(self):
        dataset = xarray.open_dataset(grids[0], engine="teracell", cache=False)
        file = dataset._close.__self__._file
        native, read = file.native, []

        class Recorder:
            def read(self, level, first, step, out, *more):
                read.append(out.size)
                native.read(level, first, step, out, *more)

        file.native = Recorder()
        dataset.material.isel(z=[0, 20], y=[3, 90], x=5).load()
        dataset.material.isel({name: xarray.DataArray([3, 20, 9], dims="point") for name in "zyx"}).load()
        self.assertLess(sum(read), 20)

    def test_chunks_are_read_by_dask_and_closing_closes(self):
        dataset = xarray.open_dataset(grids[0], engine="teracell", chunks={"z": 7})
        self.assertEqual(dataset.material.chunks[0][0], 7)
        self.assertEqual(int((dataset.material == 3).sum()), teracell.open(grids[0]).stats()[3].cells)
        numpy.testing.assert_array_equal(pickle.loads(pickle.dumps(dataset)).material[3], dataset.material[3])
        self.assertEqual(xarray.open_dataset(grids[0], engine="teracell", chunks={}).material.chunks, tuple((n,) for n in dataset.material.shape))
        expected = dataset.material.compute()
        dataset.close()
        numpy.testing.assert_array_equal(dataset.material, expected)  # what has outlived its dataset opens the file again, as with other engines

    def test_what_was_opened_is_read_or_refused_even_if_the_file_is_replaced(self):
        path = folder / "replaced.tcell"
        shutil.copy(grids[0], path)
        with xarray.open_dataset(path, engine="teracell", decode_times=False, mask_and_scale=True) as dataset:
            material = dataset.material
        pickled = pickle.dumps(teracell.open(path))
        shutil.copy(grids[1], path)
        for read in (lambda: material.values, lambda: pickle.loads(pickled)):
            with self.assertRaisesRegex(ValueError, "it was replaced"):
                read()
        with self.assertRaises(TypeError):
            xarray.open_dataset(path, engine="teracell", decode="times")

    def test_a_dataset_is_saved_as_netcdf(self):
        with xarray.open_dataset(grids[0], engine="teracell", level=2) as dataset:
            dataset.to_netcdf(folder / "saved.nc")
            with xarray.open_dataset(folder / "saved.nc") as saved:
                xarray.testing.assert_equal(saved, dataset)


class Dask(unittest.TestCase):
    def test_equal_files_have_equal_tokens_and_levels_have_their_own(self):
        shutil.copy(grids[0], folder / "copy.tcell")
        first, again, copy, other = map(teracell.open, (grids[0], grids[0], folder / "copy.tcell", grids[1]))
        tokens = [dask.base.tokenize(g) for g in (first, again, copy, first.level(0))]
        self.assertEqual(len(set(tokens)), 1)
        self.assertEqual(len({tokens[0], dask.base.tokenize(first.level(1)), dask.base.tokenize(other)}), 3)
        self.assertEqual(first.dask(chunks=40).name, again.dask(chunks=40).name)
        self.assertNotEqual(first.dask(chunks=40).name, first.dask(chunks=20).name)

    def test_arrays_of_dask_read_what_is_asked_of_them(self):
        grid = teracell.open(grids[0])
        cells = grid[...]
        for lazy in (dask.array.from_array(grid, chunks=40), dask.array.from_array(grid), grid.dask(chunks=(10, 64, 64))):
            self.assertEqual((lazy.shape, lazy.dtype), (grid.shape, grid.dtype))
            in_memory = dask.array.from_array(cells, chunks=lazy.chunks)
            for ask in (lambda a: a[3], lambda a: a[[5, 1]], lambda a: a[:, [50, 3]][::2], lambda a: a[0, :, [3, 140]], lambda a: (a == 2).sum(),
                        lambda a: a.max(axis=0)):
                numpy.testing.assert_array_equal(ask(lazy), ask(in_memory))
        both = (grid.dask(chunks=40) == grid.dask(chunks=20)).all()  # in one graph
        self.assertTrue(both.compute())


if __name__ == "__main__":
    unittest.main()
