#!/usr/bin/python3
"""The page without a server, in Chromium without a graphics card: from nginx on this machine, from nginx over a line of 20 Mbit/s with a round
trip of 80 ms, and as one HTML file; beside the page of `teracell serve` in the same minutes.

Usage: tools/bench/page.py PATH_TO_TERACELL G.tcell. The program must have been built with -DTERACELL_WASM=ON. For the hosts the grid is packed; one
that is too large for one HTML file is measured as a folder alone. page.mjs measures.
"""
import os
import subprocess
import sys
import tempfile

from common import ROOT, Nginx, Server
from far import LOG, Delay

ROUND_TRIP, RATE = 0.08, 20e6
MOST_HELD = 256 << 20


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, grid = map(os.path.abspath, sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        def teracell(*arguments):
            subprocess.run([program, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        teracell("pack", grid, "-o", "g.tcell")
        teracell("page", "-o", ".", "--grids", "g.tcell")
        size = os.path.getsize(grid)
        whole = "file://" + os.path.join(folder, "g.html") if size <= MOST_HELD else ""
        if whole:
            teracell("page", grid, "-o", "g.html")
        types = "types { text/html html; text/javascript js; text/css css; } "
        with Nginx(folder, types + LOG % folder) as nginx, Server(f"{folder}/g.tcell", program=program) as server:
            packed = os.path.getsize(os.path.join(folder, "g.tcell"))
            print(f"the grid: {size / 1e6:.1f} MB, packed {packed / 1e6:.1f} MB" + (f", in an HTML file {os.path.getsize(whole[7:]) / 1e6:.1f} MB" if whole else ""), flush=True)
            addresses = [f"http://127.0.0.1:{there.port}/" for there in (nginx, server)]
            far = [f"http://127.0.0.1:{Delay(there.port, ROUND_TRIP, RATE).port}/" for there in (nginx, server)]
            subprocess.run(["node", os.path.join(ROOT, "tools/bench/page.mjs"), *addresses, *far, whole], check=True)


if __name__ == "__main__":
    main()
