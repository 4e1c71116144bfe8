"""What pip calls, by pyproject.toml: CMake builds and installs, and this packs what it has installed as a wheel.

It needs no package of Python, so pip works without a network. CMAKE_ARGS has further options for CMake, TERACELL_PRESET names another preset, and
--config-settings=build-dir=FOLDER names a build folder: what was compiled there is not compiled again.
"""
import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

NAME = "teracell-" + re.search(r"project\(teracell VERSION ([\d.]+)", pathlib.Path("CMakeLists.txt").read_text())[1]
GLIBC = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build = os.path.abspath((config_settings or {}).get("build-dir", "build/wheel"))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        install(build, folder)
        tag = tag_of(folder)
        info = folder / f"{NAME}.dist-info"
        (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: {NAME}\nRoot-Is-Purelib: false\nTag: {tag}\n")
        files = {path: path.relative_to(folder).as_posix() for path in sorted(folder.rglob("*")) if path.is_file()}
        record = (info / "RECORD").relative_to(folder).as_posix()
        (info / "RECORD").write_text("".join(f"{name},{hash_of(path)},{path.stat().st_size}\n" for path, name in files.items()) + f"{record},,\n")
        wheel = f"{NAME}-{tag}.whl"
        with zipfile.ZipFile(pathlib.Path(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as packed:
            for path, name in (*files.items(), (info / "RECORD", record)):
                packed.write(path, name)
    return wheel


def build_sdist(sdist_directory, config_settings=None):
    metadata = pathlib.Path("tools/python/METADATA.in").read_text().replace("@PROJECT_VERSION@", NAME.split("-")[1])
    packed = pathlib.Path(sdist_directory, f"{NAME}.tar.gz")
    subprocess.run(["git", "archive", f"--prefix={NAME}/", f"--add-virtual-file={NAME}/PKG-INFO:{metadata}", "-o", packed, "HEAD"], check=True)
    return packed.name


def install(build, folder):
    """Builds what the wheel holds, and lays it out in the folder."""
    options = {
        "Python_EXECUTABLE": sys.executable, "TERACELL_PYTHON": "ON", "TERACELL_STATIC": "ON", "TERACELL_UNITY": "ON",
        "TERACELL_WASM": "ON" if shutil.which("emcmake") else "OFF", "TERACELL_PYTHON_DIR": ".", "CMAKE_INSTALL_LIBDIR": "teracell",
        "CMAKE_INSTALL_BINDIR": f"{NAME}.data/scripts", "CMAKE_INSTALL_DATAROOTDIR": f"{NAME}.data/data/share",
        "CMAKE_INSTALL_DOCDIR": f"{NAME}.dist-info/licenses"}
    pathlib.Path(build, "CMakeCache.txt").unlink(missing_ok=True)  # options of other builds; objects stay
    subprocess.run(["cmake", "--preset", os.environ.get("TERACELL_PRESET", "release"), "-B", build, *(f"-D{name}={value}" for name, value in options.items()),
                    *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
    subprocess.run(["cmake", "--build", build, "--target", "teracell", "manual", "teracell_python"], check=True)
    for component in "program", "library", "python":
        subprocess.run(["cmake", "--install", build, "--prefix", folder, "--strip", "--component", component], check=True)
    for link in [path for path in folder.rglob("*") if path.is_symlink()]:  # a wheel has none, and the loader looks for their names
        link.resolve().replace(link)


def tag_of(folder):
    """manylinux_2_N, as PEP 600 has it, where all that is missing is glibc 2.N; otherwise this kind of machine."""
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    system, machine = sysconfig.get_platform().split("-", 1)
    programs = [path for path in folder.rglob("*") if path.is_file() and path.read_bytes().startswith(b"\x7fELF")]
    needs = subprocess.run(["objdump", "-p", *programs], check=True, capture_output=True, text=True).stdout
    names = set(re.findall(r"\bGLIBC_(\S+)", needs))  # beside versions there are GLIBC_PRIVATE, for glibc alone, and GLIBC_ABI_DT_RELR
    # All of 2.2.5 is surely there in 2.3 alone.
    versions = [int(version[1]) + bool(version[2]) for name in names if (version := re.fullmatch(r"2[.]([0-9]+)((?:[.][0-9]+)*)", name))]
    if 0 < len(names) == len(versions) and set(re.findall(r"NEEDED +(\S+)", needs)) <= GLIBC | {path.name for path in programs}:
        system = f"manylinux_2_{max(versions)}"
    return f"{python}-{python}-{system}_{machine}"


def hash_of(path):
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(path.read_bytes()).digest()).decode().rstrip("=")
