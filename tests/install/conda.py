#!/usr/bin/python3
"""Builds and tests as the recipe of conda-forge says, with Debian's packages in place of conda's.

Usage: tests/install/conda.py

It needs python3-yaml and what packages.sh lists for a build. It stands in for rattler-build, so it can't say whether conda's packages fit.
"""
import re
import subprocess

import support
import yaml

# The keys of the format (schema version 1) that the recipe may use.
KEYS = {
    "": {"schema_version", "context", "package", "source", "build", "requirements", "tests", "about"},
    "package": {"name", "version"},
    "source": {"url", "sha256", "target_directory"},
    "build": {"number", "skip"},
    "requirements": {"build", "host", "run"},
    "tests": {"script"},
    "about": {"summary", "license", "license_file", "homepage"},
}


def known(recipe):
    for section, keys in KEYS.items():
        parts = recipe if not section else recipe[section]
        for part in parts if isinstance(parts, list) else [parts]:
            if more := set(part) - keys:
                raise SystemExit(f"recipe.yaml, {section or 'top level'}: unknown {sorted(more)}")


def main():
    text = (support.RECIPES / "conda/recipe.yaml").read_text(encoding="utf-8")
    context = yaml.safe_load(text)["context"]
    recipe = yaml.safe_load(re.sub(r"\$\{\{ (\w+) \}\}", lambda found: context[found[1]], text))
    known(recipe)
    folder = support.empty("conda")
    sources, prefix = folder / "work", folder / "prefix"
    sources.mkdir()
    support.unpack(sources)
    stb = recipe["source"][1]
    support.put_stb(stb["sha256"], sources / stb["target_directory"])
    arguments = f"-DCMAKE_INSTALL_PREFIX={prefix} -DCMAKE_INSTALL_LIBDIR=lib"
    built = support.environment(folder, PREFIX=str(prefix), SRC_DIR=str(sources), CPU_COUNT="2", CMAKE_ARGS=arguments)
    subprocess.run([support.RECIPES / "conda/build.sh"], check=True, cwd=sources, env=built)
    tested = folder / "test"
    tested.mkdir()
    for test in recipe["tests"]:
        for line in test["script"]:
            subprocess.run(["bash", "-euc", line], check=True, cwd=tested, env={**built, "PATH": f"{prefix}/bin:/usr/bin:/bin"})
    if not (sources / recipe["about"]["license_file"]).exists():
        raise SystemExit("recipe.yaml: there is no license_file")
    print("conda: built and tested")


if __name__ == "__main__":
    main()
