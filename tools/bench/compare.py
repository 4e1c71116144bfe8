"""Holds the working tree against a commit. Both are built alike and run in turn, in pairs; a ratio is the median of the pairs, ours over theirs, so below 1
we are better. Lines beneath a row say where our processor time goes."""
import os
import statistics
import subprocess
import sys
import tempfile

from common import ROOT, TERACELL, build, parser
from where import where


def program_of(revision):
    """The commit's number and the program that it builds, in build/compare: built once."""
    asked = subprocess.run(["git", "rev-parse", "--verify", "--short", f"{revision}^{{commit}}"], cwd=ROOT, capture_output=True, text=True)
    if asked.returncode != 0:
        sys.exit(f"tools/bench/run: expected a commit, found '{revision}'")
    commit = asked.stdout.strip()
    program = os.path.join(ROOT, "build/compare", f"teracell-{commit}")
    if not os.path.exists(program):
        tree = os.path.join(ROOT, "build/compare", commit)
        print(f"building {commit} ...", file=sys.stderr)
        try:
            for command in (["git", "worktree", "add", "--force", "--detach", tree, commit],
                            ["cmake", "--preset", "bench", "-S", tree, "-B", f"{tree}/build/bench"],
                            ["cmake", "--build", f"{tree}/build/bench", "--target", "teracell"],
                            ["cp", f"{tree}/build/bench/teracell", program]):
                done = subprocess.run(command, cwd=tree if command[0] == "cmake" else ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                if done.returncode != 0:
                    sys.exit(f"{done.stdout}tools/bench/run: {' '.join(command[:3])} failed with status {done.returncode}: see above")
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", tree], cwd=ROOT, capture_output=True)
    return commit, program


def measured(command):
    """Wall seconds, processor seconds and peak memory in MB of one run. A process of its own starts it, since the kernel keeps the largest child's peak."""
    code = "import resource, subprocess, sys, time\nbegan = time.perf_counter()\nsubprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)\n" \
           "wall, used = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)\nprint(wall, used.ru_utime + used.ru_stime, used.ru_maxrss)"
    wall, cpu, peak = subprocess.run([sys.executable, "-c", code, *command], check=True, capture_output=True, text=True).stdout.split()
    return float(wall), float(cpu), int(peak) * 1024 / 1e6


def main(arguments):
    options_of = parser("tools/bench/run compare", __doc__, runs=7)
    options_of.add_argument("revision", metavar="REV", help="a commit, such as HEAD~1 or main")
    options = options_of.parse_args(arguments)
    build("libdeflate-dev", "teracell")
    commit, base = program_of(options.revision)

    with tempfile.TemporaryDirectory() as folder:
        def at(name):
            return os.path.join(folder, name)

        for n in (1000, 3000, 10000):
            subprocess.run([sys.executable, os.path.join(ROOT, "tools/bench/peers/cubic_scene.py"), options.mesh, str(n), at(f"{n}.json")], check=True)
        subprocess.run([TERACELL, "sample", "stadium", "-o", at("stadium")], check=True, stdout=subprocess.DEVNULL)
        # What is measured, and the words of each command; GRID is a file of the same program, OUT is what it writes.
        rows = [(f"mesh {n}^3", ["mesh", at(f"{n}.json"), "-o", "OUT.tcell", "--progress", "none"]) for n in (1000, 10000)]
        rows += [("mesh 10,000^3, one thread", ["mesh", at("10000.json"), "-o", "GRID.tcell", "--progress", "none", "--threads", "1"]),
                 ("mesh stadium, 12,000 cells", ["mesh", at("stadium/scene.json"), "--cells", "12000", "-o", "OUT.tcell", "--progress", "none"]),
                 ("mesh 3000^3 with fractions 4,4,64", ["mesh", at("3000.json"), "--fractions", "4,4,64", "-o", "OUT.tcell", "--progress", "none"])]
        rows += [(f"slice across {axis}, 10^8 pixels", ["slice", "GRID.tcell", "--axis", axis, "--index", "5000", "-o", "OUT.png"]) for axis in "xyz"]
        rows += [("verify 10^12 cells", ["verify", "GRID.tcell"]), ("render 1920 x 1080", ["render", "GRID.tcell", "--size", "1920,1080", "-o", "OUT.png"])]
        print(f"{'ours / ' + commit:<36} {'wall':>26} {'processor':>26} {'peak memory':>20} {'bytes':>28}")
        for what, words in rows:
            def command(program, name):
                return [program, *(word.replace("GRID", at(f"{name}-grid")).replace("OUT", at(f"{name}-out")) for word in words)]
            sides = [(command(TERACELL, "ours"), []), (command(base, "theirs"), [])]
            for _ in range(options.runs + 1):  # the first one warms up
                for words_of, found in sides:
                    found.append(measured(words_of))
            ours, theirs = (found[1:] for _, found in sides)
            cells = [f"{statistics.median(a[i] for a in ours):.{digits}f} / {statistics.median(b[i] for b in theirs):.{digits}f} {unit}"
                     f" = {statistics.median(a[i] / b[i] for a, b in zip(ours, theirs)):.2f}" for i, digits, unit in ((0, 3, "s"), (1, 3, "s"), (2, 0, "MB"))]
            out = [word for word in sides[0][0] if word.startswith(folder) and word.endswith((".tcell", ".png"))][-1]
            sizes = [os.path.getsize(path) for path in (out, out.replace("ours-", "theirs-"))]
            print(f"{what:<36} {cells[0]:>26} {cells[1]:>26} {cells[2]:>20} {f'{sizes[0]:,} / {sizes[1]:,}':>28}", flush=True)
            if said := where(*sides[0][0]):
                print(f"    {said}", flush=True)
