"""What the stand-ins for package managers share: the archive of what is committed, the header of stb, and a Debian whose HDF5 is nothing special."""
import hashlib
import os
import pathlib
import shutil
import subprocess

TOP = pathlib.Path(__file__).resolve().parents[2]
RECIPES = TOP / "tools/install/recipes"


def empty(name):
    folder = TOP / "build/recipes" / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def unpack(folder):
    """The files of a release, as its archive has them, without what is not committed."""
    archive = subprocess.run(["git", "-C", TOP, "archive", "HEAD"], check=True, stdout=subprocess.PIPE)
    subprocess.run(["tar", "-x", "-C", folder], check=True, input=archive.stdout)


def put_stb(sha256, folder):
    """Debian's stb_image_write.h in place of the download: the same bytes, by the hash of the recipe."""
    header = pathlib.Path("/usr/include/stb/stb_image_write.h").read_bytes()
    if hashlib.sha256(header).hexdigest() != sha256:
        raise SystemExit("the recipe's stb_image_write.h is not that of libstb-dev")
    folder.mkdir(parents=True)
    (folder / "stb_image_write.h").write_bytes(header)


def environment(folder, **more):
    """Elsewhere pkg-config knows no hdf5-serial, so that CMake itself has to find HDF5."""
    asked = folder / "pkg-config"
    asked.write_text('#!/bin/sh\ncase "$*" in *hdf5-serial*) exit 1 ;; esac\nexec /usr/bin/pkg-config "$@"\n', encoding="utf-8")
    asked.chmod(0o755)
    return {**os.environ, "PKG_CONFIG": str(asked), **more}
