#!/usr/bin/python3
"""What a STEP file costs: `teracell mesh` with nothing in its cache, beside OpenCASCADE alone, which reads and tessellates the same file.

Usage: tools/bench/step.py FILE.step ... [--cells N] [--rounds N]. It builds both, runs them in turn, and prints seconds and the ratio of medians.
"""
import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from common import TERACELL, build, peer


def seconds_of(command, **options):
    began = time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **options)
    return time.monotonic() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+")
    parser.add_argument("--cells", type=int, default=500)
    parser.add_argument("--rounds", type=int, default=5)
    o = parser.parse_args()
    build("${step_packages[@]}", "teracell", "teracell_step", "step_peer", options=["-DTERACELL_STEP=ON"])
    if not peer("step_peer"):
        sys.exit("tools/bench/step.py: step_peer was not built: is OpenCASCADE installed?")
    print(f"{'file':<32} {'kernel s':>9} {'mesh s':>9} {'ratio':>6} {'cast s':>7}")
    for file in o.files:
        folder = tempfile.mkdtemp()
        grid, report, cache = (os.path.join(folder, name) for name in ("g.tcell", "r.json", "cache"))
        mesh = [TERACELL, "mesh", file, "--units", "mm", "--cells", str(o.cells), "-o", grid, "--report", report]
        kernel, whole, cast = [], [], []
        subprocess.run(mesh, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(o.rounds):
            cad = json.load(open(report))["inputs"][0]["cad"]
            kernel.append(seconds_of([peer("step_peer"), file, str(cad["deflection"]), str(cad["angle"])]))
            shutil.rmtree(cache, ignore_errors=True)
            whole.append(seconds_of(mesh, env=dict(os.environ, XDG_CACHE_HOME=cache)))
            cast.append(sum(p["seconds"] for p in json.load(open(report))["phases"] if p["name"] not in ("read", "close", "check")))
        k, w = statistics.median(kernel), statistics.median(whole)
        print(f"{os.path.basename(file):<32} {k:9.3f} {w:9.3f} {w / k:6.2f} {statistics.median(cast):7.3f}", flush=True)
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
