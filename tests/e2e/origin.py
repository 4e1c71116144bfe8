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
        wrong = getattr(self, "wrong_" + self.mode, None)
        if wrong and wrong(h, name, body, number, failing):
            return
        self.right(h, body)

    def right(self, h, body, first_etag=None, change=lambda headers: None, send_body=None):
        etag = first_etag or f'"{hashlib.md5(body).hexdigest()}"'
        headers = {"ETag": etag, "Accept-Ranges": "bytes", "Last-Modified": "Thu, 01 Jan 2026 00:00:00 GMT"}
        if h.headers.get("If-Match", etag) != etag:
            return send(h, 412, {"ETag": etag}, b"")
        if h.headers.get("If-None-Match") == etag:
            return send(h, 304, headers, None)
        found = re.fullmatch(r"bytes=(\d*)-(\d*)", h.headers.get("Range", ""))
        if not found:
            change(headers)
            return send(h, 200, headers, body if send_body is None else send_body)
        first = max(0, len(body) - int(found[2])) if not found[1] else int(found[1])
        last = len(body) - 1 if not found[1] or not found[2] else min(int(found[2]), len(body) - 1)
        if first > last:
            return send(h, 416, {"Content-Range": f"bytes */{len(body)}"}, b"")
        headers["Content-Range"] = f"bytes {first}-{last}/{len(body)}"
        change(headers)
        part = body[first : last + 1]
        self.sent += len(part)
        send(h, 206, headers, part if send_body is None else send_body(part))

    # ---- What is wrong with the answers. Each of these returns whether it has answered.

    def wrong_total(self, h, name, body, number, failing):
        def change(headers):
            if number > 1:
                headers["Content-Range"] = headers["Content-Range"].split("/")[0] + f"/{len(body) + 1}"
        self.right(h, body, change=change)
        return True

    def wrong_range(self, h, name, body, number, failing):
        """Another range than was asked for, whose bytes have the right number."""
        def change(headers):
            first, last, total = map(int, re.findall(r"\d+", headers["Content-Range"]))
            headers["Content-Range"] = f"bytes {first - 1}-{last - 1}/{total}" if first else f"bytes 1-{last + 1}/{total}"
        self.right(h, body, change=change if number > 1 else lambda headers: None)
        return True

    def wrong_no_content_range(self, h, name, body, number, failing):
        self.right(h, body, change=lambda headers: headers.pop("Content-Range", None))
        return True

    def wrong_short(self, h, name, body, number, failing):
        """Fewer bytes than Content-Range says, with the Content-Length of what is sent."""
        self.right(h, body, send_body=lambda part: part[:-1] if number > 1 else part)
        return True

    def wrong_long(self, h, name, body, number, failing):
        self.right(h, body, send_body=lambda part: part + b"x" if number > 1 else part)
        return True

    def wrong_other_bytes(self, h, name, body, number, failing):
        self.right(h, body, send_body=lambda part: bytes(len(part)) if number > 1 else part)
        return True

    def wrong_whole(self, h, name, body, number, failing):
        del h.headers["Range"]
        self.right(h, body)
        return True

    def wrong_whole_later(self, h, name, body, number, failing):
        if number > 1:
            del h.headers["Range"]
        self.right(h, body)
        return True

    def wrong_no_suffix(self, h, name, body, number, failing):
        if h.headers.get("Range", "").startswith("bytes=-"):
            send(h, 416, {}, b"no such range")
            return True
        return False

    def wrong_suffix_from_start(self, h, name, body, number, failing):
        """Takes -100 for 0-100, as s3rver does."""
        if h.headers.get("Range", "").startswith("bytes=-"):
            h.headers.replace_header("Range", h.headers["Range"].replace("=-", "=0-"))
        self.right(h, body)
        return True

    def wrong_etag(self, h, name, body, number, failing):
        """The object changes after the first request, and If-Match is not heeded."""
        del h.headers["If-Match"]
        self.right(h, body, first_etag='"one"' if number == 1 else '"two"')
        return True

    def wrong_weak(self, h, name, body, number, failing):
        self.right(h, body, first_etag='W/"weak"')
        return True

    def wrong_no_etag(self, h, name, body, number, failing):
        self.right(h, body, change=lambda headers: headers.pop("ETag"))
        return True

    def wrong_no_version(self, h, name, body, number, failing):
        self.right(h, body, change=lambda headers: (headers.pop("ETag"), headers.pop("Last-Modified")))
        return True

    def wrong_encoded(self, h, name, body, number, failing):
        self.right(h, body, change=lambda headers: headers.update({"Content-Encoding": "gzip"}))
        return True

    def wrong_stall(self, h, name, body, number, failing):
        if number > 1:
            h.send_response(206)
            h.send_header("Content-Length", "100000")
            h.end_headers()
            h.wfile.flush()
            time.sleep(30)
            h.close_connection = True
            return True
        return False

    def wrong_stall_later(self, h, name, body, number, failing):
        return number >= self.after and self.wrong_stall(h, name, body, number, failing)

    def wrong_cut(self, h, name, body, number, failing):
        """Half of the body, then the end of the connection."""
        if number > 1:
            cut(h, body)
            return True
        return False

    def wrong_reset(self, h, name, body, number, failing):
        if failing:
            h.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            h.connection.close()
            h.close_connection = True
        return failing

    def wrong_busy(self, h, name, body, number, failing):
        if failing:
            send(h, [500, 503, 429][number % 3], {}, b"SlowDown")
        return failing

    def wrong_forbidden(self, h, name, body, number, failing):
        send(h, 403, {}, b"<Error><Code>AccessDenied</Code><Message>Access Denied</Message></Error>")
        return True

    def wrong_forbidden_later(self, h, name, body, number, failing):
        if number > 1:
            send(h, 403, {}, b"the token has expired")
        return number > 1

    def wrong_ill_later(self, h, name, body, number, failing):
        if number > 1:
            send(h, 503, {}, b"")
        return number > 1

    def wrong_gone_later(self, h, name, body, number, failing):
        """Nobody listens any more."""
        if number > 1:
            h.close_connection = True
        return number > 1

    def wrong_circle(self, h, name, body, number, failing):
        send(h, 302, {"Location": h.path}, b"")
        return True

    def wrong_long_redirect(self, h, name, body, number, failing):
        """A redirect with a body that does not end."""
        if name == "/g.tcell":
            h.send_response(302)
            h.send_header("Location", "/there/g.tcell?signature=secret")
            h.send_header("Content-Length", str(10**12))
            h.end_headers()
            try:
                while True:
                    h.wfile.write(b"moved " * 10000)
            except OSError:
                h.close_connection = True
            return True
        return False

    def wrong_headers(self, h, name, body, number, failing):
        h.wfile.write(b"HTTP/1.1 206 Partial\r\n" + b"".join(b"x-%d: %s\r\n" % (i, b"a" * 100) for i in range(1000)))
        h.close_connection = True
        return True

    def wrong_echo(self, h, name, body, number, failing):
        """Errors that repeat the request, as those of Amazon and of web frameworks do."""
        send(h, 403, {}, f"<Error><Code>InvalidToken</Code><Message>The token is malformed.</Message><Token-0>{h.headers.get('x-amz-security-token')}"
                         f"</Token-0></Error> Cannot GET {h.path} {h.headers}".encode())
        return True

    def wrong_elsewhere(self, h, name, body, number, failing):
        """Sends clients to `self.target`, or to one of `self.targets` after the other."""
        if hasattr(self, "targets"):
            self.target = self.targets[min(number, len(self.targets)) - 1]
        send(h, 307, {"Location": self.target + h.path}, b"")
        return True


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


def cut(h, body):
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
