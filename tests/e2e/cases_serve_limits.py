"""How `teracell serve` treats clients that are slow, malformed, gone or too many, and how it stops."""
import select
import signal
import socket
import time

from serving import ServeCase, read_all

TILE = "/api/v1/grids/g/tile/z/5/0/0_0"


class Limits(ServeCase):
    def test_requests_that_are_too_large_or_malformed(self):
        server = self.serve_grid()
        for status, data in [
            (400, b"nonsense\r\n\r\n"),
            (400, b"GET / HTTP/1.1\r\n\r\n"),
            (400, b"GET / HTTP/1.1\r\nHost: a b\r\n\r\n"),
            (400, b"GET * HTTP/1.1\r\nHost: h\r\n\r\n"),
            (400, b"GET / HTTP/1.1\r\nHost: h\r\nbad field\r\n\r\n"),
            (400, b"GET / HTTP/1.1\r\nHost: h\r\nContent-Length: -1\r\n\r\n"),
            (413, b"GET / HTTP/1.1\r\nHost: h\r\nContent-Length: 100000\r\n\r\n" + b"x" * 100000),
            (413, b"GET / HTTP/1.1\r\nHost: h\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nabcde\r\n0\r\n\r\n"),
            (414, b"GET /" + b"a" * 100000 + b" HTTP/1.1\r\nHost: h\r\n\r\n"),
            (431, b"GET / HTTP/1.1\r\nHost: h\r\n" + b"".join(b"X%d: y\r\n" % i for i in range(10000)) + b"\r\n"),
            (505, b"GET / HTTP/3.0\r\nHost: h\r\n\r\n"),
        ]:
            got = server.raw(data)
            self.assertTrue(got.startswith(b"HTTP/1.1 %d " % status), (data[:60], got[:200]))
            self.assertIn(b'{"error":{"code":', got)
        self.assertEqual(server.get("/healthz").status, 200)

    def test_800_idle_and_half_sent_connections(self):
        server = self.serve_grid("--request-timeout", 3, "--idle-timeout", 3)
        server.get(TILE + ".png")
        memory, descriptors = server.memory(), server.descriptors()
        sockets = [server.socket(source=f"127.0.0.{2 + i % 4}") for i in range(800)]  # a client gets a quarter of the 1024
        for i, s in enumerate(sockets):
            if i % 2:
                s.sendall(b"GET /healthz HTTP/1.1\r\nHost: h\r\nX: ")
        began = time.monotonic()
        self.assertEqual(server.get("/healthz").status, 200)
        self.assertEqual(server.get(TILE + ".png").status, 200)
        self.assertLess(time.monotonic() - began, 3)  # while all of them are there
        self.assertLess(server.memory() - memory, 32 << 20)
        for s in sockets:
            self.assertEqual(read_all(s), b"")
            s.close()
        self.assertLess(time.monotonic() - began, 10)
        self.wait_until(lambda: server.descriptors() <= descriptors + 1, "the ends of all connections")
        metrics = server.get("/metrics").body.decode()
        self.assertIn('reason="idle"} 400\n', metrics)
        self.assertIn('reason="slow_request"} 400\n', metrics)

    def test_more_connections_than_allowed(self):
        server = self.serve_grid("--max-connections", 8)
        ask = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
        def connect(client):
            s = server.socket(source=client)
            s.sendall(ask)
            self.assertIn(b" 200 ", s.recv(4096))
            return s

        def closed(sockets):
            """The one that the server has closed, removed from the list."""
            gone, _, _ = select.select(sockets, [], [], 20)
            self.assertEqual([read_all(s) for s in gone], [b""])
            gone[0].close()
            kept.remove(gone[0])
        kept = [connect(f"127.0.0.{2 + i // 2}") for i in range(8)]
        kept.append(connect("127.0.0.2"))  # it has its quarter: in place of one of its own
        closed(kept[:2])
        self.assertEqual(server.get("/healthz").status, 200)  # in place of one of all
        closed(kept)
        for s in kept:
            s.sendall(ask)
            self.assertIn(b" 200 ", s.recv(4096))
        for s in kept:
            s.close()
        self.assertIn('reason="full"}', server.get("/metrics").body.decode())


class Ending(ServeCase):
    def slow_download(self, server, count=200):
        """A client that has asked for 52 MB, of which the first have come, and has read nothing yet."""
        s = server.socket(receive=4096)
        s.sendall(f"GET {TILE}.bin HTTP/1.1\r\nHost: localhost\r\n\r\n".encode() * count)
        s.recv(1, socket.MSG_PEEK)
        return s

    def test_requests_under_way_are_answered(self):
        self.grid(hi=(600, 600, 20))
        server = self.serve("g.tcell")
        body = server.get(TILE + ".bin").body
        self.assertEqual(len(body), 512 * 512)
        with server.socket() as idle, self.slow_download(server) as slow:
            server.signal(signal.SIGTERM)
            self.assertEqual(read_all(idle), b"")  # at once
            with self.assertRaises(ConnectionRefusedError):
                self.wait_until(lambda: server.socket().close(), "a refusal")
            data = read_all(slow)
        self.assertEqual(server.wait(), 0)
        answers = data.split(b"HTTP/1.1 200 OK\r\n")[1:]
        self.assertTrue(0 < len(answers) < 200, len(answers))
        for answer in answers:  # every answer that was begun arrived whole
            self.assertEqual(answer.split(b"\r\n\r\n", 1)[1], body)
        self.assertIn(b"Connection: close", answers[-1])
        self.assertEqual(server.problems, [])

    def test_it_does_not_wait_for_ever(self):
        self.grid(hi=(600, 600, 20))
        server = self.serve("g.tcell", "--drain-timeout", 0.5)
        with self.slow_download(server):
            began = time.monotonic()
            server.signal(signal.SIGINT)
            self.assertEqual(server.wait(), 0)
            self.assertLess(time.monotonic() - began, 5)
        self.assertEqual(len(server.problems), 1)
        self.assertIn("still under way", server.problems[0])

    def test_a_second_signal_ends_it_at_once(self):
        self.grid(hi=(600, 600, 20))
        for number in [signal.SIGINT, signal.SIGTERM]:
            server = self.serve("g.tcell")
            with self.slow_download(server), server.socket() as idle:
                server.signal(number)
                self.assertEqual(read_all(idle), b"")  # the server has seen the first signal
                began = time.monotonic()
                server.signal(number)
                self.assertEqual(server.wait(), -number)
                self.assertLess(time.monotonic() - began, 2)

    def test_the_log_is_complete_at_the_end(self):
        server = self.serve_grid()
        for i in range(100):
            server.get(f"/nowhere/{i}")
        self.stop(server)
        self.assertEqual(sorted(line.split()[3] for line in server.lines), sorted(f"/nowhere/{i}" for i in range(100)))
