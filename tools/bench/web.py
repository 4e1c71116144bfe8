"""The rows of `tools/bench/run web`: the dashboard on the 10^12-cell grid, in Chromium without a graphics card. web.mjs measures."""
import json
import os
import subprocess
import tempfile

from common import ROOT, Server, build, mesh_in_cube, parser


def main(arguments):
    options_of = parser("tools/bench/run web", __doc__)
    options_of.add_argument("--grid", help="a .tcell file to serve; without it the surface is meshed")
    options_of.add_argument("--url", help="the address of a server that runs already")
    options = options_of.parse_args(arguments)
    build("chromium", "teracell")

    def row(what, found, bar=""):
        print(f"{what:<86} {found:<46} {bar}", flush=True)

    def measure(url):
        with subprocess.Popen(["node", os.path.join(ROOT, "tools/bench/web.mjs"), url], stdout=subprocess.PIPE, text=True) as process:
            for line in process.stdout:
                row(*json.loads(line))
        if process.returncode:
            raise SystemExit("the dashboard could not be measured")

    if options.url:
        return measure(options.url)
    with tempfile.TemporaryDirectory() as folder:
        with Server(options.grid or mesh_in_cube(options.mesh, 10000, folder)) as server:
            measure(server.url)
