#!/usr/bin/python3
"""Builds and tests as the recipe of Spack says, with Debian's packages in place of Spack's.

Usage: tests/install/spack.py [+VARIANT|~VARIANT...]

It needs what packages.sh lists for a build, and for the variants. It stands in for the part of Spack's language that the recipe uses, so it can't say
whether Spack finds versions of all packages that fit each other.
"""
import inspect
import os
import pathlib
import subprocess
import sys
import sysconfig
import types

import support

SAID = {}  # directive: [(arguments, options)], as the recipe gives them


def directive(name):
    def say(*arguments, **options):
        SAID.setdefault(name, []).append((arguments, options))

    return say


class CMakePackage:
    def __init__(self, variants, sources, prefix):
        self.variants = variants
        self.stage = types.SimpleNamespace(source_path=str(sources))
        self.prefix = str(prefix)
        python = types.SimpleNamespace(command=types.SimpleNamespace(path="/usr/bin/python3"), package=types.SimpleNamespace(platlib="lib/python3/site-packages"))
        self.spec = types.SimpleNamespace(satisfies=self.satisfies)
        self.spec = type("Spec", (), {"satisfies": staticmethod(self.satisfies), "__getitem__": lambda _, name: {"python": python}[name]})()

    def satisfies(self, condition):
        return self.variants[condition[1:]] == (condition[0] == "+")

    def define(self, name, value):
        return f"-D{name}={'ON' if value is True else 'OFF' if value is False else value}"

    def define_from_variant(self, name, variant):
        return self.define(name, self.variants[variant])


def which(path, required):
    if required and not os.path.exists(path):
        raise SystemExit(f"there is no {path}")
    return lambda *arguments: subprocess.run([path, *arguments], check=True)


def load():
    directives = {name: directive(name) for name in ("version", "variant", "resource", "generator", "depends_on", "extends", "conflicts")}
    cmake = types.SimpleNamespace(CMakePackage=CMakePackage, generator=directives.pop("generator"))
    language = types.SimpleNamespace(**directives, which=which, join_path=os.path.join)
    path = support.RECIPES / "spack/package.py"
    text = path.read_text(encoding="utf-8")
    for line in ("from spack_repo.builtin.build_systems.cmake import CMakePackage, generator\n", "from spack.package import *\n"):
        if line not in text:
            raise SystemExit(f"{path}: lacks {line}")
        text = text.replace(line, "\n")
    recipe = {**vars(cmake), **vars(language)}
    exec(compile(text, path, "exec"), recipe)
    return recipe["Teracell"]


def main():
    teracell = load()
    variants = {name: options["default"] for (name,), options in SAID["variant"]}
    for chosen in sys.argv[1:]:
        if chosen[1:] not in variants or chosen[0] not in "+~":
            sys.exit(__doc__)
        variants[chosen[1:]] = chosen[0] == "+"
    for name in ("depends_on", "extends"):  # a condition of no variant is a slip of the pen
        for arguments, options in SAID[name]:
            if options.get("when", "+hdf5")[1:] not in variants:
                sys.exit(f"{name}{arguments}: unknown condition {options['when']}")
    folder = support.empty("spack")
    sources, prefix = folder / "spack-src", folder / "prefix"
    sources.mkdir()
    support.unpack(sources)
    (_, stb), = SAID["resource"]
    support.put_stb(stb["sha256"], sources / stb["placement"])
    package = teracell(variants, sources, prefix)
    environment = support.environment(folder)
    run = lambda *command: subprocess.run(command, check=True, cwd=sources, env=environment)
    run("cmake", "-S", ".", "-B", "build", "-G", "Ninja", f"-DCMAKE_INSTALL_PREFIX={prefix}", "-DCMAKE_BUILD_TYPE=Release", *package.cmake_args())
    run("cmake", "--build", "build", "-j", "2")
    run("cmake", "--install", "build")
    tested = folder / "test"
    tested.mkdir()
    os.chdir(tested)
    for name, test in inspect.getmembers(package, inspect.ismethod):
        if name.startswith("test_"):
            test()
    for variant, program in (("mpi", "teracell_mpi"), ("step", "teracell-step")):
        if (prefix / "bin" / program).exists() != variants[variant]:
            sys.exit(f"{program} does not follow the variant {variant}")
    exported = subprocess.run([prefix / "bin/teracell", "export", "stadium.tcell", "--region", "0,0,0,8,8,8", "-o", "box.h5"], check=False).returncode
    if (exported == 0) != variants["hdf5"]:
        sys.exit("what is exported does not follow the variant hdf5")
    if variants["python"]:
        where = {**os.environ, "PYTHONPATH": str(prefix / "lib/python3/site-packages")}
        subprocess.run(["/usr/bin/python3", "-c", "import teracell; print(teracell.open('stadium.tcell').shape)"], check=True, env=where)
    print("spack: built and tested " + " ".join(("+" if on else "~") + name for name, on in variants.items()))


if __name__ == "__main__":
    main()
