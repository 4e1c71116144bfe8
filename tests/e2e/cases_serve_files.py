"""`teracell serve` with few descriptors and with token files, and what it does on a hangup."""
import fcntl
import os
import resource
import shutil
import signal
import termios
import time

from serving import ServeCase

CELL = "/api/v1/grids/{}/cell?i=1&j=1&k=1"


def few_descriptors(count):
    return lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (count, count))


class Descriptors(ServeCase):
    def test_too_few_are_refused_with_what_is_needed(self):
        self.grid()
        err = self.refused(1, ["expected a limit of at least", "found 8:", "ulimit -n", "LimitNOFILE"], "serve", "g.tcell", "--port", 0,
                           preexec_fn=few_descriptors(8))
        enough = int(err.split("at least ")[1].split()[0])
        server = self.serve("g.tcell", preexec_fn=few_descriptors(enough))
        self.assertEqual(server.get(CELL.format("g")).status, 200)
        self.assertIn("warning: at most 8 connections at once instead of 1024", server.problem())
        self.stop(server, problems=1)

    def test_more_grids_than_descriptors(self):
        self.grid()
        for i in range(150):
            shutil.copyfile(self.path("g.tcell"), self.path(f"g{i}.tcell"))
        server = self.serve(".", "--threads", 2, "--max-connections", 20, preexec_fn=few_descriptors(100))
        self.assertEqual(server.grids, 151)
        self.assertEqual(server.get("/api/v1/grids").json()["unreadable"], [])
        connection = server.connection()
        for i in range(150):
            connection.request("GET", CELL.format(f"g{i}"))
            response = connection.getresponse()
            self.assertEqual(response.status, 200, response.read())
            response.read()
            self.assertLessEqual(server.descriptors(), 100)
        connection.close()


class TokenFiles(ServeCase):
    def test_a_pipe_is_refused(self):
        self.grid()
        os.mkfifo(self.path("pipe"))
        self.refused(1, ["--token-file pipe: expected a file, found a device or a pipe"], "serve", "g.tcell", "--token-file", "pipe")

    def test_a_warning_when_others_can_read_the_token(self):
        self.grid()
        for mode in [0o644, 0o640]:
            server = self.serve("g.tcell", "--token-file", self.token("t", mode))
            self.assertIn("warning: --token-file token: other users", server.problem())
            self.stop(server, problems=1)
        self.stop(self.serve("g.tcell", "--token-file", self.token("t", 0o600)))


class Hangups(ServeCase):
    def test_a_hangup_makes_it_read_the_token_again(self):
        self.grid()
        self.token("first")
        server = self.serve("g.tcell", "--token-file", "token")
        status = lambda token: server.get("/api/v1/grids", Authorization=f"Bearer {token}").status
        self.assertEqual((status("first"), status("second")), (200, 401))
        self.token("second")
        server.signal(signal.SIGHUP)
        self.wait_until(lambda: status("second") == 200, "the new token")
        self.assertEqual(status("first"), 401)
        self.token("no token")
        server.signal(signal.SIGHUP)
        self.assertIn("warning: --token-file token: expected a first line", server.problem())
        self.assertEqual(status("second"), 200)
        self.stop(server, problems=1)

    def test_a_hangup_makes_it_look_anew(self):
        self.grid()
        server = self.serve(".")
        for number in [signal.SIGHUP, signal.SIGUSR1, signal.SIGHUP]:
            server.signal(number)
            time.sleep(0.2)
            self.assertEqual(server.get(CELL.format("g")).status, 200)
        self.grid("new.tcell")
        server.signal(signal.SIGHUP)
        self.wait_until(lambda: server.get(CELL.format("new")).status == 200, "the new grid")

    def test_it_ends_with_its_terminal_unless_hangups_were_ignored(self):
        self.grid()
        for ignored in [False, True]:
            ours, theirs = os.openpty()

            def take_terminal():
                if ignored:
                    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does
                os.setsid()
                fcntl.ioctl(theirs, termios.TIOCSCTTY, 0)

            server = self.serve("g.tcell", preexec_fn=take_terminal)
            server.signal(signal.SIGHUP)
            time.sleep(0.2)
            self.assertEqual(server.get(CELL.format("g")).status, 200)  # the terminal is still there
            os.close(theirs)
            os.close(ours)
            if ignored:
                time.sleep(0.5)
                self.assertEqual(server.get(CELL.format("g")).status, 200)
                self.stop(server)
            else:
                self.assertEqual(server.wait(), 0)
                self.assertEqual(server.problems, [])
