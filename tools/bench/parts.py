"""Parts of a grid: what the longest of 64 takes of the processor's time, compared with their mean, and what the costs in mesher/tiles/shards.cpp are
fitted to.

  tools/bench/run parts         the longest part / the mean part of the stadium at 20,000 cells, and of the mesh at 30,000^3
  tools/bench/run parts --fit   fits the costs to the time of each group of these grids (tools/bench/peers/parts_probe.cpp)

A part's time is that of its process, with reading the surface. The fit takes casting alone.
"""
import os
import resource
import subprocess
import sys
import tempfile

from common import ROOT, TERACELL, build, parser

PARTS = 64
STRETCHES = 512  # that a grid is fitted by, of as many nanoseconds each: more than parts, because where these end changes


def processor_times(teracell, scene, folder, *options, parts=PARTS):
    """Processor time of each part, in seconds."""
    found = []
    for i in range(parts):
        grid = os.path.join(folder, "grid.tcell")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([teracell, "mesh", scene, "-o", grid, "--shard", f"{i}/{parts}", "--threads", "1", "--progress", "none", *options],
                       check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        os.remove(f"{grid}.shard-{i}-of-{parts}")
    return found


def groups_of(program, scene, cells, axis):
    """Of each group, in the order of the tree: nanoseconds, and what its cost is a sum of."""
    said = subprocess.run([program, scene, str(cells), axis], check=True, capture_output=True, text=True).stdout
    rows = []
    for line in said.splitlines():
        ns, key, groups, facets, rows_of, crossings = map(int, line.split())
        rays = 256 * 256
        rows.append((ns, (groups, facets, rows_of, crossings, crossings * crossings / rays / 10)))
    return rows


NAMES = ("kGroup", "kFacetInTile", "kRowOfFacet", "kCrossing", "kTenOfRay")


def stretches(rows, number):
    """Sums of groups that follow each other, of about equal times."""
    bound = sum(ns for ns, _ in rows) / number
    out, ns_sum, sums = [], 0, [0.0] * len(NAMES)
    for ns, of in rows:
        ns_sum += ns
        sums = [a + b for a, b in zip(sums, of)]
        if ns_sum >= bound:
            out.append((ns_sum, sums))
            ns_sum, sums = 0, [0.0] * len(NAMES)
    return out


def solved(matrix, right):
    n = len(right)
    rows = [list(row) + [value] for row, value in zip(matrix, right)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for r in range(n):
            if r != i and rows[i][i] != 0:
                factor = rows[r][i] / rows[i][i]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[i])]
    return [rows[i][n] / rows[i][i] if rows[i][i] else 0 for i in range(n)]


def fitted(grids):
    """The costs that are least wrong, as shares of each stretch's time. None is below 0."""
    samples = [sample for rows in grids for sample in stretches(rows, STRETCHES)]
    used = list(range(len(NAMES)))
    while True:
        matrix = [[sum(of[a] * of[b] / ns / ns for ns, of in samples) for b in used] for a in used]
        costs = solved(matrix, [sum(of[a] / ns for ns, of in samples) for a in used])
        if min(costs) >= 0:
            return [costs[used.index(i)] if i in used else 0 for i in range(len(NAMES))]
        used.pop(costs.index(min(costs)))


def longest(rows, costs, parts=PARTS):
    """The longest part / the mean, if it is cut where the estimated costs say so."""
    estimated = [sum(a * b for a, b in zip(costs, of)) for _, of in rows]
    low, high = max(max(estimated), sum(estimated) / parts), sum(estimated)

    def cut(bound):
        times, spent = [0.0], 0.0
        for (ns, _), cost in zip(rows, estimated):
            if spent + cost > bound:
                times.append(0.0)
                spent = 0.0
            spent += cost
            times[-1] += ns
        return times

    while high - low > low / 1024:
        middle = (low + high) / 2
        if len(cut(middle)) <= parts:
            high = middle
        else:
            low = middle
    return max(cut(high)) / (sum(ns for ns, _ in rows) / parts)


def scenes(mesh, folder):
    stadium = os.path.join(folder, "stadium")
    subprocess.run([TERACELL, "sample", "stadium", "-o", stadium], check=True, stdout=subprocess.DEVNULL)
    cubic = os.path.join(folder, "cubic.json")
    subprocess.run([sys.executable, os.path.join(ROOT, "tools/bench/peers/cubic_scene.py"), mesh, "30000", cubic], check=True)
    return os.path.join(stadium, "scene.json"), cubic


def main(arguments):
    options_of = parser("tools/bench/run parts", __doc__, runs=1)
    options_of.add_argument("--fit", action="store_true", help="fit the costs instead")
    options_of.add_argument("--given", metavar="A,B,C,D,E", help="with --fit: also how long parts get with these costs: " + ", ".join(NAMES))
    options = options_of.parse_args(arguments)
    build("", "teracell", "parts_probe")
    with tempfile.TemporaryDirectory() as folder:
        stadium, cubic = scenes(options.mesh, folder)
        if not options.fit:
            for _ in range(options.runs):
                for name, scene, words in (("stadium, 20,000 cells", stadium, ("--cells", "20000")), ("the mesh, 30,000^3", cubic, ())):
                    times = processor_times(TERACELL, scene, folder, *words)
                    print(f"{PARTS} parts, longest / mean processor time: {name:<24} {max(times) / (sum(times) / PARTS):.2f}, mean {sum(times) / PARTS:.2f} s",
                          flush=True)
            return
        program = os.path.join(ROOT, "build/bench/parts_probe")
        fit(program, [("stadium, 20,000 cells", stadium, 20000, axis) for axis in "xz"] + [("the mesh, 30,000^3", cubic, 0, axis) for axis in "xyz"],
            [float(word) for word in options.given.split(",")] if options.given else None)


def fit(program, grids, given=None):
    rows = [groups_of(program, scene, cells, axis) for _, scene, cells, axis in grids]
    costs = fitted(rows)
    print("nanoseconds: " + ", ".join(f"{name} {cost:.1f}" for name, cost in zip(NAMES, costs)))
    for (name, _, _, axis), found in zip(grids, rows):
        print(f"{PARTS} parts, longest / mean, casting alone: {name} along {axis}: {longest(found, costs):.2f}, with costs of its own "
              f"{longest(found, fitted([found])):.2f}, by their true times {longest(found_alone(found), [1, 0, 0, 0, 0]):.2f}"
              + (f", with those given {longest(found, given):.2f}" if given else ""), flush=True)


def found_alone(rows):
    """As if the estimate were the time itself: what is left is how coarse groups are."""
    return [(ns, (ns, 0, 0, 0, 0)) for ns, _ in rows]
