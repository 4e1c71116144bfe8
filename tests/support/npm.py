#!/usr/bin/python3
"""Usage: tests/support/npm.py FOLDER ...: installs the packages of npm that a folder's package-lock.json lists, unless they are there."""
import os
import subprocess
import sys


def install(folder):
    lock, installed = os.path.join(folder, "package-lock.json"), os.path.join(folder, "node_modules", ".package-lock.json")
    if not os.path.exists(installed) or os.path.getmtime(installed) < os.path.getmtime(lock):
        subprocess.run(["npm", "ci", "--no-audit", "--no-fund", "--loglevel=error"], cwd=folder, check=True)
        os.utime(installed)


def install_browser():
    """Where the system has none: fetched and unpacked once, before the tests start it beside each other (see chromium.mjs)."""
    if not os.path.exists("/usr/bin/chromium-headless-shell"):
        folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "browser")
        install(folder)
        subprocess.run(["node", "-e", "require('@sparticuz/chromium').executablePath()"], cwd=folder, check=True)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        install(name)
