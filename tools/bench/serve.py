"""Measures the slice server on a grid of 10,000^3 = 10^12 cells, and nginx with a file for comparison."""
import concurrent.futures
import http.client
import json
import os
import random
import re
import socket
import statistics
import subprocess
import tempfile
import time

import common
from common import Nginx, build, count, mesh_in_cube, parser

AXES = "xyz"


class Server(common.Server):
    def connection(self):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)

    def get(self, path):
        connection = self.connection()
        connection.request("GET", path)
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        if answer.status != 200:
            raise SystemExit(f"{path}: {answer.status} {body[:200]}")
        return body

    def rss(self):
        """Resident memory, in MB."""
        with open(f"/proc/{self.process.pid}/statm") as f:
            return int(f.read().split()[1]) * 4096 / 1e6


def random_tile(rng, info):
    """The address of a tile of one of the levels 0 to 5."""
    axis = rng.randrange(3)
    level = rng.choice([l for l in info["levels"] if l["level"] <= 5])
    n = level["cells"]
    u, v = (0 if axis else 1), (1 if axis == 2 else 2)
    return (f"/api/v1/grids/{info['id']}/tile/{AXES[axis]}/{rng.randrange(n[axis])}/{level['level']}/"
            f"{rng.randrange((n[u] + 511) // 512)}_{rng.randrange((n[v] + 511) // 512)}.png")


def fetch_random(server, info, seed, count, connections):
    """The seconds in all, and those of each tile in ascending order."""
    took = []

    def work(part):
        rng = random.Random(seed * 1000 + part)
        connection = server.connection()
        for _ in range(count // connections):
            path = random_tile(rng, info)
            began = time.perf_counter()
            connection.request("GET", path)
            answer = connection.getresponse()
            answer.read()
            took.append(time.perf_counter() - began)
            if answer.status != 200:
                raise RuntimeError(f"{path}: {answer.status}")

    began = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(connections) as pool:
        list(pool.map(work, range(connections)))
    return time.perf_counter() - began, sorted(took)


def wrk(url, seconds):
    out = subprocess.run(["wrk", "-t2", "-c16", f"-d{seconds}s", url], check=True, capture_output=True, text=True).stdout
    if "Non-2xx" in out:
        raise SystemExit(out)
    return float(re.search(r"Requests/sec:\s*([\d.]+)", out).group(1))


def warm_row(row, server, info, folder, runs):
    rng = random.Random(5)
    # The largest of 300 tiles, because it has the most in it.
    path = max((random_tile(rng, info) for _ in range(300)), key=lambda p: len(server.get(p)))
    body = server.get(path)
    with open(os.path.join(folder, "tile.png"), "wb") as f:
        f.write(body)
    with Nginx(folder, "access_log off; sendfile on; tcp_nopush on; types { image/png png; } open_file_cache max=100;", "worker_processes 2;") as nginx:
        rates = []
        for _ in range(runs):
            ours = wrk(f"http://127.0.0.1:{server.port}{path}", 4)
            theirs = wrk(f"http://127.0.0.1:{nginx.port}/tile.png", 4)
            rates.append((ours, theirs))
    ratio = statistics.median(a / b for a, b in rates)
    row(f"a warm tile of {len(body)} bytes, wrk -c16 / nginx, the same file", f"{rates[-1][0]:.0f} / {rates[-1][1]:.0f} per second = {ratio:.2f}", ">= 0.5")


def cold_row(row, server, info):
    seconds, took = fetch_random(server, info, 1, 2000, 4)
    row("cold random tiles, all axes, levels 0 to 5, 4 connections", f"{len(took) / seconds:.0f} per second, p99 {1e3 * took[int(len(took) * 0.99)]:.0f} ms", ">= 300, <= 50 ms")


def memory_row(row, server, info, count):
    peaks = []
    for part in range(10):
        fetch_random(server, info, 100 + part, count // 10, 4)
        peaks.append(server.rss())
    row(f"{count} random tiles, caches of 256 MB: RSS halfway and at the end", f"{peaks[4]:.0f} MB, {peaks[-1]:.0f} MB", "<= 512, flat")


def idle_row(row, server):
    before = server.rss()
    sockets = []
    for i in range(800):
        s = socket.create_connection(("127.0.0.1", server.port))
        if i % 2:
            s.sendall(b"GET /healthz HT")
        sockets.append(s)
    took = []
    for _ in range(50):
        began = time.perf_counter()
        server.get("/healthz")
        took.append(time.perf_counter() - began)
    grown = server.rss() - before
    began = time.perf_counter()
    for s in sockets:  # the server closes them
        s.settimeout(120)
        while s.recv(4096):
            pass
        s.close()
    row("/healthz beside 800 idle and half-sent connections", f"{1e3 * max(took):.1f} ms at most, {grown:.0f} MB more; all dropped after {time.perf_counter() - began:.0f} s", "at once")


def main(arguments):
    options_of = parser("tools/bench/run serve", __doc__, runs=3)
    options_of.add_argument("--tiles", type=count, default=100000, metavar="N", help="random tiles of the memory row (default 100000)")
    options_of.add_argument("--huge", action="store_true", help="also a file of 10^15 cells, which takes minutes to make")
    options = options_of.parse_args(arguments)
    build("wrk nginx-light", "teracell")

    def row(what, found, bar=""):
        print(f"{what:<72} {found:<56} {bar}", flush=True)

    with tempfile.TemporaryDirectory() as folder:
        path = mesh_in_cube(options.mesh, 10000, folder)
        with Server(path, "--cache", "256M") as server:
            info = json.loads(server.get("/api/v1/grids/g10000"))
            cold_row(row, server, info)
            warm_row(row, server, info, folder, options.runs)
            memory_row(row, server, info, options.tiles)
        with Server(path, "--request-timeout", "5", "--idle-timeout", "5") as server:
            idle_row(row, server)
        if options.huge:
            with Server(mesh_in_cube(options.mesh, 100000, folder)) as server:
                info = json.loads(server.get("/api/v1/grids/g100000"))
                before, began = server.rss(), time.perf_counter()
                server.get(f"/api/v1/grids/g100000/tile/z/{info['levels'][8]['cells'][2] // 2}/8/0_0.png")
                seconds = time.perf_counter() - began
                row("10^15 cells: the first overview tile", f"{1e3 * seconds:.0f} ms, {server.rss() - before:.0f} MB more", "<= 100 ms")
