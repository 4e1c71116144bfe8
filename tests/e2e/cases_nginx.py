"""nginx in front of the server: TLS, HTTP/2, a base path, and a cache."""
import os
import pathlib
import subprocess

from nginx import NginxCase, free_ports
from serving import ServeCase

RECIPE = pathlib.Path(__file__).with_name("nginx.conf.in")


class Nginx(ServeCase, NginxCase):
    def front(self, server):
        """Starts nginx and returns its port."""
        port, self.plain = free_ports(2)
        self.certificate()
        text = RECIPE.read_text()
        for word, value in {"USER": self.user, "FOLDER": self.folder, "UPSTREAM": server.port, "PORT": port, "PLAIN": self.plain}.items():
            text = text.replace(f"@{word}@", str(value))
        self.start_nginx(text, port)
        return port

    def curl(self, port, path, *args):
        """Returns (HTTP version, status, headers, body)."""
        done = subprocess.run(["curl", "-sS", "--http2", "--max-time", "30", "--cacert", self.path("cert.pem"), "-D", self.path("head"), "-o", self.path("body"), "-w",
                               "%{http_version} %{http_code}", *args, f"https://localhost:{port}{path}"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = [line.split(": ", 1) for line in self.bytes("head").decode().splitlines() if ": " in line]
        version, status = done.stdout.split()
        return version, int(status), {k.lower(): v for k, v in lines}, self.bytes("body") if os.path.exists(self.path("body")) else b""

    def test_no_spelling_of_a_version_puts_a_304_into_the_cache(self):
        server = self.serve_grid()
        port = self.front(server)
        tile = "/grids/api/v1/grids/g/tile/z/5/0/0_0.png"
        version = server.get("/api/v1/grids/g").json()["file"]["hash"]
        body = server.get("/api/v1/grids/g/tile/z/5/0/0_0.png").body
        for query in [f"v={version}", f"%76={version}", f"v=%{ord(version[0]):x}{version[1:]}"]:
            self.assertEqual(self.curl(port, f"{tile}?{query}", "-H", "If-None-Match: *")[1], 304)
            for _ in range(2):
                _, status, headers, got = self.curl(port, f"{tile}?{query}")
                self.assertEqual((status, got), (200, body), query)
            self.assertEqual(headers["x-cache"], "HIT")
            self.assertEqual(self.curl(port, f"{tile}?{query}", "-H", "If-None-Match: *")[1], 304)

    def test_schemes_and_hosts_that_run_together(self):
        server = self.serve_grid("--allow-host", "*")
        port = self.front(server)
        tile = f"/grids/api/v1/grids/g/tile/z/5/0/0_0.png?v={server.get('/api/v1/grids/g').json()['file']['hash']}"
        plain = f"http://localhost:{self.plain}{tile}"
        for expected in ["MISS", "HIT"]:  # "http" + "s.example"
            done = subprocess.run(["curl", "-sS", "-D-", "-o", self.path("body"), "-HHost: s.example", plain], stdout=subprocess.PIPE, check=True, text=True)
            self.assertIn(f"X-Cache: {expected}", done.stdout)
        self.assertEqual(self.curl(port, tile, "-HHost: .example")[2]["x-cache"], "MISS")  # "https" + ".example"

    def test_a_tile_comes_through_and_then_from_the_cache(self):
        server = self.serve_grid()
        port = self.front(server)
        direct = server.get("/api/v1/grids/g/tile/z/5/0/0_0.png")
        info = server.get("/api/v1/grids/g").json()
        tile = "/grids/api/v1/grids/g/tile/z/5/0/0_0.png"
        for expected in ["MISS", "HIT", "HIT"]:
            version, status, headers, body = self.curl(port, f"{tile}?v={info['file']['hash']}")
            self.assertEqual((version, status, headers["x-cache"], body), ("2", 200, expected, direct.body))
            self.assertEqual((headers["etag"], headers.get("access-control-allow-origin")), (direct.headers["ETag"], None))
        for _ in range(2):  # without a version, nginx asks the server each time
            _, status, headers, body = self.curl(port, tile)
            self.assertEqual((status, headers["x-cache"], body), (200, "MISS", direct.body))
        _, status, _, _ = self.curl(port, tile, "-H", f"If-None-Match: {direct.headers['ETag']}")
        self.assertEqual(status, 304)
        _, status, _, body = self.curl(port, "/grids/iiif/g-z-5/info.json")
        self.assertIn(f'"https://localhost:{port}/grids/iiif/g-z-5"'.encode(), body.replace(b" ", b""))
        self.assertEqual(self.curl(port, "/grids/healthz", "-X", "OPTIONS")[1], 204)
        self.assertEqual(self.curl(port, "/grids/api/v1/grids/nobody")[1], 404)
