"""nginx for a test, on free ports."""
import contextlib
import os
import shutil
import socket
import subprocess

from program import Case


def free_ports(count):
    with contextlib.ExitStack() as open_ones:
        sockets = [open_ones.enter_context(socket.socket()) for _ in range(count)]
        for s in sockets:
            s.bind(("127.0.0.1", 0))
        return [s.getsockname()[1] for s in sockets]


class NginxCase(Case):
    user = "user root;" if os.geteuid() == 0 else ""

    def certificate(self):
        """Writes cert.pem and key.pem, for localhost."""
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext",
                        "subjectAltName=DNS:localhost", "-keyout", self.path("key.pem"), "-out", self.path("cert.pem")], check=True, stderr=subprocess.DEVNULL)

    def configuration(self, http):
        """With what all need beside their section `http`."""
        folders = "".join(f"{kind}_temp_path {self.folder}/nginx-{kind};\n" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        return f"{self.user}\npid {self.folder}/nginx.pid;\nerror_log {self.folder}/nginx.log warn;\nevents {{}}\nhttp {{\naccess_log off;\n{folders}{http}\n}}\n"

    def start_nginx(self, configuration, port):
        """Until the end of the test. Returns when it listens at the port."""
        self.write("nginx.conf", configuration)
        program = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin")
        nginx = subprocess.Popen([program, "-e", self.path("nginx.log"), "-c", self.path("nginx.conf"), "-g", "daemon off;"])
        self.addCleanup(lambda: (nginx.terminate(), nginx.wait()))
        self.wait_for_port(port)
