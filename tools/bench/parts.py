"""Parts of a grid: what the longest of 64 takes of the processor's time, compared with their mean, and what the costs in mesher/tiles/shards.cpp are
fitted to.

  tools/bench/run parts         the longest part / the mean part of the stadium at 20,000 cells, and of the mesh at 30,000^3
  tools/bench/run parts --fit   fits the costs to the time of each group of these grids (tools/bench/peers/parts_probe.cpp)

A part's time is that of its process, with reading the surface, as a multiple of what the middle part takes just before and just after it: on a shared
machine the same part takes up to twice as long for minutes, which says nothing about the parts. Medians count. The fit takes casting alone.
"""
import bisect
import math
import os
import random
import resource
import statistics
import subprocess
import sys
import tempfile

from common import ROOT, TERACELL, build, parser

PARTS = 64
RUNS = 3
RUNS_OF_GROUPS = 4  # of which the least time of each group counts
CHILDREN = 16  # of a node of the tree (store/runs/pyramid.hpp)


def processor_time(scene, folder, part, *options):
    """Processor time of a part, in seconds."""
    grid = os.path.join(folder, "grid.tcell")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([TERACELL, "mesh", scene, "-o", grid, "--shard", f"{part}/{PARTS}", "--threads", "1", "--progress", "none", *options],
                   check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    os.remove(f"{grid}.shard-{part}-of-{PARTS}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def part_times(scene, folder, *options):
    """What each part takes, as a multiple of what the middle one takes around it; and the middle one's processor times, in seconds."""
    middle = [processor_time(scene, folder, PARTS // 2, *options)]
    found = []
    for part in range(PARTS):
        time = processor_time(scene, folder, part, *options)
        middle.append(processor_time(scene, folder, PARTS // 2, *options))
        found.append(2 * time / (middle[-2] + middle[-1]))
    return found, middle


NAMES = ("kGroup", "kFacetInTile", "kCrossing", "kOfOther", "kHundredOfRay", "kHundredOfOthers", "kCoarser")
TODAY = (93_600, 2_600, 12, 3, 14, 32, 1)


def groups_of(program, scene, cells, axis):
    """Of each group, in the order of the tree: nanoseconds, and what its cost is a sum of, as in CostMap::nodes()."""
    runs = [subprocess.run([program, scene, str(cells), axis], check=True, capture_output=True, text=True).stdout.splitlines() for _ in range(RUNS_OF_GROUPS)]
    lines = [list(map(int, line.split())) for line in runs[0]]
    for line, *others in zip(lines, *runs[1:]):
        line[0] = min(line[0], *(int(other.split()[0]) for other in others))
    rows, below = [], 0
    for i, (ns, key, groups, facets, crossings, others) in enumerate(lines):
        below += crossings
        is_last = i + 1 == len(lines) or lines[i + 1][1] // CHILDREN != key // CHILDREN
        per_ray = crossings / (256 * 256) / 100
        rows.append((ns, (groups, facets, crossings, others, crossings * per_ray, others * per_ray, below if is_last else 0)))
        below = 0 if is_last else below
    return rows


def longest(rows, costs, parts=PARTS):
    """Of the parts that the estimated costs make, the longest one, and the mean of the longest four, / the mean."""
    ends, times = [0.0], [0.0]
    for ns, of in rows:
        ends.append(ends[-1] + sum(a * b for a, b in zip(costs, of)))
        times.append(times[-1] + ns)

    def cut(bound):
        at, found = 0, []
        while at < len(rows):
            end = max(at + 1, bisect.bisect_right(ends, ends[at] + bound) - 1)
            found.append(times[end] - times[at])
            at = end
        return found

    low, high = ends[-1] / parts, ends[-1]
    while high - low > low / 512:
        middle = (low + high) / 2
        if len(cut(middle)) <= parts:
            high = middle
        else:
            low = middle
    found = sorted(cut(high), reverse=True)
    mean = times[-1] / parts
    return found[0] / mean, sum(found[:4]) / 4 / mean


def fitted(grids, rounds=600):
    """The costs whose longest parts are shortest, by random steps from those of today: what counts is the worst part, which no sum of errors knows."""
    chance = random.Random(1)

    def badness(costs):
        return sum((sum(longest(rows, costs)) / 2 - 1) ** 2 for rows in grids)

    best, least = TODAY, badness(TODAY)
    for i in range(rounds):
        step = 0.5 * 0.1 ** (i / rounds)
        costs = [c * math.exp(step * chance.gauss(0, 1)) if chance.random() < 0.5 else c for c in best]
        if (bad := badness(costs)) < least:
            best, least = costs, bad
    return best


def scenes(mesh, folder):
    stadium = os.path.join(folder, "stadium")
    subprocess.run([TERACELL, "sample", "stadium", "-o", stadium], check=True, stdout=subprocess.DEVNULL)
    cubic = os.path.join(folder, "cubic.json")
    subprocess.run([sys.executable, os.path.join(ROOT, "tools/bench/peers/cubic_scene.py"), mesh, "30000", cubic], check=True)
    return os.path.join(stadium, "scene.json"), cubic


def main(arguments):
    options_of = parser("tools/bench/run parts", __doc__, runs=RUNS)
    options_of.add_argument("--fit", action="store_true", help="fit the costs instead")
    options = options_of.parse_args(arguments)
    build("", "teracell", "parts_probe")
    with tempfile.TemporaryDirectory() as folder:
        stadium, cubic = scenes(options.mesh, folder)
        if not options.fit:
            for name, scene, words in (("stadium, 20,000 cells", stadium, ("--cells", "20000")), ("the mesh, 30,000^3", cubic, ())):
                runs, middles = zip(*(part_times(scene, folder, *words) for _ in range(options.runs)))
                times = [statistics.median(of_part) for of_part in zip(*runs)]
                mean = statistics.mean(times)
                seconds = mean * statistics.median(sum(middles, []))
                print(f"{PARTS} parts, longest / mean processor time: {name:<24} {max(times) / mean:.2f}, mean {seconds:.2f} s", flush=True)
            return
        program = os.path.join(ROOT, "build/bench/parts_probe")
        fit(program, [("stadium, 20,000 cells", stadium, 20000, axis) for axis in "xz"] + [("the mesh, 30,000^3", cubic, 0, axis) for axis in "xy"])


def fit(program, grids):
    rows = [groups_of(program, scene, cells, axis) for _, scene, cells, axis in grids]
    costs = fitted(rows)
    print("nanoseconds: " + ", ".join(f"{name} {cost:.1f}" for name, cost in zip(NAMES, costs)))
    for (name, _, _, axis), found in zip(grids, rows):
        print(f"{PARTS} parts, longest / mean, casting alone: {name} along {axis}: with the costs of today {longest(found, TODAY)[0]:.2f}, with these "
              f"{longest(found, costs)[0]:.2f}, by their true times {longest([(ns, (ns,)) for ns, _ in found], [1])[0]:.2f}", flush=True)
