#!/usr/bin/python3
"""Runs a command as root in a namespace of users that has all users, and so all capabilities, and in a namespace of mounts.

Usage: tests/install/namespace.py COMMAND...

`unshare --map-users` would do, but for newuidmap, which wants the users of the map to be listed in /etc/subuid.
"""
import ctypes
import os
import sys

CLONE_NEWNS, CLONE_NEWUSER = 0x00020000, 0x10000000


def main():
    ready, mapped = os.pipe(), os.pipe()
    child = os.fork()
    if child == 0:
        if ctypes.CDLL(None).unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0:
            sys.exit("there can be no namespace of users here")
        os.write(ready[1], b".")
        os.read(mapped[0], 1)
        os.setresgid(0, 0, 0)
        os.setresuid(0, 0, 0)
        os.execvp(sys.argv[1], sys.argv[1:])
    os.close(ready[1])
    os.read(ready[0], 1)
    for ids in ("gid_map", "uid_map"):
        with open(f"/proc/{child}/{ids}", "w", encoding="ascii") as file:
            file.write("0 0 65536")
    os.write(mapped[1], b".")
    sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))


if __name__ == "__main__":
    main()
