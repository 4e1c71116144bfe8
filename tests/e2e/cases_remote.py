"""Grids behind addresses: hosts that do as they should, and hosts that don't. Every command gives the cells of the file or says what is wrong."""
import hashlib
import math
import os
import shutil
import signal
import socket
import subprocess
import time

import solids
from nginx import NginxCase, free_ports
from origin import Origin
from program import PROGRAM, Case, teracell

KEYS = {"key": "AKIDEXAMPLE", "secret": "wJalrXUtnFEMI/K7MDENG+bPxRfiCYEXAMPLEKEY", "region": "eu-central-1"}
NO_KEYS = {k: v for k, v in os.environ.items() if not k.startswith("AWS_")}


def bumpy_ball(rows=40):
    """Facets whose cells take some hundred kilobytes."""
    def at(i, j):
        a, b = math.pi * i / rows, 2 * math.pi * (j % (2 * rows)) / (2 * rows)
        r = 20 + math.sin(9 * a) * math.cos(7 * b)
        return (r * math.sin(a) * math.cos(b), r * math.sin(a) * math.sin(b), r * math.cos(a))
    facets = []
    for i in range(rows):
        for j in range(2 * rows):
            p, q, r, s = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            facets += [(p, q, r)] * (i < rows - 1) + [(p, r, s)] * (i > 0)
    return facets


class RemoteCase(Case):
    def setUp(self):
        super().setUp()
        self.write("ball.stl", solids.binary_stl(bumpy_ball()))
        self.run_ok("mesh", "ball.stl", "--cells", 900, "-o", "g.tcell", "--progress", "none")
        self.file = self.bytes("g.tcell")

    def origin(self, mode="good", path="/g.tcell", body=None, **options):
        """A host of one object, which is the file or `body`."""
        origin = Origin({path: self.file if body is None else body}, mode, **options)
        self.addCleanup(origin.close)
        return origin

    def same_cells(self, address, *options, **run):
        """Compares what commands say of the address with what they say of the file, and what they write."""
        for command, *arguments in [["slice", "--axis", "z", "--index", "300", "-o", "out.npy"], ["export", "--level", "3", "-o", "out.npy"],
                                    ["slice", "--axis", "x", "--index", "200", "--level", "1", "-o", "out.png"],
                                    ["info", "--json"], ["column", "--axis", "z", "--at", "400,400", "--json"], ["stats", "--json"]]:
            found = []
            for grid, more, how in (("g.tcell", (), {}), (address, options, run)):
                found.append(self.run_ok(command, grid, *arguments, *more, **how).out)
                if "-o" in arguments:
                    found[-1] = self.bytes(arguments[-1])
                    os.remove(self.path(arguments[-1]))
            self.assertEqual(found[1], found[0], (command, arguments))
        self.assertIn("sound", self.run_ok("verify", address, *options, **run).out)

    def slice_fails(self, status, phrases, address, *options, **run):
        return self.refused(status, phrases, "slice", address, "--axis", "z", "--index", "300", "-o", "out.png", *options, **run)


class GoodHosts(RemoteCase):
    def test_every_command_gives_the_cells_of_the_file(self):
        self.same_cells(self.origin().url + "/g.tcell")

    def test_later_requests_name_the_version_of_the_first_answer(self):
        origin = self.origin()
        self.run_ok("verify", origin.url + "/g.tcell")
        first, *others = origin.requests
        self.assertNotIn("If-Match", first[1])
        self.assertTrue(others)
        for _, headers in others:
            self.assertEqual(headers["If-Match"], f'"{hashlib.md5(self.file).hexdigest()}"')

    def test_a_host_without_ranges_from_the_end(self):
        for mode in ["no_suffix", "suffix_from_start", "suffix_whole"]:
            self.same_cells(self.origin(mode).url + "/g.tcell")

    def test_a_small_object_of_a_host_without_ranges_is_taken_as_a_whole(self):
        origin = self.origin("whole")
        self.same_cells(origin.url + "/g.tcell")
        origin.requests.clear()
        self.run_ok("verify", origin.url + "/g.tcell")
        self.assertEqual(len(origin.requests), 2)  # the first one tells its size, and that the host counts no ranges from the end

    def test_weak_or_no_etags(self):
        for mode in ["weak", "no_etag"]:
            self.same_cells(self.origin(mode).url + "/g.tcell")

    def test_failures_that_pass(self):
        for mode in ["busy", "reset"]:
            origin = self.origin(mode)
            origin.failures_left = 3
            self.run_ok("verify", origin.url + "/g.tcell")
            self.assertEqual(origin.failures_left, 0)

    def test_redirects_are_followed_and_remembered(self):
        there, here = self.origin(), self.origin("elsewhere")
        here.target = there.url
        self.same_cells(here.url + "/g.tcell")
        here.requests.clear()
        self.run_ok("verify", here.url + "/g.tcell")
        self.assertEqual(len(here.requests), 1)

    def test_the_body_of_a_redirect_does_not_matter(self):
        origin = self.origin("long_redirect")
        origin.objects["/there/g.tcell"] = self.file
        self.run_ok("verify", origin.url + "/g.tcell")

    def test_where_a_redirect_led_is_given_up_when_it_fails(self):
        for mode in ["forbidden_later", "gone_later", "ill_later"]:
            first, second, here = self.origin(mode), self.origin(), self.origin("elsewhere")
            here.targets = [first.url, second.url]
            self.run_ok("verify", here.url + "/g.tcell")
            self.assertEqual(len(here.requests), 2)

    def test_messages_show_no_query(self):
        self.assertNotIn("secret", self.run_ok("verify", self.origin().url + "/g.tcell?signature=secret").out)

    def test_differences_from_a_grid_elsewhere(self):
        self.write("other.stl", solids.binary_stl(solids.box_facets((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))))
        grid = self.json_of("info", "g.tcell")["grid"]
        for scene, mesh in (("s.json", "ball.stl"), ("o.json", "other.stl")):
            self.write(scene, {"units": "m", "grid": {key: grid[key] for key in ("min", "max", "cells")}, "materials": {"ball": {}},
                               "bodies": [{"mesh": mesh, "material": "ball"}]})
        self.run_ok("mesh", "s.json", "--axis", "z", "-o", "s.tcell")
        self.file = self.bytes("s.tcell")
        for axis in "zx":
            self.run_ok("mesh", "o.json", "--axis", axis, "-o", "o.tcell")
            expected = self.json_of("diff", "s.tcell", "o.tcell")
            self.assertNotEqual(expected["changes"], [])
            origin = self.origin()
            self.assertEqual(self.json_of("diff", origin.url + "/g.tcell", "o.tcell"), expected)
            self.assertLess(len(origin.requests), 40)
            back = self.json_of("diff", "o.tcell", self.origin().url + "/g.tcell")
            self.assertEqual({(c["to"], c["from"]): c["cells"] for c in back["changes"]},
                             {(c["from"], c["to"]): c["cells"] for c in expected["changes"]})


class Packed(RemoteCase):
    def test_the_same_cells_in_few_requests(self):
        self.run_ok("pack", "g.tcell", "-o", "p.tcell")
        self.run_ok("verify", "p.tcell")
        self.assertEqual(self.export("p.tcell", "--level", "1"), self.export("g.tcell", "--level", "1"))
        self.assertEqual(self.json_of("stats", "p.tcell"), self.json_of("stats", "g.tcell"))
        self.refused(2, "would be overwritten", "pack", "g.tcell", "-o", "g.tcell")
        packed = self.origin(path="/p.tcell", body=self.bytes("p.tcell"))
        for level, tile in [("0", "0,0,512,512"), ("0", "512,512,890,890"), ("1", "0,0,256,256"), ("2", "0,0,200,200"), ("5", "0,0,10,10")]:
            for axis in "xyz":
                packed.requests.clear()
                self.run_ok("slice", packed.url + "/p.tcell", "--axis", axis, "--index", "10", "--level", level, "--region", tile, "-o", "out.png")
                self.assertLessEqual(len(packed.requests), 4, (axis, level, tile))
        self.run_ok("pack", self.origin().url + "/g.tcell", "-o", "q.tcell")
        self.assertEqual(self.bytes("q.tcell"), self.bytes("p.tcell"))


class HostileHosts(RemoteCase):
    def fails(self, mode, phrases, *options, **more):
        origin = self.origin(mode, **more)
        return self.slice_fails(1, phrases, origin.url + "/g.tcell", *options)

    def test_lies(self):
        self.fails("total", "changed while it was read")
        self.fails("range", ["asked for bytes", "as its Content-Range"])
        self.fails("no_content_range", "Content-Range")
        self.fails("short", ["expected", "bytes, the host sent"])
        self.fails("long", "the host sent more")
        self.fails("other_bytes", "does not start with a teracell header")
        self.fails("encoded", "encoded as 'gzip'")
        self.fails("no_version", "neither ETag nor Last-Modified")

    def test_an_object_that_is_replaced(self):
        self.fails("etag", ["/g.tcell", "changed while it was read"])
        origin = self.origin()
        other = self.file[:-200] + bytes(200)
        right = origin.right

        def replaced(h, body, **options):
            right(h, body, **options)
            origin.objects["/g.tcell"] = other
        origin.right = replaced
        self.slice_fails(1, "changed while it was read", origin.url + "/g.tcell")

    def test_a_host_that_ignores_ranges(self):
        self.fails("whole_later", "the host ignores ranges")
        origin = self.origin("whole", body=self.file + bytes(20 << 20))
        self.slice_fails(1, "the host ignores ranges", origin.url + "/g.tcell")

    def test_stalls_and_cuts(self):
        began = time.monotonic()
        self.fails("stall", "/g.tcell", "--address-timeout", "1")
        self.assertLess(time.monotonic() - began, 60)
        self.fails("cut", "/g.tcell")
        origin = self.origin("busy")
        origin.failures_left = 1000
        self.slice_fails(1, ["status", "SlowDown"], origin.url + "/g.tcell")

    def test_an_interrupt_ends_a_stall(self):
        origin = self.origin("stall")
        export = ["export", origin.url + "/g.tcell", "--level", "1", "-o", "out.npy"]
        p = subprocess.Popen([PROGRAM, *export], cwd=self.folder)
        self.wait_until(lambda: len(origin.requests) >= 2, "a second request")
        p.send_signal(signal.SIGINT)
        self.assertEqual(p.wait(timeout=10), -signal.SIGINT)  # nothing watches for it while the grid is opened
        origin.mode, origin.after = "stall_later", 3
        origin.requests.clear()
        self.interrupt(export, lambda _: len(origin.requests) >= 3)
        self.assertGreaterEqual(len(origin.requests), 3)

    def test_refusals_are_told_with_the_words_of_the_host(self):
        self.fails("forbidden", ["status 403", "AccessDenied", "Access Denied"])
        self.fails("forbidden_later", ["status 403", "the token has expired"])
        origin = self.origin()
        said = self.slice_fails(1, ["status 404", "Not Found"], origin.url + "/h.tcell")
        self.assertLess(len(said), 500)
        self.assertNotIn("\x1b", said)

    def test_too_many_headers(self):
        self.fails("headers", "headers of more than 64 kB")

    def test_errors_that_repeat_the_request_show_no_secrets(self):
        origin = self.origin("echo")
        said = self.slice_fails(1, ["status 403: InvalidToken The token is malformed."], origin.url + "/g.tcell?signature=secret")
        self.assertNotIn("secret", said)
        said = self.slice_fails(1, ["status 403: InvalidToken The token is malformed."], "s3://bucket/g.tcell", "--endpoint", self.origin("echo", "/bucket/g.tcell").url,
                                env=dict(NO_KEYS, AWS_ACCESS_KEY_ID="hidden-id", AWS_SECRET_ACCESS_KEY="hidden-key", AWS_SESSION_TOKEN="hidden-token"))
        self.assertNotIn("hidden", said)
        here = self.origin("elsewhere")
        here.target = origin.url + "/signature-follows?signature=secret&at="
        self.assertNotIn("secret", self.slice_fails(1, "status", here.url + "/g.tcell"))

    def test_what_is_not_an_address_shows_no_password(self):
        for address in ["https://me:secret@ho st/g.tcell", "https://me:secret@host:99999999/g.tcell", "https://me:secret@[::x/g.tcell"]:
            self.assertNotIn("secret", self.slice_fails(2, "not an address", address))
            self.assertNotIn("secret", self.slice_fails(2, "not an address", "s3://bucket/key", "--endpoint", address))
        proxy = dict(NO_KEYS, https_proxy="http://me:secret@ho st")
        self.assertNotIn("secret", self.slice_fails(1, "proxy", "https://grids.invalid/g.tcell", env=proxy))

    def test_redirects(self):
        self.fails("circle", "redirects more than 5 times")
        origin = self.origin("elsewhere")
        origin.target = "http://192.0.2.1"
        self.slice_fails(1, ["the host sends us elsewhere: http://192.0.2.1/", "--allow-http"], origin.url + "/g.tcell")
        origin.target = "file://"
        self.slice_fails(1, "the host sends us elsewhere: file:", origin.url + "/g.tcell")

    def test_nobody_listens(self):
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            self.slice_fails(1, f"127.0.0.1:{s.getsockname()[1]}", f"http://127.0.0.1:{s.getsockname()[1]}/g.tcell")

    def test_addresses_that_are_refused(self):
        self.slice_fails(2, ["https://", "--allow-http"], "http://192.0.2.1/g.tcell")
        self.slice_fails(2, "a name and a password", "https://me:secret@localhost/g.tcell")
        self.slice_fails(2, ["ftp://", "https"], "ftp://localhost/g.tcell")
        self.slice_fails(2, "s3://bucket/key", "s3://bucket")


class Folders(RemoteCase):
    def test_a_second_run_reads_from_the_folder(self):
        origin = self.origin()
        self.same_cells(origin.url + "/g.tcell", "--cache-dir", "kept")
        origin.sent = 0
        self.same_cells(origin.url + "/g.tcell", "--cache-dir", "kept")
        self.assertLess(origin.sent, 7 * min(len(self.file), 65536) + 1)  # the end of the file, which tells its version

    def test_damaged_blocks_are_fetched_again(self):
        origin = self.origin()
        self.same_cells(origin.url + "/g.tcell", "--cache-dir", "kept")
        damaged = 0
        for name in os.listdir(self.path("kept")):
            with open(self.path("kept/" + name), "r+b") as f:
                data = bytearray(f.read())
                for at in range(1000, len(data), 5000):
                    data[at] ^= 1
                    damaged += 1
                f.seek(0)
                f.write(data)
        self.assertGreater(damaged, 0)
        self.same_cells(origin.url + "/g.tcell", "--cache-dir", "kept")

    def test_another_version_is_another_object(self):
        origin = self.origin()
        self.same_cells(origin.url + "/g.tcell", "--cache-dir", "kept")
        self.run_ok("mesh", "ball.stl", "--cells", 600, "-o", "g.tcell", "--progress", "none")
        origin.objects["/g.tcell"] = self.bytes("g.tcell")
        self.same_cells(origin.url + "/g.tcell", "--cache-dir", "kept")

    def test_the_folder_is_bounded_and_other_files_in_it_stay(self):
        origin = self.origin()
        os.mkdir(self.path("kept"))
        self.write("kept/mine.txt", "mine")
        for i in range(4):
            origin.objects[f"/{i}.tcell"] = self.file
            self.run_ok("verify", origin.url + f"/{i}.tcell", "--cache-dir", "kept", "--cache-dir-size", "100K")
        names = os.listdir(self.path("kept"))
        self.assertIn("mine.txt", names)
        self.assertLess(sum(os.stat(self.path("kept/" + n)).st_blocks * 512 for n in names), 250_000 + len(self.file) // 4)

    def test_several_processes_share_a_folder(self):
        origin = self.origin()
        address = origin.url + "/g.tcell"
        running = [subprocess.Popen([PROGRAM, "verify", address, "--cache-dir", "kept"], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE) for _ in range(4)]
        for p in running:
            out, err = p.communicate(timeout=120)
            self.assertEqual(p.returncode, 0, err)
        self.same_cells(address, "--cache-dir", "kept")

    def test_what_lies_there_under_the_names_of_its_files(self):
        address = self.origin().url + "/g.tcell"
        for put in [os.mkfifo, os.mkdir, lambda path: os.symlink(self.path("ball.stl"), path)]:
            self.run_ok("verify", address, "--cache-dir", "kept")
            for name in os.listdir(self.path("kept")):
                os.remove(self.path("kept/" + name))
                put(self.path("kept/" + name))
            self.same_cells(address, "--cache-dir", "kept")
            shutil.rmtree(self.path("kept"))

    def test_a_folder_that_can_not_be_made(self):
        self.write("file", "")
        self.slice_fails(1, "file/kept", self.origin().url + "/g.tcell", "--cache-dir", "file/kept")


class Buckets(RemoteCase):
    def environment(self, **more):
        return dict(NO_KEYS, AWS_ACCESS_KEY_ID=KEYS["key"], AWS_SECRET_ACCESS_KEY=KEYS["secret"], AWS_REGION=KEYS["region"], **more)

    def bucket(self, key="g.tcell", keys=KEYS):
        return self.origin(path=f"/bucket/{key}", keys=keys)

    def test_requests_are_signed(self):
        origin = self.bucket()
        self.same_cells("s3://bucket/g.tcell", "--endpoint", origin.url, env=self.environment())

    def test_keys_with_all_kinds_of_characters(self):
        for key in ["a b+c&d=e/~x_.-(1)!'*,;:@$.tcell", "über/100%/g?x#y.tcell", "a//b.tcell", "p/./q/../r.tcell"]:
            origin = self.bucket(key)
            r = teracell("verify", f"s3://bucket/{key}", "--endpoint", origin.url, cwd=self.folder, env=self.environment())
            if "/../" not in key or "path-as-is" not in r.err:  # libcurl 8.13 and newer: what it does not sign, it refuses
                self.assertEqual(r.status, 0, f"{r.args}: {r.err}")

    def test_tokens_of_sessions(self):
        origin = self.bucket(keys=dict(KEYS, token="AQoDYXdzEJr/EXAMPLE+token=="))
        self.run_ok("verify", "s3://bucket/g.tcell", "--endpoint", origin.url, env=self.environment(AWS_SESSION_TOKEN="AQoDYXdzEJr/EXAMPLE+token=="))
        self.slice_fails(1, "status 403", "s3://bucket/g.tcell", "--endpoint", origin.url, env=self.environment(AWS_SESSION_TOKEN="another"))

    def test_without_keys_requests_are_not_signed(self):
        origin = self.bucket(keys=None)
        self.run_ok("verify", "s3://bucket/g.tcell", "--endpoint", origin.url, env=NO_KEYS)
        self.assertFalse(any("Authorization" in headers for _, headers in origin.requests))
        self.slice_fails(1, ["status 403", "AWS_ACCESS_KEY_ID"], "s3://bucket/g.tcell", "--endpoint", self.bucket().url, env=NO_KEYS)

    def test_other_hosts_get_no_signature(self):
        there = self.origin(path="/bucket/g.tcell")
        here = self.bucket()
        here.mode, here.target = "elsewhere", there.url
        self.run_ok("verify", "s3://bucket/g.tcell", "--endpoint", here.url, env=self.environment(AWS_SESSION_TOKEN="token"))
        self.assertTrue(all("Authorization" in headers for _, headers in here.requests))
        for _, headers in there.requests:
            self.assertFalse({"authorization", "x-amz-security-token"} & {name.lower() for name in headers})


class NginxHost(RemoteCase, NginxCase):
    def test_a_file_behind_nginx(self):
        port, tls = free_ports(2)
        os.mkdir(self.path("served"))
        shutil.copy(self.path("g.tcell"), self.path("served"))
        os.chmod(self.folder, 0o755)
        self.certificate()
        self.start_nginx(self.configuration(f"""server {{
            listen 127.0.0.1:{port};
            listen 127.0.0.1:{tls} ssl;
            ssl_certificate {self.folder}/cert.pem;
            ssl_certificate_key {self.folder}/key.pem;
            root {self.folder}/served;
            location /down/ {{ return 302 http://localhost:{port}/g.tcell; }}
            location /up/ {{ return 302 https://localhost:{tls}/g.tcell; }}
        }}"""), port)
        self.same_cells(f"http://127.0.0.1:{port}/g.tcell")
        trusting = dict(NO_KEYS, CURL_CA_BUNDLE=self.path("cert.pem"))
        self.same_cells(f"https://localhost:{tls}/g.tcell", env=trusting)
        self.run_ok("verify", f"http://localhost:{port}/up/g.tcell", env=trusting)
        self.slice_fails(1, "expected to stay at an https:// address", f"https://localhost:{tls}/down/g.tcell", env=trusting)
        self.slice_fails(1, "certificate", f"https://localhost:{tls}/g.tcell", env=NO_KEYS)
