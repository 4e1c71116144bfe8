"""The installed library through C, C++, Fortran and Python, against `teracell export` and against NumPy."""
import collections
import itertools
import json
import pathlib
import pickle
import random
import re
import signal
import subprocess
import unittest

import numpy
import teracell

from support import ENVIRONMENT, EXAMPLES, PREFIX, PROGRAM, SOURCES, cmake_project, compiled, cut, exported, folder, grids, random_box, run, stadium_scene


class Boxes(unittest.TestCase):
    def test_random_boxes_through_every_language_are_those_of_export(self):
        rng = random.Random(1)
        programs = [compiled(SOURCES / name) for name in ("boxes.c", "boxes.cpp", "boxes.f90")]
        for path in grids:
            grid = teracell.open(path)
            lines, expected = [], []
            for level in range(grid.levels):
                cells = exported(path, level)
                self.assertEqual(cells.shape, grid.level(level).shape)
                for _ in range(12):
                    box, dtype = random_box(rng, cells.shape), rng.choice([numpy.uint8, numpy.uint16, numpy.uint32])
                    z0, y0, x0, z1, y1, x1 = box
                    lines.append(f"{level} {numpy.dtype(dtype).itemsize} 77 {x0} {y0} {z0} {x1} {y1} {z1}")
                    expected.append(cut(cells, box, 77, dtype))
                    found = grid.level(level).read(box, out=numpy.empty(expected[-1].shape, dtype), outside=77)
                    numpy.testing.assert_array_equal(found, expected[-1])
            whole = b"".join(e.tobytes() for e in expected)
            for program in programs:
                self.assertTrue(run(program, path, input=("\n".join(lines) + "\n").encode()) == whole, (program, path))

    def test_an_array_to_fill_may_have_any_order_and_strides(self):
        rng = random.Random(2)
        for path in grids:
            grid, cells = teracell.open(path), exported(path, 0)
            for _ in range(30):
                box = random_box(rng, cells.shape)
                expected = cut(cells, box, 9, numpy.uint8)
                n = expected.shape
                large = numpy.full([3 * s for s in n], 200, rng.choice([numpy.uint8, numpy.int16, numpy.uint32]))
                order = rng.sample(range(3), 3)
                steps = [rng.choice([1, 2, 3, -1, -2]) for _ in n]
                view = large.transpose(order)
                n_view = [3 * n[order[d]] for d in range(3)]
                view = numpy.full(n_view, 200, large.dtype) if rng.random() < 0.2 else view
                view = view.transpose(numpy.argsort(order))[tuple(slice(None, None, s) for s in steps)][: n[0], : n[1], : n[2]]
                self.assertIs(grid.read(box, out=view, outside=9), view)
                numpy.testing.assert_array_equal(view, expected)

    def test_halo_order_map_and_types(self):
        grid = teracell.open(grids[0])
        box = (3, 4, 5, 9, 9, 9)
        wide = grid.read((2, 2, 2, 10, 11, 12))
        numpy.testing.assert_array_equal(grid.read(box, halo=(1, 2, 3)), wide)
        self.assertTrue(grid.read(box, order="F").flags.f_contiguous)
        ids = grid.read(box)
        names = {m.name: 10 * m.id + 1000 for m in grid.materials}
        mapped = grid.read(box, map=names)
        self.assertEqual(mapped.dtype, numpy.uint16)
        numpy.testing.assert_array_equal(mapped, ids.astype(int) * 10 + 1000)
        numpy.testing.assert_array_equal(grid.read(box, map=list(names.values())), mapped)
        out = numpy.full(ids.shape, 99, numpy.uint8)
        for wrong, words in (({"map": names, "out": out}, "1000"), ({"out": out, "outside": 256}, "outside"), ({"out": out.astype(float)}, "float64"),
                             ({"out": out[1:]}, "shape"), ({"map": {"air": 1}}, "no value|none for"), ({"map": {**names, "gold": 1}}, "gold"),
                             ({"out": out, "map": [-1] * 9}, "map"), ({"out": out.astype(">u2")}, "order")):
            with self.assertRaisesRegex(teracell.UsageError, words):
                grid.read(box, **wrong)
        self.assertTrue((out == 99).all(), "nothing was written")
        out.flags.writeable = False
        with self.assertRaisesRegex(teracell.UsageError, "read-only"):
            grid.read(box, out=out)


class Indexing(unittest.TestCase):
    def test_keys_select_what_numpy_selects(self):
        rng = random.Random(3)

        def part(n):
            kind = rng.random()
            if kind < 0.3:
                return rng.randint(-n, n - 1)
            bound = lambda: rng.choice([None, rng.randint(-n - 3, n + 3)])
            return slice(bound(), bound(), rng.choice([None, 1, 2, 3, 17, -1, -2, -5]))

        for path in grids:
            grid = teracell.open(path)
            for level in (0, 2, grid.levels - 1):
                array, cells = grid.level(level), exported(path, level)
                for _ in range(150):
                    key = [part(n) for n in cells.shape[: rng.randint(0, 3)]]
                    if rng.random() < 0.3:
                        key.insert(rng.randint(0, len(key)), None)
                    if rng.random() < 0.3:
                        at = rng.randint(0, len(key))
                        if not any(not isinstance(k, slice) and k is not None for k in key[at:]):
                            key = key[:at] + [Ellipsis]
                    key = tuple(key)
                    expected, found = cells[key], array[key]
                    self.assertEqual((numpy.shape(found), found.dtype), (numpy.shape(expected), expected.dtype), key)
                    numpy.testing.assert_array_equal(found, expected, str(key))
                self.assertEqual(array[0, 0, 0], cells[0, 0, 0])
                numpy.testing.assert_array_equal(numpy.asarray(array), cells)

    def test_wrong_keys_are_index_errors(self):
        grid = teracell.open(grids[0])
        for key in ((0, 0, 0, 0), (10**6,), (-10**6,), ("x",), (1.5,), (Ellipsis, Ellipsis), (True,), (numpy.zeros(3, bool),)):
            with self.assertRaises(IndexError, msg=str(key)):
                grid[key]


class Shares(unittest.TestCase):
    """What `mesh --fractions` keeps of mixed cells, against a grid meshed that much finer."""

    @classmethod
    def setUpClass(cls):
        cls.samples = (2, 4, 8)  # along x, y, z
        cls.scene = stadium_scene()
        cls.scene["grid"].pop("step", None)
        cls.scene["grid"]["cells"] = [50, 40, 12]
        cls.path = folder / "shares.tcell"
        cls.grid = teracell.mesh(cls.scene, cls.path, axis="y", fractions=cls.samples)
        cls.scene["grid"]["cells"] = [n * s for n, s in zip((50, 40, 12), cls.samples)]
        cells = teracell.mesh(cls.scene, folder / "finer.tcell")[...]
        sx, sy, sz = cls.samples
        parts = cells.reshape(12, sz, 40, sy, 50, sx)
        cls.expected = [(parts == m.id).mean(axis=(1, 3, 5)) for m in cls.grid.materials]

    def test_shares_are_the_counts_of_the_finer_grid(self):
        for m in self.grid.materials:
            numpy.testing.assert_array_equal(self.grid.fractions(m.name), self.expected[m.id])
            self.assertTrue(((self.expected[m.id] > 0) & (self.expected[m.id] < 1)).any())

    def test_boxes_through_every_language(self):
        rng = random.Random(5)
        lines, expected = [], []
        for _ in range(20):
            material, box = rng.randrange(len(self.grid.materials)), random_box(rng, self.grid.shape)
            expected.append(cut(self.expected[material], box, 7, numpy.float64))
            numpy.testing.assert_array_equal(self.grid.fractions(material, box, outside=7, threads=rng.choice([0, 1, 3])), expected[-1])
            z0, y0, x0, z1, y1, x1 = box
            lines.append(f"{material} {x0} {y0} {z0} {x1} {y1} {z1}")
        whole = b"".join(e.tobytes() for e in expected)
        for name in ("shares.cpp", "shares.f90"):
            self.assertTrue(run(compiled(SOURCES / name), self.path, input=("\n".join(lines) + "\n").encode()) == whole, name)

    def test_wrong_questions(self):
        for ask, words in ((lambda: self.grid.fractions("nosuch"), "expected a name of"), (lambda: self.grid.fractions(99), "material"),
                           (lambda: teracell.open(grids[0]).fractions(0), "has no fractions"),
                           (lambda: teracell.mesh(self.scene, folder / "no.tcell", fractions=(3, 1, 1)), "power of two")):
            with self.assertRaisesRegex(teracell.UsageError, words):
                ask()


class Links(unittest.TestCase):
    """Where labels change between sample points, against grids that are 65536 times finer along one axis."""

    @classmethod
    def setUpClass(cls):
        cls.scene = stadium_scene()
        cls.scene["grid"] = {"min": [-150, -120, -3], "max": [150, 120, 57], "cells": [75, 60, 15]}  # cells of 4 m: no number is rounded
        cls.path = folder / "links.tcell"
        cls.grid = teracell.mesh(cls.scene, cls.path, links=True)

    def test_labels_change_where_they_do_in_a_grid_65536_times_finer(self):
        cells = self.grid[...]
        for axis, name in enumerate("xyz"):
            along = 2 - axis
            fine = json.loads(json.dumps(self.scene))
            n, first = cells.shape[along], self.scene["grid"]["min"][axis] + 2
            half = 2 / 65536
            fine["grid"][name] = {"min": first - half, "max": first + (n - 1) * 4 + half, "cells": (n - 1) * 65536 + 1}
            for key in ("min", "max", "cells"):
                for d, other in enumerate("xyz"):
                    if other != name:
                        fine["grid"].setdefault(other, {})[key] = self.scene["grid"][key][d]
                del fine["grid"][key]
            finer = teracell.mesh(fine, folder / "finer.tcell", axis=name)
            expected = []
            for a in range(cells.shape[0 if along else 1]):
                for b in range(cells.shape[2 if along < 2 else 1]):
                    changes = {}
                    runs = finer.column(along, (a, b))
                    for start, _, _ in runs[1:]:
                        changes.setdefault((start - 1) // 65536, []).append((start - 1) % 65536 + 1)
                    for i, ks in changes.items():
                        cell = [a, b]
                        cell.insert(along, i)
                        upper = list(cell)
                        upper[along] += 1
                        if cells[tuple(cell)] != cells[tuple(upper)]:
                            expected.append((*cell, ks[0], ks[-1]))
            found = self.grid.links(axis=name)
            self.assertGreater(len(expected), 1000)
            self.assertEqual(sorted(expected), [(*map(int, c), int(e), int(b)) for c, e, b in zip(*found[:3])])

    def test_patches_have_names_bodies_and_areas(self):
        told = json.loads(run(PROGRAM, "info", self.path, "--json"))["patches"]
        self.assertEqual([(p.name, p.body, p.area) for p in self.grid.patches], [(p["name"], p["body"], p["area"]) for p in told])
        self.assertEqual([p.name for p in self.grid.patches[:6]], ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"])
        self.assertEqual(self.grid.patches[0].area, 240 * 60)
        self.assertEqual({p.body for p in self.grid.patches[6:]}, {b["name"] for b in self.scene["bodies"]})
        used = {int(n) for name in "xyz" for n in self.grid.links(axis=name)[3]}
        self.assertTrue(used <= set(range(6, len(told))))
        self.assertGreater(len(used), 5)
        names = [p["name"] for p in told]
        for name in ("patches.cpp", "patches.f90"):
            printed = run(compiled(SOURCES / name), self.path).decode().splitlines()
            self.assertEqual([line.strip() for line in printed], names, name)

    def test_boxes_through_every_language(self):
        rng = random.Random(5)
        lines, expected = [], []
        whole = [self.grid.links(axis=name) for name in "xyz"]
        for _ in range(20):
            axis, box = rng.randrange(3), random_box(rng, self.grid.shape)
            cells = whole[axis][0]
            inside = ((cells >= box[:3]) & (cells < box[3:])).all(axis=1)
            found = self.grid.links(box, "xyz"[axis])
            for a, b in zip(found, whole[axis]):
                numpy.testing.assert_array_equal(a, b[inside])
            for (z, y, x), end, begin, patch in zip(*found):
                expected.append(f"{x} {y} {z} {end} {begin} {patch}")
            z0, y0, x0, z1, y1, x1 = box
            lines.append(f"{axis} {x0} {y0} {z0} {x1} {y1} {z1}")
        for name in ("links.cpp", "links.f90"):
            printed = run(compiled(SOURCES / name), self.path, input=("\n".join(lines) + "\n").encode()).decode().splitlines()
            self.assertEqual(sorted(" ".join(line.split()) for line in printed), sorted(expected), name)

    def test_wrong_questions(self):
        for ask, words in ((lambda: self.grid.links(axis="w"), "expected 'x', 'y' or 'z'"), (lambda: teracell.open(grids[0]).links(), "has no links")):
            with self.assertRaisesRegex(teracell.UsageError, words):
                ask()


class Leaves(unittest.TestCase):
    """Refined grids; that leaves are those of the definition is tested in C++."""
    def test_leaves_through_every_language_are_those_of_the_export(self):
        rng = random.Random(6)
        for path, want in ((grids[0], None), (grids[-1], {"interface": 1, "box:0,0,0,3,4,5": 0})):
            grid = teracell.open(path)
            text = "interface=0" if want is None else "interface=1,box:0,0,0,3,4,5=0"
            lines, expected = [], []
            for coarsest, layers in ((4, 1), (2, 3)):
                z0, y0, x0, z1, y1, x1 = box = random_box(rng, grid.shape)
                region = [max(0, x0), max(0, y0), max(0, z0), *(min(a, n) for a, n in zip((x1, y1, z1), grid.shape[::-1]))]
                if any(lo >= hi for lo, hi in zip(region[:3], region[3:])):
                    self.assertEqual(len(grid.leaves(box, coarsest, layers, want=want)), 0)
                    continue
                run(PROGRAM, "export", path, "--format", "leaves", "--refine", f"{coarsest},{layers}", "--want", text, "--region", ",".join(map(str, region)),
                    "-o", folder / "leaves.npy", "--progress", "none")
                found = grid.leaves(box, coarsest, layers, want=want, threads=1 + coarsest % 3)
                numpy.testing.assert_array_equal(found, numpy.load(folder / "leaves.npy"))
                counted = json.loads(run(PROGRAM, "export", path, "--refine", f"{coarsest},{layers}", "--want", text, "--region", ",".join(map(str, region)), "--count", "--json"))
                names = [material.name for material in grid.materials]
                self.assertEqual({(c["level"], names.index(c["material"])): c["leaves"] for c in counted["leaves"]},
                                 collections.Counter((leaf["level"], leaf["label"]) for leaf in found))
                self.assertEqual(counted["total"], len(found))
                lines.append(f"{coarsest} {layers} {text} {x0} {y0} {z0} {x1} {y1} {z1}")
                expected += [" ".join(map(str, leaf.tolist())) for leaf in found]
            printed = run(compiled(SOURCES / "leaves.cpp"), path, input=("\n".join(lines) + "\n").encode()).decode().splitlines()
            self.assertEqual(printed, expected)

    def test_wrong_questions(self):
        grid = teracell.open(grids[0])
        for ask, words in ((lambda: grid.leaves(coarsest=17), "coarsest: expected 0 to 16"), (lambda: grid.leaves(layers=0), "layers: expected 1 to 100"),
                           (lambda: grid.leaves(want="air=0"), "want: expected interface=L"), (lambda: grid.leaves(want={"material:gold, pure": 1}), "no material 'gold, pure'"),
                           (lambda: grid.leaves(want=5), "a text or a dict, found 5"), (lambda: grid.leaves(want="patch:xmin=0"), "has no links")):
            with self.assertRaisesRegex(teracell.UsageError, words):
                ask()


class Questions(unittest.TestCase):
    def test_counts_columns_runs_and_uniform_boxes_agree_with_the_cells(self):
        rng = random.Random(4)
        for path in grids:
            grid, cells = teracell.open(path), exported(path, 0)
            for _ in range(15):
                box = random_box(rng, cells.shape)
                inside = cells[tuple(slice(max(0, a), max(0, b)) for a, b in zip(box[:3], box[3:]))]
                stats = grid.stats(box)
                self.assertEqual([s.cells for s in stats], numpy.bincount(inside.ravel(), minlength=len(grid.materials)).tolist())
                if inside.size:
                    self.assertEqual(grid.uniform(box), inside.flat[0] if (inside == inside.flat[0]).all() else None)
                filled = numpy.full(cells.shape, 255)
                for z, y, x, length, material in grid.runs(box):
                    end = [z + 1, y + 1, x + 1]
                    end[grid.ray_axis] += length - 1
                    filled[z : end[0], y : end[1], x : end[2]] = material
                expected = numpy.full(cells.shape, 255)
                where = tuple(slice(max(0, a), max(0, b)) for a, b in zip(box[:3], box[3:]))
                expected[where] = cells[where]
                numpy.testing.assert_array_equal(filled, expected)
            for axis, name in enumerate("zyx"):
                at = [rng.randrange(n) for d, n in enumerate(cells.shape) if d != axis]
                line = cells[tuple(at[:axis]) + (slice(None),) + tuple(at[axis:])]
                found = numpy.concatenate([numpy.full(b - a, m) for a, b, m in grid.column(name, at)])
                numpy.testing.assert_array_equal(found, line)

    def test_what_is_known_of_a_grid_is_what_info_prints(self):
        grid = teracell.open(grids[2])
        info = json.loads(run(PROGRAM, "info", grids[2], "--json"))
        self.assertEqual(grid.info, info)
        self.assertEqual([m.name for m in grid.materials], [m["name"] for m in info["materials"]])
        self.assertEqual(grid.shape[::-1], tuple(info["grid"]["cells"]))
        self.assertEqual(grid.units, info["units"])
        for axis, lo, hi in zip(grid.axes[::-1], info["grid"]["min"], info["grid"]["max"]):
            self.assertEqual((axis.planes[0], axis.planes[-1]), (lo, hi))
            self.assertTrue(((axis.planes[:-1] < axis.samples) & (axis.samples < axis.planes[1:])).all())

    def test_dask_and_xarray_read_block_by_block(self):
        grid, cells = teracell.open(grids[1]), exported(grids[1], 0)
        lazy = grid.dask(chunks=40)
        self.assertEqual(lazy.chunks[2][0], 40)
        self.assertEqual(int((lazy == 1).sum().compute()), int((cells == 1).sum()))
        array = grid.level(1).xarray()
        self.assertEqual(array.dims, ("z", "y", "x"))
        numpy.testing.assert_array_equal(array.values, exported(grids[1], 1))
        numpy.testing.assert_array_equal(array.coords["x"].values, grid.level(1).axes[2].samples)
        numpy.testing.assert_array_equal(pickle.loads(pickle.dumps(grid.level(2)))[...], exported(grids[1], 2))


class Meshing(unittest.TestCase):
    def test_a_scene_as_a_file_or_as_a_dict_gives_the_cells_of_the_command_line(self):
        phases = []
        scene = json.loads((folder / "stadium/scene.json").read_text())
        from_dict = teracell.mesh(scene, folder / "d.tcell", folder=folder / "stadium", cells=150, axis="x", progress=lambda phase, share: phases.append((phase, share)))
        self.assertEqual((folder / "d.tcell").read_bytes(), grids[0].read_bytes())
        teracell.mesh(folder / "stadium/scene.json", folder / "f.tcell", cells=150, axis="x")
        self.assertEqual((folder / "f.tcell").read_bytes(), grids[0].read_bytes())
        self.assertTrue(phases and all(0 <= share <= 1 for _, share in phases))
        self.assertGreater(from_dict.report["crossings"], 0)

    def test_errors_have_the_words_of_the_command_line(self):
        for scene, kind in (({"bodys": []}, teracell.UsageError), (folder / "none.json", teracell.IoError), (folder / "none.stl", teracell.IoError)):
            with self.assertRaises(kind) as caught:
                teracell.mesh(scene, folder / "never.tcell", cells=9)
            self.assertTrue(str(caught.exception))
        said = subprocess.run([PROGRAM, "mesh", folder / "none.stl", "--cells", "9", "-o", folder / "never.tcell"], capture_output=True, text=True).stderr
        self.assertIn(str(caught.exception), said)
        self.assertFalse((folder / "never.tcell").exists())
        (folder / "bad.tcell").write_bytes(b"x" * 1000)
        with self.assertRaises(teracell.FormatError):
            teracell.open(folder / "bad.tcell")

    def test_what_progress_raises_and_ctrl_c_end_a_run_and_leave_nothing(self):
        def stop(phase, share):
            raise KeyError("enough")

        with self.assertRaises(KeyError):
            teracell.mesh(folder / "stadium/scene.json", folder / "stopped.tcell", cells=2000, progress=stop)
        signal.signal(signal.SIGALRM, lambda *_: (_ for _ in ()).throw(KeyboardInterrupt()))
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with self.assertRaises(KeyboardInterrupt):
            teracell.mesh(folder / "stadium/scene.json", folder / "stopped.tcell", cells=20000)
        self.assertFalse((folder / "stopped.tcell").exists())
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with self.assertRaises(KeyboardInterrupt):
            while True:
                teracell.open(grids[0])[...]


class Memory(unittest.TestCase):
    # The grid is so large that its chunks would take 140 MB if all of them were kept.
    def test_a_grid_is_swept_box_by_box_in_64_mb_beside_the_array(self):
        grid = folder / "large.tcell"
        run(PROGRAM, "mesh", folder / "stadium/scene.json", "--cells", "4500", "-o", grid)
        said = [run(*program, grid, "256", "2", text=True) for program in ([compiled(SOURCES / "sweep.c", "-O2")], ["/usr/bin/python3", SOURCES / "sweep.py"])]
        (boxes, solid, memory), (_, solid_in_python, memory_in_python) = [[float(n) for n in re.findall(r"[\d.]+", line)] for line in said]
        self.assertGreater(boxes, 100)
        self.assertEqual(solid, solid_in_python)
        self.assertEqual(solid, sum(m.cells for m in teracell.open(grid).stats()[1:]))
        self.assertLessEqual(memory, 64)
        self.assertLessEqual(memory_in_python, 64)


class Fortran(unittest.TestCase):
    def test_a_program_that_stops_says_why_first(self):
        said = subprocess.run([compiled(EXAMPLES / "heat.f90"), "none.tcell"], env=ENVIRONMENT, cwd=folder, stderr=subprocess.PIPE, text=True)
        self.assertTrue(said.stderr.startswith("teracell: none.tcell: can't open"), said.stderr)

    def test_grids_are_assigned_and_errors_are_handed_over(self):
        program = compiled(SOURCES / "grids.f90", "-g", "-fsanitize=address", "-fcheck=all")
        said = subprocess.run([program, grids[0]], env={**ENVIRONMENT, "ASAN_OPTIONS": "detect_leaks=0"}, cwd=folder, capture_output=True, text=True)
        self.assertEqual((said.returncode, said.stdout), (0, "done\n"), said.stderr)

    # By the compiler of the project, so the module of another one must not be in the way.
    def test_a_cmake_project_compiles_the_module(self):
        build = cmake_project("fortran", "Fortran", f"add_executable(heat {EXAMPLES}/heat.f90)", "target_link_libraries(heat teracell::fortran)")
        self.assertTrue((build / "teracell-fortran/teracell.mod").exists())
        self.assertIn("solid cells", run(build / "heat", grids[0], text=True))

    def test_pkg_config_says_where_the_source_of_the_module_is(self):
        source = run("pkg-config", "--variable=fortran_source", "teracell", text=True).strip()
        run("gfortran", "-c", source, cwd=folder)
        run("gfortran", EXAMPLES / "heat.f90", "teracell.o", *run("pkg-config", "--cflags", "--libs", "teracell", text=True).split(), "-o", "heat", cwd=folder)
        self.assertIn("solid cells", run(folder / "heat", grids[0], text=True))


class Installed(unittest.TestCase):
    def test_the_library_shows_its_own_functions_alone(self):
        names = [line.split()[-1] for line in run("nm", "-D", "--defined-only", PREFIX + "/lib/libteracell.so", text=True).splitlines()]
        self.assertIn("tc_open", names)
        self.assertEqual([n for n in names if not n.startswith("tc_")], [])

    def test_there_is_a_manual_page_for_each_command_that_man_reads_without_complaint(self):
        listed = subprocess.run([PROGRAM, "--help"], capture_output=True, text=True).stdout.split("Commands:")[1]
        commands = [line.split()[0] for line in listed.splitlines() if line.startswith("  ") and not line.startswith("   ") and line.strip()]
        pages = {p.name for p in pathlib.Path(PREFIX, "share/man/man1").iterdir()}
        self.assertGreater(len(commands), 8)
        self.assertEqual(pages, {"teracell.1"} | {f"teracell-{c}.1" for c in commands if c != "teracell"})
        for page in pages:
            said = subprocess.run(["groff", "-man", "-ww", "-Tutf8", f"{PREFIX}/share/man/man1/{page}"], capture_output=True, text=True)
            self.assertEqual((said.returncode, said.stderr), (0, ""), page)
        self.assertIn("cells of all materials", subprocess.run(["groff", "-man", "-Tascii", f"{PREFIX}/share/man/man1/teracell-export.1"], capture_output=True, text=True).stdout)

    def test_bash_completes_commands_options_and_files(self):
        script = PREFIX + "/share/bash-completion/completions/teracell"

        def completed(*words):
            quoted = " ".join(f"'{w}'" for w in words)
            return run("bash", "-c", f"source {script}; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _teracell; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
                       text=True, cwd=folder).split()

        self.assertEqual(completed("teracell", "par"), ["partition"])
        self.assertEqual(completed("teracell", "mesh", "--write-c"), ["--write-caps"])
        self.assertEqual(completed("teracell", "slice", "x.tc"), ["x.tcell"])

    def test_examples_compile_by_pkg_config_and_run(self):
        out = run(compiled(EXAMPLES / "materials.c"), grids[0], text=True)
        self.assertIn("150 x", out)
        air = teracell.open(grids[0]).stats()[0].cells
        self.assertIn(f"{air} cells", out)
        layers = run(compiled(EXAMPLES / "porosity.cpp"), grids[0], "air", text=True).splitlines()
        cells = exported(grids[0], 0)
        numpy.testing.assert_allclose([float(line.split()[1]) for line in layers], (cells == 0).mean(axis=(1, 2)), rtol=1e-5)
        self.assertRegex(run(compiled(EXAMPLES / "heat.f90"), grids[0], text=True), r"solid cells: [1-9]\d* of 110592")
        self.assertIn("air", run("/usr/bin/python3", EXAMPLES / "surface_cells.py", grids[0], text=True))

    def test_the_error_of_poissons_equation_falls_as_leaves_get_finer(self):
        scene = stadium_scene()
        scene["grid"] = {"min": [-150, -120, -3], "max": [150, 120, 57], "cells": [72, 64, 32]}
        teracell.mesh(scene, folder / "poisson.tcell")
        errors = [float(line.split()[-1]) for line in run("/usr/bin/python3", EXAMPLES / "poisson.py", folder / "poisson.tcell", text=True).splitlines()]
        for coarser, finer in itertools.pairwise(errors):
            self.assertLess(finer, coarser)
        self.assertLess(errors[-1], errors[-2] / 2)

    def test_an_example_without_a_grid_says_how_it_is_called(self):
        for call in ([compiled(EXAMPLES / "materials.c")], [compiled(EXAMPLES / "porosity.cpp")], [compiled(EXAMPLES / "heat.f90")],
                     ["/usr/bin/python3", EXAMPLES / "surface_cells.py"], ["/usr/bin/python3", EXAMPLES / "poisson.py"]):
            said = subprocess.run(call, env=ENVIRONMENT, capture_output=True, text=True)
            self.assertIn("usage: ", said.stderr)
            self.assertIn(said.returncode, (1, 2))

    def test_an_older_standard_of_cpp_is_told_which_one_is_needed(self):
        flags = run("pkg-config", "--cflags", "teracell", text=True).split()
        said = subprocess.run(["c++", "-std=c++17", "-fsyntax-only", *flags, str(EXAMPLES / "porosity.cpp")], env=ENVIRONMENT, capture_output=True, text=True)
        self.assertIn("teracell.hpp needs C++20", said.stderr)

    def test_a_cmake_project_finds_the_package(self):
        build = cmake_project("project", "C CXX", "set(CMAKE_CXX_STANDARD 20)", f"add_executable(c {EXAMPLES}/materials.c)",
                              f"add_executable(cpp {EXAMPLES}/porosity.cpp)", "target_link_libraries(c teracell::teracell)",
                              "target_link_libraries(cpp teracell::teracell)")
        self.assertIn("150 x", run(build / "c", grids[0], text=True))
        self.assertTrue(run(build / "cpp", grids[0], "air"))


if __name__ == "__main__":
    unittest.main()
