"""Deep Zoom and IIIF tiles have the names that vips gives to its own tiles, and every pixel equals that of `teracell slice`.

No program in Debian reads the two protocols; vips writes them, and Pillow decodes the tiles.
"""
import io
import itertools
import json
import math
import os
import subprocess
import unittest
import xml.etree.ElementTree

import numpy
import PIL.Image

from support import FOLDER, SERVER, Case, get, teracell

# A slice of several tiles, one of less than a tile, and both other axes.
SLICES = [("parts", "z", 4), ("parts", "y", 350), ("stadium", "z", 20), ("stadium", "x", 150)]


def pixels(png):
    """Of a PNG as bytes, or of the file of a name."""
    with PIL.Image.open(png if isinstance(png, str) else io.BytesIO(png)) as picture:
        return numpy.asarray(picture.convert("RGBA"))


def level_picture(grid, axis, index, level):
    name = os.path.join(FOLDER, f"{grid}-{axis}-{index}.{level}.png")
    if not os.path.exists(name):
        teracell("slice", f"{grid}.tcell", "--axis", axis, "--index", index >> level, "--level", level, "-o", name)
    return pixels(name)


def scaled(grid, axis, index, scale):
    """The slice at 1 / 2^scale. Rows count from the top of the whole picture; a pixel is the cell of the level that contains its corner."""
    height = len(level_picture(grid, axis, index, 0))
    level = level_picture(grid, axis, index, scale)
    v = (height - 1 - (numpy.arange(math.ceil(height / 2 ** scale)) << scale)) >> scale
    return level[len(level) - 1 - v]


def written_by_vips(grid, axis, index, layout):
    """The names of the tiles that vips makes from the picture, without the name of its folder."""
    level_picture(grid, axis, index, 0)
    folder = os.path.join(FOLDER, f"vips-{layout}-{grid}-{axis}")
    subprocess.run(["vips", "dzsave", os.path.join(FOLDER, f"{grid}-{axis}-{index}.0.png"), folder, "--layout", layout, "--tile-size", "512",
                    "--overlap", "0", "--suffix", ".png", "--region-shrink", "nearest"], check=True)
    root = f"{folder}_files" if layout == "dz" else folder
    return root, sorted(os.path.relpath(os.path.join(at, name), root) for at, _, names in os.walk(root) for name in names if name.endswith(".png"))


class DeepZoom(Case):
    def test_the_document_describes_the_slice(self):
        for grid, axis, index in SLICES:
            image = xml.etree.ElementTree.fromstring(get(f"dzi/{grid}/{axis}/{index}.dzi"))
            space = "{http://schemas.microsoft.com/deepzoom/2008}"
            self.assertEqual((image.tag, image.attrib), (space + "Image", {"Format": "png", "Overlap": "0", "TileSize": "512"}))
            height, width = level_picture(grid, axis, index, 0).shape[:2]
            self.assertEqual(image.find(space + "Size").attrib, {"Width": str(width), "Height": str(height)})

    def test_tiles_of_every_level_are_the_slice(self):
        for grid, axis, index in SLICES:
            height, width = level_picture(grid, axis, index, 0).shape[:2]
            last = math.ceil(math.log2(max(width, height)))
            for level in range(last + 1):
                expected = scaled(grid, axis, index, last - level)
                for row, column in itertools.product(*(range(math.ceil(n / 512)) for n in expected.shape[:2])):
                    tile = pixels(get(f"dzi/{grid}/{axis}/{index}_files/{level}/{column}_{row}.png"))
                    self.assert_same(tile, expected[512 * row:512 * row + 512, 512 * column:512 * column + 512])

    def test_vips_makes_tiles_of_the_same_names_and_sizes(self):
        for grid, axis, index in SLICES:
            root, names = written_by_vips(grid, axis, index, "dz")
            finest = max(int(name.split("/")[0]) for name in names)
            for name in names:
                tile, theirs = pixels(get(f"dzi/{grid}/{axis}/{index}_files/{name}")), pixels(os.path.join(root, name))
                self.assertEqual(tile.shape, theirs.shape, name)
                if int(name.split("/")[0]) == finest:
                    self.assert_same(tile, theirs)

    def test_other_tiles_are_missing(self):
        for path in ("parts/z/9.dzi", "parts/w/4.dzi", "parts/z/4_files/11/3_0.png", "parts/z/4_files/11/0_2.png", "parts/z/4_files/12/0_0.png",
                     "parts/z/4_files/11/0_0.jpg"):
            self.assert_missing(f"dzi/{path}")


class Iiif(Case):
    def test_the_document_describes_the_slice(self):
        for grid, axis, index in SLICES:
            name = f"iiif/{grid}-{axis}-{index}"
            info = json.loads(get(f"{name}/info.json"))
            height, width = level_picture(grid, axis, index, 0).shape[:2]
            self.assertEqual((info["id"], info["type"], info["profile"]), (f"{SERVER}/{name}", "ImageService3", "level0"))
            self.assertEqual((info["width"], info["height"]), (width, height))

    def test_tiles_of_every_scale_are_the_slice(self):
        for grid, axis, index in SLICES:
            name = f"iiif/{grid}-{axis}-{index}"
            info = json.loads(get(f"{name}/info.json"))
            size = info["tiles"][0]["width"]
            for scale, factor in enumerate(info["tiles"][0]["scaleFactors"]):
                self.assertEqual(factor, 2 ** scale)
                expected = scaled(grid, axis, index, scale)
                for y, x in itertools.product(range(0, info["height"], size * factor), range(0, info["width"], size * factor)):
                    w, h = min(size * factor, info["width"] - x), min(size * factor, info["height"] - y)
                    tile = pixels(get(f"{name}/{x},{y},{w},{h}/{math.ceil(w / factor)},{math.ceil(h / factor)}/0/default.png"))
                    row, column = y // factor, x // factor
                    self.assert_same(tile, expected[row:row + size, column:column + size])
            self.assert_same(pixels(get(f"{name}/full/max/0/default.png")), scaled(grid, axis, index, 0))

    def test_vips_makes_tiles_of_the_same_names(self):
        for grid, axis, index in SLICES:
            root, names = written_by_vips(grid, axis, index, "iiif3")
            for name in names:
                tile, theirs = pixels(get(f"iiif/{grid}-{axis}-{index}/{name}")), pixels(os.path.join(root, name))
                self.assertEqual(tile.shape, theirs.shape, name)

    def test_other_pictures_are_missing(self):
        for path in ("parts-z-9/info.json", "parts-z-4/0,0,512,512/512,512/90/default.png", "parts-z-4/0,0,512,512/512,512/0/default.jpg",
                     "parts-z-4/7,0,512,512/512,512/0/default.png"):
            self.assert_missing(f"iiif/{path}")


if __name__ == "__main__":
    unittest.main()
