"""`teracell serve` on a free port, and clients for it: http.client for well-formed requests, plain sockets for all others."""
import http.client
import json
import os
import pathlib
import queue
import re
import signal
import socket
import subprocess
import threading

import solids
from program import PROGRAM, Case

LINE = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z \S+ \S+ [!-~]+ \d{3} \d+ \d+\.\d{3} [a-z0-9_]+")


class Server:
    """Runs until stop() or the end of the test. `problems` are the lines of stderr that are not lines of the access log. `status` is that of
    its exit, once somebody has waited for it."""

    def __init__(self, folder, *args, **options):
        self.process = subprocess.Popen([PROGRAM, "serve", *map(str, args), *([] if "--port" in args else ["--port", "0"])], cwd=folder,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)
        self.lines, self.queue, self.status = [], queue.Queue(), None
        self.reader = threading.Thread(target=self.read_log, daemon=True)
        self.reader.start()
        self.ready = self.process.stdout.readline()
        found = re.fullmatch(r"teracell: serving (\d+) grids? at (http://\S+:(\d+)(/\S*/|/))\n", self.ready)
        if not found:
            self.process.wait()
            self.reader.join()
            raise AssertionError(f"not ready: {self.ready!r} {self.lines}")
        self.grids, self.url, self.port, self.base = int(found[1]), found[2], int(found[3]), found[4]

    def read_log(self):
        for line in self.process.stderr:
            self.lines.append(line.rstrip("\n"))
            self.queue.put(line.rstrip("\n"))

    @property
    def problems(self):
        return [line for line in self.lines if not LINE.fullmatch(line)]

    def log_line(self):
        """The next line on stderr."""
        return self.queue.get(timeout=20)

    def problem(self):
        """The next line on stderr that is not one of the access log."""
        while LINE.fullmatch(line := self.queue.get(timeout=20)):
            pass
        return line

    def signal(self, number):
        self.process.send_signal(number)

    def wait(self, timeout=20):
        self.status = self.process.wait(timeout)
        self.reader.join()
        self.process.stdout.close()
        self.process.stderr.close()
        return self.status

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
            self.wait()

    def memory(self):
        return int(pathlib.Path(f"/proc/{self.process.pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def connection(self):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)

    def get(self, path, method="GET", **headers):
        connection = self.connection()
        try:
            connection.request(method, path, headers={k.replace("_", "-"): v for k, v in headers.items()})
            return Answer(connection.getresponse())
        finally:
            connection.close()

    def socket(self, receive=None, source="127.0.0.1"):
        s = socket.socket()
        s.bind((source, 0))
        if receive:
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive)
        s.settimeout(20)
        try:
            s.connect(("127.0.0.1", self.port))
        except OSError:
            s.close()
            raise
        return s

    def raw(self, data):
        """All that the server sends back for these bytes until it closes the connection."""
        with self.socket() as s:
            try:
                s.sendall(data)
            except (BrokenPipeError, ConnectionResetError):
                pass
            return read_all(s)


class Answer:
    def __init__(self, response):
        self.status, self.headers, self.body = response.status, response.headers, response.read()

    def json(self):
        return json.loads(self.body)


def read_all(s):
    out = bytearray()
    try:
        while piece := s.recv(65536):
            out += piece
    except ConnectionResetError:
        pass
    return bytes(out)


class ServeCase(Case):
    """A test with grids in its folder. The servers that it starts must end with a clean log: those that run at its end are stopped then."""

    def setUp(self):
        super().setUp()
        self.servers = []
        self.addCleanup(lambda: [s.kill() for s in self.servers])

    def tearDown(self):
        for server in self.servers:
            if server.status is None:
                self.stop(server)

    def grid(self, name="g.tcell", lo=(0, 0, 0), hi=(600, 30, 20), cells=602):
        self.write("box.stl", solids.binary_stl(solids.box_facets(lo, hi)))
        self.run_ok("mesh", "box.stl", "--cells", cells, "-o", name, "--progress", "none")
        return name

    def token(self, text, mode=0o600):
        name = self.write("token", text)
        os.chmod(self.path(name), mode)
        return name

    def serve(self, *args, **options):
        self.servers.append(Server(self.folder, *args, **options))
        return self.servers[-1]

    def serve_grid(self, *args, **options):
        """A server of one grid."""
        return self.serve(self.grid(), *args, **options)

    def stop(self, server, problems=0):
        server.signal(signal.SIGTERM)
        self.assertEqual(server.wait(), 0, server.lines[-5:])
        self.assertEqual(len(server.problems), problems, server.problems)
