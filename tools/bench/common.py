"""What the measurements of tools/bench/run share: where things are, how they are built, and the options of all."""
import argparse
import os
import re
import shutil
import socket
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Real surfaces are not part of the project. Measurements, and the tests that use them, look for them here.
MESHES = os.path.join(os.path.dirname(ROOT), "shared/meshes")
TERACELL = os.path.join(ROOT, "build/bench/teracell")


def build(packages, *targets, options=()):
    """Installs the Debian packages that are missing and builds the targets; what the tools say is shown only when one fails."""
    print("building ...", file=sys.stderr)
    for command in (["bash", "-euc", f'source tools/install/packages.sh; need "${{build_packages[@]}}" {packages}'],
                    ["cmake", "--preset", "bench", *options],
                    ["cmake", "--build", "--preset", "bench", "--target", *(targets or ["all"])]):
        done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            sys.exit(f"{done.stdout}tools/bench/run: {' '.join(command[:3])} failed with status {done.returncode}: see above")


def peer(name):
    """The path of a peer; None if it was not built."""
    paths = [os.path.join(ROOT, "build/bench", folder, name) for folder in ("", "tools/bench/peers")]
    return next((path for path in paths if os.path.isfile(path)), None)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def wait_for(port):
    for _ in range(200):
        with socket.socket() as s:
            if s.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.02)
    sys.exit(f"nobody listens at port {port}")


class Started:
    """A process that serves at `port` until the end of a `with`."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


class Server(Started):
    """`teracell serve` on a free port."""

    def __init__(self, *arguments, program=TERACELL):
        self.process = subprocess.Popen([program, "serve", *arguments, "--port", "0", "--log", "none"], stdout=subprocess.PIPE, text=True)
        address = re.search(r"http://\S+:(\d+)/", self.process.stdout.readline())
        if not address:
            raise SystemExit(f"teracell serve {' '.join(arguments)} did not start: exit status {self.process.wait()}")
        self.url, self.port = address[0], int(address[1])


class Nginx(Started):
    """nginx on a free port, with the files of a folder. `http` and `main` are more lines of these sections."""

    def __init__(self, folder, http="access_log off;", main=""):
        os.chmod(folder, 0o755)
        self.port = free_port()
        user = "user root;" if os.geteuid() == 0 else ""
        temporary = "".join(f"{kind}_temp_path {folder}/nginx-{kind};\n" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        with open(os.path.join(folder, "nginx.conf"), "w") as file:
            file.write(f"daemon off; {user} {main} pid {folder}/nginx.pid; error_log {folder}/nginx.log warn; events {{ worker_connections 1024; }}\n"
                       f"http {{ {http} {temporary} server {{ listen 127.0.0.1:{self.port}; root {folder}; keepalive_requests 100000000; }} }}\n")
        program = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin")
        self.process = subprocess.Popen([program, "-e", f"{folder}/nginx.log", "-c", f"{folder}/nginx.conf"])
        wait_for(self.port)


def mesh_in_cube(mesh, n, folder):
    """Meshes a surface in its cubic domain of n^3 cells and returns the file."""
    scene, path = os.path.join(folder, f"{n}.json"), os.path.join(folder, f"g{n}.tcell")
    subprocess.run([sys.executable, os.path.join(ROOT, "tools/bench/peers/cubic_scene.py"), mesh, str(n), scene], check=True)
    subprocess.run([TERACELL, "mesh", scene, "-o", path, "--progress", "none"], check=True, stdout=subprocess.DEVNULL)
    return path


def _mesh(path):
    if not os.path.isfile(path):
        raise argparse.ArgumentTypeError(f"expected an OBJ file, found nothing at {os.path.normpath(path)}")
    return os.path.abspath(path)


def count(text):
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"expected a whole number from 1 on, found '{text}'")
    return int(text)


def parser(name, doc, runs=None):
    """A parser with the options of all measurements, and with --runs if `runs` gives its default."""
    made = argparse.ArgumentParser(prog=name, description=doc, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
    if runs:
        made.add_argument("--runs", type=count, default=runs, metavar="K", help=f"how often each is measured; medians are shown (default {runs})")
    made.add_argument("--mesh", type=_mesh, default=os.path.join(MESHES, "nefertiti.obj"), metavar="FILE",
                      help="the surface, an OBJ file (default: nefertiti.obj of a shared/meshes folder beside the project)")
    return made
