"""What the measurements of tools/bench/run share: where things are, how they are built, and the options of all."""
import argparse
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Real surfaces are not part of the project. Measurements, and the tests that use them, look for them here.
MESHES = os.path.join(os.path.dirname(ROOT), "shared/meshes")
TERACELL = os.path.join(ROOT, "build/bench/teracell")


def build(packages, *targets):
    """Installs the Debian packages that are missing and builds the targets; what the tools say is shown only when one fails."""
    print("building ...", file=sys.stderr)
    for command in (["bash", "-euc", f'source tools/install/packages.sh; need "${{build_packages[@]}}" {packages}'],
                    ["cmake", "--preset", "bench"],
                    ["cmake", "--build", "--preset", "bench", "--target", *(targets or ["all"])]):
        done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            sys.exit(f"{done.stdout}tools/bench/run: {' '.join(command[:3])} failed with status {done.returncode}: see above")


def peer(name):
    """The path of a peer; None if it was not built."""
    path = os.path.join(ROOT, "build/bench/tools/bench/peers", name)
    return path if os.path.exists(path) else None


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
