"""A host of objects for tests. It answers as RFC 9110 says, or as hosts of strangers do: see Origin.mode."""
import hashlib
import hmac
import http.server
import re
import socket
import struct
import threading
import time
import urllib.parse

GOOD = "good"


class Origin:
    """`objects` are bytes by path. `mode` says what is wrong with the answers; `requests` are those that came, as (path, headers)."""

    def __init__(self, objects, mode=GOOD, delay=0.0, keys=None, host="127.0.0.1"):
        self.objects, self.mode, self.delay, self.keys, self.requests = dict(objects), mode, delay, keys, []
        self.lock, self.failures_left, self.sent = threading.Lock(), 0, 0
        origin = self

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"
            disable_nagle_algorithm = True

            def log_message(self, *_):
                pass

            def do_GET(self):
                origin.answer(self)

        class Server(http.server.ThreadingHTTPServer):
            request_queue_size = 64

            def handle_error(self, *_):
                pass  # clients that go away

        self.server = Server((host, 0), Handler)
        self.server.daemon_threads = True
        self.port = self.server.server_address[1]
        self.url = f"http://127.0.0.1:{self.port}"
        self.thread = threading.Thread(target=self.server.serve_forever, args=(0.02,), daemon=True)
        self.thread.start()

    def close(self):
        self.server.shutdown()
        self.server.server_close()
        self.thread.join()

    def answer(self, h):
        with self.lock:
            self.requests.append((h.path, dict(h.headers)))
            number = len(self.requests)
            failing = self.failures_left > 0
            self.failures_left -= failing
        if self.delay:
            time.sleep(self.delay)
        name = urllib.parse.unquote(urllib.parse.urlsplit(h.path).path)
        if self.keys and (wrong := wrong_signature(h, self.keys)):
            return send(h, 403, {}, f"<Error><Code>SignatureDoesNotMatch</Code><Message>{wrong}</Message></Error>".encode())
        body = self.objects.get(name)
        if body is None:
            return send(h, 404, {}, b"<html><h1>Not Found</h1>\x1b[31m" + b"there is nothing here " * 100 + b"</html>")
        mode = GOOD if self.mode in AFTER_THE_FIRST and number == 1 or self.mode in FOR_A_WHILE and not failing else self.mode
        wrong = getattr(self, "wrong_" + mode, None)
        if not wrong or wrong(h, name, body, number) is False:
            self.right(h, body, change=HEADERS.get(mode, lambda headers: None), send_body=BODIES.get(mode, lambda part: part))

    def right(self, h, body, first_etag=None, change=lambda headers: None, send_body=lambda part: part):
        etag = first_etag or f'"{hashlib.md5(body).hexdigest()}"'
        headers = {"ETag": etag, "Accept-Ranges": "bytes", "Last-Modified": "Thu, 01 Jan 2026 00:00:00 GMT"}
        if h.headers.get("If-Match", etag) != etag:
            return send(h, 412, {"ETag": etag}, b"")
        if h.headers.get("If-None-Match") == etag:
            return send(h, 304, headers, None)
        found = re.fullmatch(r"bytes=(\d*)-(\d*)", h.headers.get("Range", ""))
        if not found:
            change(headers)
            return send(h, 200, headers, send_body(body))
        first = max(0, len(body) - int(found[2])) if not found[1] else int(found[1])
        last = len(body) - 1 if not found[1] or not found[2] else min(int(found[2]), len(body) - 1)
        if first > last:
            return send(h, 416, {"Content-Range": f"bytes */{len(body)}"}, b"")
        headers["Content-Range"] = f"bytes {first}-{last}/{len(body)}"
        change(headers)
        part = body[first : last + 1]
        self.sent += len(part)
        send(h, 206, headers, send_body(part))

    # ---- What is wrong with the answers. Each of these answers, or returns False: then comes what is right.

    def wrong_no_suffix(self, h, name, body, number):
        if not h.headers.get("Range", "").startswith("bytes=-"):
            return False
        send(h, 416, {}, b"no such range")

    def wrong_suffix_whole(self, h, name, body, number):
        """Sends the whole object in place of its end, but more slowly than anybody waits for."""
        if not h.headers.get("Range", "").startswith("bytes=-"):
            return False
        h.send_response(200)
        h.send_header("ETag", f'"{hashlib.md5(body).hexdigest()}"')
        h.send_header("Content-Length", str(len(body)))
        h.end_headers()
        h.wfile.write(body[:1000])
        h.wfile.flush()
        h.connection.settimeout(30)
        h.connection.recv(1)  # until the client has gone
        h.close_connection = True

    def wrong_suffix_from_start(self, h, name, body, number):
        """Takes -100 for 0-100, as s3rver does."""
        if h.headers.get("Range", "").startswith("bytes=-"):
            h.headers.replace_header("Range", h.headers["Range"].replace("=-", "=0-"))
        return False

    def wrong_whole(self, h, name, body, number):
        del h.headers["Range"]
        return False

    wrong_whole_later = wrong_whole

    def wrong_etag(self, h, name, body, number):
        """The object changes after the first request, and If-Match is not heeded."""
        del h.headers["If-Match"]
        self.right(h, body, first_etag='"one"' if number == 1 else '"two"')

    def wrong_weak(self, h, name, body, number):
        self.right(h, body, first_etag='W/"weak"')

    def wrong_stall(self, h, name, body, number):
        h.send_response(206)
        h.send_header("Content-Length", "100000")
        h.end_headers()
        h.wfile.flush()
        time.sleep(30)
        h.close_connection = True

    def wrong_stall_later(self, h, name, body, number):
        return self.wrong_stall(h, name, body, number) if number >= self.after else False

    def wrong_cut(self, h, name, body, number):
        """Half of the body, then the end of the connection."""
        found = re.fullmatch(r"bytes=(\d+)-(\d+)", h.headers["Range"])
        first, last = int(found[1]), min(int(found[2]), len(body) - 1)
        h.send_response(206)
        h.send_header("ETag", f'"{hashlib.md5(body).hexdigest()}"')
        h.send_header("Content-Range", f"bytes {first}-{last}/{len(body)}")
        h.send_header("Content-Length", str(last - first + 1))
        h.end_headers()
        h.wfile.write(body[first : first + (last - first + 1) // 2])
        h.wfile.flush()
        h.close_connection = True

    def wrong_reset(self, h, name, body, number):
        h.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        h.connection.close()
        h.close_connection = True

    def wrong_busy(self, h, name, body, number):
        send(h, [500, 503, 429][number % 3], {}, b"SlowDown")

    def wrong_forbidden(self, h, name, body, number):
        send(h, 403, {}, b"<Error><Code>AccessDenied</Code><Message>Access Denied</Message></Error>")

    def wrong_forbidden_later(self, h, name, body, number):
        send(h, 403, {}, b"the token has expired")

    def wrong_ill_later(self, h, name, body, number):
        send(h, 503, {}, b"")

    def wrong_gone_later(self, h, name, body, number):
        """Nobody listens any more."""
        h.close_connection = True

    def wrong_circle(self, h, name, body, number):
        send(h, 302, {"Location": h.path}, b"")

    def wrong_long_redirect(self, h, name, body, number):
        """A redirect with a body that does not end."""
        if name != "/g.tcell":
            return False
        h.send_response(302)
        h.send_header("Location", "/there/g.tcell?signature=secret")
        h.send_header("Content-Length", str(10**12))
        h.end_headers()
        try:
            while True:
                h.wfile.write(b"moved " * 10000)
        except OSError:
            h.close_connection = True

    def wrong_headers(self, h, name, body, number):
        h.wfile.write(b"HTTP/1.1 206 Partial\r\n" + b"".join(b"x-%d: %s\r\n" % (i, b"a" * 100) for i in range(1000)))
        h.close_connection = True

    def wrong_echo(self, h, name, body, number):
        """Errors that repeat the request, as those of Amazon and of web frameworks do."""
        send(h, 403, {}, f"<Error><Code>InvalidToken</Code><Message>The token is malformed.</Message><Token-0>{h.headers.get('x-amz-security-token')}"
                         f"</Token-0></Error> Cannot GET {h.path} {h.headers}".encode())

    def wrong_elsewhere(self, h, name, body, number):
        """Sends clients to `self.target`, or to one of `self.targets` after the other."""
        if hasattr(self, "targets"):
            self.target = self.targets[min(number, len(self.targets)) - 1]
        send(h, 307, {"Location": self.target + h.path}, b"")


def other_total(headers):
    headers["Content-Range"] = re.sub(r"\d+$", lambda total: str(int(total[0]) + 1), headers["Content-Range"])


def other_range(headers):
    """Another range than was asked for, whose bytes have the right number."""
    first, last, total = map(int, re.findall(r"\d+", headers["Content-Range"]))
    headers["Content-Range"] = f"bytes {first - 1}-{last - 1}/{total}" if first else f"bytes 1-{last + 1}/{total}"


# Modes in which only the headers of answers are wrong, or only their bodies: what changes them. The length is that of the body that is sent.
HEADERS = {
    "total": other_total,
    "range": other_range,
    "no_content_range": lambda headers: headers.pop("Content-Range", None),
    "no_etag": lambda headers: headers.pop("ETag"),
    "no_version": lambda headers: (headers.pop("ETag"), headers.pop("Last-Modified")),
    "encoded": lambda headers: headers.update({"Content-Encoding": "gzip"}),
}
BODIES = {"short": lambda part: part[:-1], "long": lambda part: part + b"x", "other_bytes": lambda part: bytes(len(part))}
# Modes whose first answer is right, and those that are wrong as long as there are `failures_left`.
AFTER_THE_FIRST = {"total", "range", *BODIES, "whole_later", "stall", "cut", "forbidden_later", "ill_later", "gone_later"}
FOR_A_WHILE = {"reset", "busy"}


def send(h, status, headers, body):
    h.send_response(status)
    for name, value in headers.items():
        h.send_header(name, value)
    if body is not None:
        h.send_header("Content-Length", str(len(body)))
    h.end_headers()
    if body:
        try:
            h.wfile.write(body)
        except (BrokenPipeError, ConnectionResetError):
            h.close_connection = True


def wrong_signature(h, keys):
    """What is wrong with the signature of a request, by the text of AWS ("Authenticating Requests (AWS Signature Version 4)"); None: nothing.
    `keys` has key, secret, region and, if one must come, token."""
    found = re.fullmatch(r"AWS4-HMAC-SHA256 Credential=([^/]+)/(\d{8})/([^/]+)/s3/aws4_request, *SignedHeaders=([^,]+), *Signature=([0-9a-f]{64})",
                         h.headers.get("Authorization", ""))
    if not found:
        return "there is no signature"
    key, day, region, names, signature = found.groups()
    if (key, region) != (keys["key"], keys["region"]):
        return f"key {key}, region {region}"
    names = names.split(";")
    if names != sorted(names) or "host" not in names or "x-amz-date" not in names:
        return f"signed are {names}"
    if "x-amz-content-sha256" not in names:
        return "x-amz-content-sha256 is missing or not signed"
    if "token" in keys and ("x-amz-security-token" not in names or h.headers.get("x-amz-security-token") != keys["token"]):
        return "the token is missing or not signed"
    path = urllib.parse.urlsplit(h.path)
    canonical_path = "/".join(urllib.parse.quote(urllib.parse.unquote(part), safe="-._~") for part in path.path.split("/"))
    headers = "".join(f"{name}:{' '.join(h.headers[name].split())}\n" for name in names)
    content = h.headers["x-amz-content-sha256"]
    canonical = "\n".join(["GET", canonical_path, path.query, headers, ";".join(names), content])
    to_sign = "\n".join(["AWS4-HMAC-SHA256", h.headers["x-amz-date"], f"{day}/{region}/s3/aws4_request", hashlib.sha256(canonical.encode()).hexdigest()])
    secret = ("AWS4" + keys["secret"]).encode()
    for part in [day, region, "s3", "aws4_request", to_sign]:
        secret = hmac.new(secret, part.encode(), hashlib.sha256).digest()
    return None if secret.hex() == signature else f"the signature of {canonical!r}"
