"""Many bodies against one: the sample stadium with a body for each of its 1660 shells, three times one above another, and the same facets as one
body. Per crossing, many bodies should cost little more than one."""
import json
import os
import resource
import statistics
import struct
import subprocess

FACET = 50  # bytes of a facet of a binary STL file: a normal, three vertices, two bytes
STOREYS, CELLS = 3, 1e11


def shells(data):
    """The facets of a binary STL file by connected shells, whose facets share vertices, in the order of their first facets."""
    facets = [data[84 + FACET * i:84 + FACET * (i + 1)] for i in range(struct.unpack_from("<I", data, 80)[0])]
    parent = list(range(len(facets)))

    def root(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    first, found = {}, {}
    for i, facet in enumerate(facets):
        for corner in (facet[12:24], facet[24:36], facet[36:48]):
            a, b = root(first.setdefault(corner, i)), root(i)
            parent[max(a, b)] = min(a, b)
    for i, facet in enumerate(facets):
        found.setdefault(root(i), []).append(facet)
    return list(found.values())


def lifted(facet, height):
    numbers = list(struct.unpack("<12f", facet[:48]))
    for z in (5, 8, 11):
        numbers[z] += height
    return struct.pack("<12f", *numbers) + facet[48:]


def scenes(stadium, folder):
    """Writes both scenes and their surfaces. Returns the path of the one with many bodies, of the one with one, and how many are many."""
    with open(os.path.join(stadium, "scene.json")) as file:
        scene = json.load(file)
    lo, hi = scene["grid"]["min"], scene["grid"]["max"]
    storey = hi[2] - lo[2]
    hi[2] += (STOREYS - 1) * storey
    side = ((hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]) / CELLS) ** (1 / 3)
    scene["grid"]["cells"] = [round((hi[d] - lo[d]) / side) for d in range(3)]
    os.makedirs(folder, exist_ok=True)
    many, everything = [], []

    def write(name, facets):
        with open(os.path.join(folder, name), "wb") as file:
            file.write(bytes(80) + struct.pack("<I", len(facets)) + b"".join(facets))

    for body in scene["bodies"]:
        with open(os.path.join(stadium, body["mesh"]), "rb") as file:
            found = shells(file.read())
        for i in range(STOREYS):
            for shell in found:
                facets = [lifted(facet, i * storey) for facet in shell]
                everything += facets
                many.append(dict(body, name=f"{body['name']} {len(many)}", mesh=f"{len(many)}.stl"))
                write(many[-1]["mesh"], facets)
    write("one.stl", everything)
    paths = [os.path.join(folder, name) for name in ("many.json", "one.json")]
    for path, bodies in zip(paths, (many, [dict(scene["bodies"][0], name="one", mesh="one.stl")])):
        with open(path, "w") as file:
            json.dump(dict(scene, bodies=bodies), file)
    return *paths, len(many)


def per_crossing(teracell, scene, *options):
    """Processor time in nanoseconds per crossing."""
    grid, report = scene + ".tcell", scene + ".report"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([teracell, "mesh", scene, "-o", grid, "--report", report, "--progress", "none", *options], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(report) as file:
        crossings = json.load(file)["crossings"]
    os.remove(grid)
    return 1e9 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / crossings


def measure(teracell, stadium, folder, runs):
    """Medians of many, of one, and of their ratio, in pairs after one warm-up; and the number of bodies."""
    many, one, bodies = scenes(stadium, folder)
    per_crossing(teracell, many)
    found = [(per_crossing(teracell, many), per_crossing(teracell, one)) for _ in range(runs)]
    return (statistics.median(a for a, _ in found), statistics.median(b for _, b in found), statistics.median(a / b for a, b in found), bodies)
