#!/usr/bin/python3
"""What a grid behind an address costs: requests, bytes and seconds, from nginx on this machine and through a proxy that delays.

Usage: tools/bench/far.py PATH_TO_TERACELL G.tcell [MILLISECONDS]. It packs the grid into a folder of its own, and prints a table. The proxy
lets bytes pass after half of a round trip (80 ms by default), and answers the first bytes of a connection one round trip later, as
connecting takes that long.
"""
import asyncio
import concurrent.futures
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

from common import Nginx, Server, free_port, wait_for

LOG = "log_format bytes '$status $bytes_sent'; access_log %s/access.log bytes;"  # of nginx
ACROSS = {"x": (1, 2), "y": (0, 2), "z": (0, 1)}  # the axes of a slice


class Delay:
    """Relays a port with a delay, in a thread. What comes back takes a line of `rate` bits per second, which all connections share."""

    def __init__(self, target, seconds, rate=float("inf")):
        self.target, self.seconds, self.rate, self.port = target, seconds, rate, free_port()
        self.line_free = 0  # when the last bytes have left
        threading.Thread(target=lambda: asyncio.run(self.serve()), daemon=True).start()
        wait_for(self.port)

    async def serve(self):
        server = await asyncio.start_server(self.relay, "127.0.0.1", self.port)
        await server.serve_forever()

    async def relay(self, reader, writer):
        there_reader, there_writer = await asyncio.open_connection("127.0.0.1", self.target)
        opened = time.monotonic() + self.seconds  # when the client could have begun to send
        await asyncio.gather(self.copy(reader, there_writer, opened, float("inf")), self.copy(there_reader, writer, 0, self.rate))

    async def copy(self, source, to, not_before, rate):
        queue = asyncio.Queue()

        async def send():
            while True:
                due, data = await queue.get()
                await asyncio.sleep(max(0, due - time.monotonic()))
                if not data or to.is_closing():
                    return to.close()
                to.write(data)
        task = asyncio.create_task(send())
        try:
            while True:
                data = await source.read(1 << 14)
                left = max(time.monotonic(), not_before)
                if rate < float("inf"):
                    left = self.line_free = max(left, self.line_free) + 8 * len(data) / rate
                queue.put_nowait((left + self.seconds / 2, data))
                if not data:
                    break
        except ConnectionError:
            queue.put_nowait((0, b""))
        await task


class Bench:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def log(self):
        time.sleep(0.05)
        with open(os.path.join(self.folder, "access.log")) as file:
            return [line.split() for line in file]

    def measure(self, what, f):
        before = len(self.log())
        began = time.monotonic()
        f()
        took = time.monotonic() - began
        lines = self.log()[before:]
        print(f"{what:70} {len(lines):4} requests {sum(int(n) for _, n in lines) / 1000:9.1f} kB {took:7.3f} s", flush=True)

    def slice(self, port, grid, axis, index, u, v, side=512, level=0, most=(1 << 40, 1 << 40)):
        subprocess.run([self.program, "slice", f"http://127.0.0.1:{port}/{grid}", "--axis", axis, "--index", str(index), "--level", str(level), "--region",
                        f"{u},{v},{min(u + side, most[0])},{min(v + side, most[1])}", "-o", "out.png"], cwd=self.folder, check=True)

    def draw(self, port, grid, cells, tiles=100):
        """Random tiles of the lowest six levels, the same for every grid: the most requests and bytes."""
        drawn, most = random.Random(1), [0, 0]
        for _ in range(tiles):
            axis, level = drawn.choice("xyz"), drawn.randrange(6)
            n = [-(-c // 2**level) for c in cells]
            u, v = ACROSS[axis]
            before = len(self.log())
            self.slice(port, grid, axis, drawn.randrange(n["xyz".index(axis)]), *(drawn.randrange(-(-n[d] // 512)) * 512 for d in (u, v)), level=level, most=(n[u], n[v]))
            lines = self.log()[before:]
            most = [max(most[0], len(lines)), max(most[1], sum(int(b) for _, b in lines))]
        print(f"{grid}, here: at most, of {tiles} random tiles of the levels 0 to 5".ljust(70), f"{most[0]:4} requests {most[1] / 1000:9.1f} kB", flush=True)

    def view(self, port, grid, cells):
        """What a page asks for first: the grids, one of them, and three slices through the middle, in tiles of the level that fits."""
        with Server(f"http://127.0.0.1:{port}/{grid}", program=self.program) as server:
            level = max(0, (max(cells) - 1).bit_length() - 10)  # up to 1024 pixels

            def get(path):
                return urllib.request.urlopen(server.url + path, timeout=60).read()
            get("api/v1/grids")
            get(f"api/v1/grids/{grid[:-6]}")
            tiles = []
            for axis, (u, v) in ACROSS.items():
                n = [-(-c // 2**level) for c in cells]
                tiles += [f"api/v1/grids/{grid[:-6]}/tile/{axis}/{n['xyz'.index(axis)] // 2}/{level}/{col}_{row}.bin?sets=1"
                          for row in range(-(-n[v] // 512)) for col in range(-(-n[u] // 512))]
            with concurrent.futures.ThreadPoolExecutor(len(tiles)) as pool:
                list(pool.map(get, tiles))


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    program, source = map(os.path.abspath, sys.argv[1:3])
    delay = float(sys.argv[3]) / 1000 if len(sys.argv) == 4 else 0.08
    with tempfile.TemporaryDirectory(prefix="teracell-far-") as folder:
        shutil.copy(source, os.path.join(folder, "plain.tcell"))
        subprocess.run([program, "pack", "plain.tcell", "-o", "packed.tcell", "--progress", "none"], cwd=folder, check=True)
        info = json.loads(subprocess.run([program, "info", "plain.tcell", "--json"], cwd=folder, check=True, stdout=subprocess.PIPE).stdout)
        cells = info["grid"]["cells"]
        bench, middle = Bench(program, folder), [n // 2 for n in cells]
        with Nginx(folder, LOG % folder) as nginx:
            far = Delay(nginx.port, delay).port
            for grid in ["plain.tcell", "packed.tcell"]:
                for name, port in [("here", nginx.port), (f"{1000 * delay:.0f} ms", far)]:
                    for axis, (u, v) in ACROSS.items():
                        index = middle["xyz".index(axis)]
                        for level in [0, 1]:
                            at_u, at_v = ((middle[d] >> level) // 512 * 512 for d in (u, v))
                            bench.measure(f"{grid}, {name}: slice, tile across {axis}, level {level}", lambda: bench.slice(port, grid, axis, index >> level, at_u, at_v, level=level))
                    if name == "here":
                        bench.draw(port, grid, cells)
                    bench.measure(f"{grid}, {name}: serve, the first view", lambda: bench.view(port, grid, cells))


if __name__ == "__main__":
    main()
