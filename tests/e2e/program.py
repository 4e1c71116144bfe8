"""Runs the program as a user would, and reads what it writes: .npy and .png, with nothing but the standard library."""
import importlib
import json
import os
import pathlib
import resource
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

PROGRAM = None  # the path; main() sets it before it imports the cases


def main(*modules):
    """Runs the cases of the modules. Arguments of the script: the program's path, then what unittest takes."""
    if len(sys.argv) < 2:
        sys.exit(f"usage: {os.path.basename(sys.argv[0])} PATH_TO_TERACELL [arguments of unittest]")
    global PROGRAM
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    for module in modules:
        for name, case in vars(importlib.import_module(module)).items():
            if isinstance(case, type) and case.__module__ == module:
                assert not hasattr(sys.modules["__main__"], name), f"two cases are called {name}"
                setattr(sys.modules["__main__"], name, case)
    unittest.main()


class Result:
    def __init__(self, args, done):
        self.args = args
        self.status = done.returncode
        self.out = done.stdout.decode() if done.stdout is not None else ""
        self.err = done.stderr.decode() if done.stderr is not None else ""


def teracell(*args, cwd, **options):
    args = [str(a) for a in args]
    options.setdefault("stdout", subprocess.PIPE)
    return Result(args, subprocess.run([PROGRAM, *args], cwd=cwd, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, timeout=120, **options))


def limit_files():
    """For preexec_fn, with restore_signals=False: no file may become larger than 16 kB."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (16384, resource.RLIM_INFINITY))


class Case(unittest.TestCase):
    """A test in a folder of its own."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="teracell-e2e-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, contents):
        if isinstance(contents, dict):
            contents = json.dumps(contents)
        pathlib.Path(self.path(name)).write_bytes(contents.encode() if isinstance(contents, str) else contents)
        return name

    def bytes(self, name):
        return pathlib.Path(self.path(name)).read_bytes()

    def read_json(self, name):
        return json.loads(self.bytes(name))

    def run_ok(self, *args, **options):
        r = teracell(*args, cwd=self.folder, **options)
        self.assertEqual(r.status, 0, f"{r.args}: {r.err}")
        return r

    def json_of(self, *args):
        out = self.run_ok(*args, "--json").out
        self.assertEqual(out.count("\n"), 1, "JSON comes as one line")
        return json.loads(out)

    def refused(self, status, phrases, *args, **options):
        """The program fails with `status` and one paragraph that has all the phrases. It prints nothing else and leaves no partial file."""
        r = teracell(*args, cwd=self.folder, **options)
        self.assert_refused(r, status, phrases)
        self.no_debris()
        return r.err

    def assert_refused(self, r, status, phrases):
        said = f"{r.args}: {r.status}, stdout {r.out!r}, stderr {r.err!r}"
        self.assertEqual(r.status, status, said)
        self.assertEqual(r.out, "", said)
        self.assert_paragraph(r.err, said)
        for phrase in [phrases] if isinstance(phrases, str) else phrases:
            self.assertIn(phrase, r.err, said)

    def interrupt(self, args, ready, sent=signal.SIGINT):
        """Runs the program until `ready`, which is asked with its process, and sends a signal: it ends soon and leaves no partial file."""
        process = subprocess.Popen([PROGRAM, *map(str, args)], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 30
        while process.poll() is None and not ready(process) and time.monotonic() < deadline:
            time.sleep(0.002)
        process.send_signal(sent)
        out, err = process.communicate(timeout=10)
        self.assertEqual((process.returncode, out), (130, ""), err)
        last = err.splitlines(keepends=True)[-1]
        self.assert_paragraph(last)
        self.assertIn("interrupted", last)
        self.no_debris()
        return err

    def mount_small_disk(self, name):
        """Mounts 16 kB at a folder until the end of the test. Returns whether it could: only root may mount."""
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", self.path(name)], capture_output=True).returncode != 0:
            return False
        self.addCleanup(subprocess.run, ["umount", self.path(name)], check=True)
        return True

    def wait_until(self, condition, what, seconds=30):
        """Asks until `condition` answers with something true."""
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, f"{seconds} s went by without {what}")
            time.sleep(0.05)

    def wait_for_port(self, port):
        def answers():
            with socket.socket() as s:
                return s.connect_ex(("127.0.0.1", port)) == 0
        self.wait_until(answers, f"anybody who listens at port {port}")

    def assert_paragraph(self, err, said=""):
        self.assertTrue(err.startswith("teracell: "), said or err)
        self.assertTrue(err.endswith("\n") and err.count("\n") == 1, said or err)

    def no_debris(self):
        for folder, _, files in os.walk(self.folder):
            for name in files:
                self.assertFalse(".part" in name, os.path.join(folder, name))

    def export(self, grid, *args):
        """(shape, cells) in C order [z][y][x]."""
        self.run_ok("export", grid, "-o", "export.npy", *args)
        return read_npy(self.bytes("export.npy"))

    def slice_npy(self, grid, *args):
        self.run_ok("slice", grid, "-o", "slice.npy", *args)
        return read_npy(self.bytes("slice.npy"))

    def slice_png(self, grid, *args):
        self.run_ok("slice", grid, "-o", "slice.png", *args)
        return read_png(self.bytes("slice.png"))


def read_npy(data):
    """(shape, values as bytes or a list of 16-bit numbers)."""
    assert data[:8] == b"\x93NUMPY\x01\x00", data[:8]
    size = struct.unpack("<H", data[8:10])[0]
    assert (10 + size) % 64 == 0 and data[9 + size : 10 + size] == b"\n"
    header = eval(data[10 : 10 + size].decode(), {"__builtins__": {}}, {})  # the format defines it as a literal of Python
    assert set(header) == {"descr", "fortran_order", "shape"} and header["fortran_order"] is False, header
    count = 1
    for n in header["shape"]:
        count *= n
    body = data[10 + size :]
    if header["descr"] == "|u1":
        values = body
    else:
        assert header["descr"] == "<u2", header
        values = list(struct.unpack(f"<{len(body) // 2}H", body))
    assert len(values) == count, (len(values), count)
    return header["shape"], values


class Picture:
    def __init__(self, width, height, bits, kind):
        self.width, self.height, self.bits, self.kind = width, height, bits, kind
        self.rows = []  # lists of (r, g, b, a), from the top


def unfilter(kind, line, above, step):
    out = bytearray(line)
    if kind == 2:
        return bytearray((x + y) & 255 for x, y in zip(out, above))
    for i, x in enumerate(out):
        left, up = (out[i - step] if i >= step else 0), above[i]
        corner = above[i - step] if i >= step else 0
        if kind == 1:
            out[i] = (x + left) & 255
        elif kind == 3:
            out[i] = (x + (left + up) // 2) & 255
        elif kind == 4:
            p = left + up - corner
            near = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))
            out[i] = (x + near[2]) & 255
        else:
            assert kind == 0, kind
    return out


def png_chunks(data):
    """(name, body) of each."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks = 8, []
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + size]
        assert struct.unpack(">I", data[at + 8 + size : at + 12 + size])[0] == zlib.crc32(name + body), name
        chunks.append((name, body))
        at += 12 + size
    assert at == len(data) and chunks[0][0] == b"IHDR" and chunks[-1] == (b"IEND", b"")
    return chunks


def read_png(data):
    chunks = png_chunks(data)
    width, height, bits, kind, *rest = struct.unpack(">IIBBBBB", chunks[0][1])
    assert rest == [0, 0, 0], rest
    picture = Picture(width, height, bits, kind)
    named = dict(chunks)
    pixel_bits = {3: bits, 6: 4 * bits, 2: 3 * bits, 0: bits}[kind]
    palette = None
    if kind == 3:
        plte, trns = named[b"PLTE"], named.get(b"tRNS", b"")
        palette = [(*plte[3 * i : 3 * i + 3], trns[i] if i < len(trns) else 255) for i in range(len(plte) // 3)]
    raw = zlib.decompress(b"".join(body for name, body in chunks if name == b"IDAT"))
    line = (width * pixel_bits + 7) // 8
    assert len(raw) == height * (line + 1)
    above = bytearray(line)
    for r in range(height):
        start = r * (line + 1)
        above = unfilter(raw[start], raw[start + 1 : start + 1 + line], above, max(1, pixel_bits // 8))
        if kind == 6:
            row = [tuple(above[4 * i : 4 * i + 4]) for i in range(width)]
        else:
            assert kind == 3
            per = 8 // bits
            row = [palette[above[i // per] >> (bits * (per - 1 - i % per)) & ((1 << bits) - 1)] for i in range(width)]
        picture.rows.append(row)
    return picture
