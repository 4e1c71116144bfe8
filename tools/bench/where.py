"""Where the processor's time goes: the functions of a command that take most of it, by `perf` (Debian's linux-perf) where that is installed."""
import os
import re
import shutil
import subprocess
import tempfile


def short(symbol):
    """A function's name without its parameters, and without what all names have."""
    symbol = re.sub(r"\(anonymous namespace\)::|teracell::(store::|mesher::)?|\[clone [^]]*\]", "", symbol)
    depth, name = 0, ""
    for character in symbol:
        depth += (character in "<(") - (character in ">)")
        if depth == 0 and character not in ">)":
            name += character
    return name.strip()[-40:] or symbol[:40]


def where(*command, most=6):
    """One run of the command as a text: shares of its processor time, the largest first. Empty without perf."""
    if not shutil.which("perf"):
        return ""
    with tempfile.TemporaryDirectory() as folder:
        data = os.path.join(folder, "perf.data")
        recorded = subprocess.run(["perf", "record", "-q", "-e", "cpu-clock", "-F", "997", "-o", data, "--", *command], capture_output=True, text=True)
        if recorded.returncode != 0:
            return ""
        said = subprocess.run(["perf", "report", "-i", data, "--stdio", "--no-children", "--sort", "symbol", "-w", "400"], capture_output=True, text=True).stdout
    shares = {}
    for line in said.splitlines():
        found = re.match(r"\s+([\d.]+)%\s+\[(.)\]\s+(.*?)(\s+-)*\s*$", line)
        if found:
            name = "the kernel" if found[2] == "k" else "libraries without names" if found[3].startswith("0x") else short(found[3])
            shares[name] = shares.get(name, 0) + float(found[1])
    return ", ".join(f"{name} {share:.0f} %" for name, share in sorted(shares.items(), key=lambda item: -item[1])[:most])
