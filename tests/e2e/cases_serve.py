"""`teracell serve` over HTTP: methods, errors, links, tokens, files that change."""
import gzip
import json
import re

from program import read_png
from serving import ServeCase

TILE = "/api/v1/grids/g/tile/z/5/0/0_0"


class Serving(ServeCase):
    def test_a_grid_by_keep_alive(self):
        server = self.serve_grid()
        self.assertEqual(server.grids, 1)
        connection = server.connection()
        for _ in range(3):
            connection.request("GET", TILE + ".png")
            response = connection.getresponse()
            self.assertEqual((response.status, response.headers["Content-Type"]), (200, "image/png"))
            local = connection.sock.getsockname()
            picture = read_png(response.read())
            self.assertEqual(connection.sock.getsockname(), local)  # the same connection
        self.assertEqual((picture.width, picture.height), (512, 32))
        connection.close()
        self.assertEqual(server.get("/api/v1/grids").json()["grids"][0]["id"], "g")
        self.assertEqual(server.get("/healthz").json(), {"status": "ok"})

    def test_head_and_options(self):
        server = self.serve_grid()
        body = server.get("/api/v1/grids/g").body
        for encoding in ["identity", "gzip"]:
            head = server.get("/api/v1/grids/g", "HEAD", Accept_Encoding=encoding)
            self.assertEqual((head.status, head.body, head.headers["Content-Length"]), (200, b"", str(len(body))))
            self.assertIsNone(head.headers["Content-Encoding"])
        zipped = server.get("/api/v1/grids/g", Accept_Encoding="gzip")
        if zipped.headers["Content-Encoding"]:
            self.assertEqual(gzip.decompress(zipped.body), body)
        options = server.get(TILE + ".png", "OPTIONS", Origin="http://localhost:3000", Access_Control_Request_Headers="range")
        self.assertEqual((options.status, options.body), (204, b""))
        self.assertIn("range", options.headers["Access-Control-Allow-Headers"])
        self.assertEqual(options.headers["Access-Control-Allow-Origin"], "http://localhost:3000")
        for a in [options, head, server.get("/nowhere")]:
            self.assertEqual(a.headers["X-Content-Type-Options"], "nosniff")
            self.assertRegex(a.headers["Date"], r"\w{3}, \d\d \w{3} \d{4} \d\d:\d\d:\d\d GMT")

    def test_a_box_is_the_file_that_export_writes(self):
        server = self.serve_grid()
        cells = server.get("/api/v1/grids/g").json()["grid"]["cells"]
        region = f"1,2,0,{cells[0] - 1},{cells[1]},{max(1, cells[2] - 2)}"
        for ending in ["npy", "vti", "vtr"]:
            self.run_ok("export", "g.tcell", "-o", f"box.{ending}", "--region", region)
            got = server.get(f"/api/v1/grids/g/box.{ending}?region={region}")
            self.assertEqual((got.status, got.body), (200, self.bytes(f"box.{ending}")))
        self.assertEqual(server.get("/api/v1/grids/g/box.raw").status, 404)
        self.assertEqual(server.get("/api/v1/grids/g/box.npy?region=0,0,0,0,1,1").status, 400)
        line = server.get("/api/v1/grids/g/line?from=-1e5,0,0&to=1e5,0,1e-3").json()
        self.assertAlmostEqual(line["length"], 2e5)
        for wrong in ["", "from=1,2,3", "from=1,2,3&to=1,2,3", "from=1,2,3&to=1,2", "from=1,2,nan&to=1,2,3", "from=1,2,3&to=1,2,inf", "from=1,2,3&to=1e20,2,3"]:
            self.assertEqual(server.get(f"/api/v1/grids/g/line?{wrong}").status, 400, wrong)

    def test_etags(self):
        server = self.serve_grid()
        tile = server.get(TILE + ".png")
        self.assertRegex(tile.headers["ETag"], r'^"[^"]+"$')
        self.assertEqual(tile.headers["Cache-Control"], "no-cache")
        for given in [tile.headers["ETag"], f'"other", {tile.headers["ETag"]}', "*"]:
            again = server.get(TILE + ".png", If_None_Match=given)
            self.assertEqual((again.status, again.body, again.headers["ETag"]), (304, b"", tile.headers["ETag"]))
        self.assertEqual(server.get(TILE + ".png", If_None_Match='"other"').status, 200)
        self.assertEqual(server.get(TILE + ".png", Range="bytes=0-3").status, 200)  # ranges are ignored
        version = server.get("/api/v1/grids/g").json()["file"]["hash"]
        self.assertIn("immutable", server.get(f"{TILE}.png?v={version}").headers["Cache-Control"])

    def test_errors_are_json(self):
        server = self.serve_grid()
        for status, method, path in [(404, "GET", "/nowhere"), (404, "GET", "/api/v1/grids/h"), (400, "GET", TILE + ".png?nonsense=1"),
                                     (405, "POST", "/"), (405, "DELETE", TILE + ".png"), (404, "GET", "/api/v1/grids/..%2Fg")]:
            answer = server.get(path, method)
            self.assertEqual(answer.status, status, (method, path))
            self.assertEqual(answer.headers["Content-Type"], "application/json")
            self.assertEqual(set(answer.json()["error"]), {"code", "message"})
        self.assertEqual(server.get("/", "PUT").headers["Allow"], "GET, HEAD, OPTIONS")

    def test_base_path_and_forwarded_headers(self):
        server = self.serve_grid("--base-path", "/base/")
        self.assertEqual(server.base, "/base/")
        self.assertEqual(server.get("/api/v1/grids").status, 404)
        self.assertEqual(server.get("/base/api/v1/grids").status, 200)
        for path in ["/", "/base"]:
            moved = server.get(path)
            self.assertEqual((moved.status, moved.headers["Location"]), (302, "/base/"))
        info = server.get("/base/iiif/g-z-5/info.json").json()
        self.assertEqual(info["id"], f"http://127.0.0.1:{server.port}/base/iiif/g-z-5")
        info = server.get("/base/iiif/g-z-5/info.json", X_Forwarded_Proto="https", X_Forwarded_Host="maps.example", X_Forwarded_Prefix="/sub").json()
        self.assertEqual(info["id"], "https://maps.example/sub/base/iiif/g-z-5")
        info = server.get("/base/iiif/g-z-5/info.json", X_Forwarded_Host="a\"<b", X_Forwarded_Prefix="//evil.example").json()
        self.assertEqual(info["id"], f"http://127.0.0.1:{server.port}/base/iiif/g-z-5")

    def test_what_only_pages_of_this_machine_may_read(self):
        server = self.serve_grid()
        for host in [f"127.0.0.1:{server.port}", f"localhost:{server.port}", "[::1]", "grids.localhost"]:
            self.assertEqual(server.get("/api/v1/grids", Host=host).status, 200, host)
        for path in ["/api/v1/grids", "/", "/healthz", TILE + ".png"]:
            refused = server.get(path, Host=f"evil.example:{server.port}")
            self.assertEqual((refused.status, refused.json()["error"]["code"]), (421, "misdirected"))
            self.assertRegex(refused.json()["error"]["message"], r"^Host: expected localhost.*found 'evil\.example:\d+'.*--allow-host NAME")
        for origin, given in [("https://evil.example", None), ("null", None), ("http://localhost:3000", "http://localhost:3000")]:
            for path in ["/api/v1/grids", "/nowhere"]:
                headers = server.get(path, Origin=origin).headers
                self.assertEqual((headers["Access-Control-Allow-Origin"], "Origin" in headers.get_all("Vary")), (given, True))
        got = server.raw(b"GET http://evil.example/api/v1/grids HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        self.assertTrue(got.startswith(b"HTTP/1.1 421 Misdirected Request\r\n"), got[:100])

    def test_hosts_and_origins_that_are_allowed(self):
        self.grid()
        self.token("s3cret")
        names = ["--allow-host", "a.example", "--allow-host", "b.example", "--allow-origin", "https://c.example", "--allow-origin", "http://d.example:81"]
        every = ["--allow-host", "*", "--allow-origin", "*"]
        for options, free in [(names, False), (every, True), (["--host", "0.0.0.0"], True), (["--token-file", "token"], True),
                              (["--token-file", "token", *names], False)]:
            server = self.serve(*options, "g.tcell")  # an option takes one value: the grid isn't a second one
            for host, status in [("a.example", 200), ("b.example:8080", 200), ("localhost", 200), ("other.example", 200 if free else 421)]:
                self.assertEqual(server.get("/healthz", Host=host).status, status, (options, host))
            for origin in ["https://c.example", "http://d.example:81", "http://127.0.0.1:5173", "https://other.example"]:
                expected = "*" if free else None if "other" in origin else origin
                headers = server.get("/api/v1/grids", Origin=origin).headers
                self.assertEqual(headers["Access-Control-Allow-Origin"], expected, (options, origin))
                self.assertEqual("Origin" in headers.get_all("Vary", []), not free)
            self.stop(server, problems=int("0.0.0.0" in options))

    def test_a_body_that_waits_for_leave(self):
        server = self.serve_grid()
        for method, status in [(b"GET", b"200"), (b"POST", b"405")]:
            got = server.raw(method + b" /healthz HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\nContent-Length: 5\r\n\r\n")
            self.assertTrue(got.startswith(b"HTTP/1.1 " + status), got[:100])

    def test_a_token(self):
        self.grid()
        self.token("s3cret \nsecond line\n")
        server = self.serve("g.tcell", "--token-file", "token")
        refused = server.get("/api/v1/grids")
        self.assertEqual((refused.status, refused.headers["WWW-Authenticate"].split()[0]), (401, "Bearer"))
        self.assertEqual(refused.headers["Cache-Control"], "no-store")
        for wrong in ["Bearer s3cre", "Bearer s3cret2", "Basic s3cret", "Bearer"]:
            self.assertEqual(server.get("/api/v1/grids", Authorization=wrong).status, 401)
        self.assertEqual(server.get("/api/v1/grids", Authorization="Bearer s3cret").status, 200)
        self.assertEqual(server.get("/healthz").status, 200)
        self.assertIn(b"three.js", server.get("/NOTICE").body)
        self.assertEqual(server.get("/metrics").status, 401)
        self.stop(server)
        self.assertNotIn("s3cret", "".join(server.lines))

    def test_a_folder_and_files_that_change(self):
        self.grid("g.tcell")
        server = self.serve(".")
        before = server.get(TILE + ".bin")
        version = server.get("/api/v1/grids/g").json()["file"]["hash"]
        self.grid("g.tcell", hi=(600, 30, 5))
        self.grid("new.tcell")
        self.write("broken.tcell", "nothing of a grid")
        self.wait_until(lambda: server.get(TILE + ".bin").headers["ETag"] != before.headers["ETag"], "the tile of the new file")
        self.assertEqual(server.get(f"{TILE}.bin?v={version}").status, 404)
        ids = lambda kind: [g["id"] for g in server.get("/api/v1/grids").json()[kind]]
        self.wait_until(lambda: (ids("grids"), ids("unreadable")) == (["g", "new"], ["broken"]), "the other new files")
        served = server.get("/api/v1/grids").json()
        self.assertRegex(served["unreadable"][0]["error"], r"^broken\.tcell: .*expected")
        self.assertRegex(server.problem(), r"^teracell: \./broken\.tcell: .*expected")
        self.stop(server, problems=1)

    def test_metrics(self):
        server = self.serve_grid()
        for _ in range(3):
            server.get(TILE + ".png")
        server.get("/nowhere")
        kept = server.connection()
        kept.request("GET", "/healthz")
        kept.getresponse().read()
        answer = server.get("/metrics")
        kept.close()
        self.assertTrue(answer.headers["Content-Type"].startswith("text/plain; version=0.0.4"))
        samples = {}
        for line in answer.body.decode().splitlines():
            if not line.startswith("#"):
                found = re.fullmatch(r'([a-z_]+(?:\{(?:[a-z]+="[^"\\]*",?)+\})?) ([0-9.e+-]+)', line)
                self.assertTrue(found, line)
                samples[found[1]] = float(found[2])
        self.assertEqual(sum(v for k, v in samples.items() if k.startswith("teracell_requests_total") and 'status="200"' in k and "tile" in k), 3)
        self.assertEqual(sum(v for k, v in samples.items() if k.startswith("teracell_requests_total") and 'status="404"' in k), 1)
        self.assertGreaterEqual(samples["teracell_connections"], 2)
        self.assertGreaterEqual(samples['teracell_cache_hits_total{cache="answers"}'], 2)
        self.assertGreater(samples['teracell_cache_bytes{cache="answers"}'], 0)
        self.assertEqual(sum(samples[f'teracell_cache_limit_bytes{{cache="{cache}"}}'] for cache in ("chunks", "index")), 256 << 20)
        self.assertGreater(samples["teracell_read_bytes_total"], 0)
        self.assertEqual(samples["teracell_damaged_total"], 0)
        self.assertEqual(samples["teracell_grids"], 1)
        self.assertGreater(samples["process_resident_memory_bytes"], 1e6)

    def test_the_log(self):
        server = self.serve_grid()
        server.get("/nowhere?a=b")
        self.assertRegex(server.log_line(), r"^\S+Z 127\.0\.0\.1 GET /nowhere\?a=b 404 \d+ \d+\.\d{3} \w+$")
        server.raw(b"GET /\xc2\x9b31m\xff\"\\ HTTP/1.0\r\n\r\n")
        self.assertRegex(server.log_line(), r"^\S+Z 127\.0\.0\.1 \S+ \S+ 40\d ")
        server.raw(b"\x1b[31m red\r\n\r\n")
        self.assertRegex(server.log_line(), r"^\S+Z 127\.0\.0\.1 \S+ \S+ 400 ")
        self.stop(server)
        for line in server.lines:
            self.assertTrue(all(" " <= c <= "~" for c in line), line)

        server = self.serve("g.tcell", "--log", "json")
        server.raw(b"GET /\xc2\x9b31m\"\\ HTTP/1.0\r\n\r\n")
        entry = json.loads(server.log_line())
        self.assertEqual((entry["client"], entry["bytes"] > 0), ("127.0.0.1", True))
        server.signal(15)
        self.assertEqual(server.wait(), 0)

        server = self.serve("g.tcell", "--log", "none")
        server.get("/")
        self.stop(server)
        self.assertEqual(server.lines, [])


class ServeUsage(ServeCase):
    def test_usage_that_is_refused(self):
        self.grid()
        self.write("empty", "\n")
        self.write("spaced", "a token")
        self.write("broken.tcell", "nothing of a grid")
        for phrases, args in [
            (["grids"], []),
            (["nowhere.tcell", "expected a .tcell file or a folder"], ["nowhere.tcell"]),
            (["teracell: --port: expected 0 to 65535, found '70000'"], ["g.tcell", "--port", "70000"]),
            (["teracell: --max-pixels: expected 1 to 1000000000000, found '0'"], ["g.tcell", "--max-pixels", "0"]),
            (["--base-path", "//evil"], ["g.tcell", "--base-path", "//evil"]),
            (["--log", "text, json, none", "xml"], ["g.tcell", "--log", "xml"]),
            (["--cache", "much"], ["g.tcell", "--cache", "much"]),
            (["--max-connections", "'0'"], ["g.tcell", "--max-connections", "0"]),
            (["--request-timeout", "'x'"], ["g.tcell", "--request-timeout", "x"]),
            (["--token-file empty", "first line", "an empty one"], ["g.tcell", "--token-file", "empty"]),
            (["--token-file spaced", "other characters"], ["g.tcell", "--token-file", "spaced"]),
            (["--allow-host: expected a host name without a port", "'h:80'"], ["g.tcell", "--allow-host", "h:80"]),
            (["--allow-origin: expected an origin", "'example.org'"], ["g.tcell", "--allow-origin", "example.org"]),
            (["--host", "expected an address"], ["g.tcell", "--host", ""]),
        ]:
            self.refused(2, phrases, "serve", *args)
        self.refused(1, ["--token-file nowhere: can't open: No such file"], "serve", "g.tcell", "--token-file", "nowhere")
        self.refused(1, ["--token-file .: expected a file, found a folder"], "serve", "g.tcell", "--token-file", ".")
        self.refused(1, ["teracell: broken.tcell: "], "serve", "broken.tcell")
        self.refused(1, [f"teracell: {self.path('broken.tcell')}: "], "serve", self.path("broken.tcell"))
        self.refused(1, ["--web nowhere", "index.html"], "serve", "g.tcell", "--web", "nowhere")
        self.refused(1, ["can't listen at 999.1.2.3", "--host"], "serve", "g.tcell", "--host", "999.1.2.3")
        self.refused(1, ["192.0.2.1"], "serve", "g.tcell", "--host", "192.0.2.1", "--port", "0")

    def test_a_port_in_use(self):
        server = self.serve_grid()
        self.refused(1, [f"port {server.port}", "Address already in use", "--port"], "serve", "g.tcell", "--port", server.port)

    def test_a_warning_beyond_loopback_without_a_token(self):
        self.grid()
        self.token("t")
        server = self.serve("g.tcell", "--host", "0.0.0.0")
        self.stop(server, problems=1)
        self.assertIn("warning", server.problems[0])
        self.assertIn("--token-file", server.problems[0])
        self.stop(self.serve("g.tcell", "--host", "0.0.0.0", "--token-file", "token"))
