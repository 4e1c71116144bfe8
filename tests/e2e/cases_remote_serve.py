"""`teracell serve` with grids behind addresses."""
import threading

from cases_remote import RemoteCase
from nginx import NginxCase, free_ports
from serving import ServeCase

PATHS = ["slice/z/300.png", "slice/x/100.png?level=2", "tile/y/200/1/0_0.png", "column/z/400_400", "stats", "cell?i=1&j=2&k=3"]


class RemoteServing(ServeCase, RemoteCase, NginxCase):
    def test_the_same_answers_and_etags_as_from_the_file(self):
        origin = self.origin()
        server, local = self.serve(origin.url + "/g.tcell?signature=secret"), self.serve("g.tcell")
        self.assertEqual(server.get("/api/v1/grids").json()["grids"][0]["id"], "g")
        for path in PATHS:
            ours, theirs = server.get("/api/v1/grids/g/" + path), local.get("/api/v1/grids/g/" + path)
            self.assertEqual((ours.status, ours.body, ours.headers["ETag"]), (200, theirs.body, theirs.headers["ETag"]), path)
        self.assertNotIn("secret", server.get("/").body.decode() + server.get("/api/v1/grids").body.decode())

    def test_a_replaced_object_is_noticed_by_what_is_read_and_by_asking(self):
        self.run_ok("mesh", "ball.stl", "--cells", 800, "-o", "h.tcell", "--progress", "none")
        origin = self.origin()
        server, local = self.serve(origin.url + "/g.tcell", "--recheck", "3600"), self.serve("h.tcell")
        path = "/api/v1/grids/{}/column/z/10_10"
        before = server.get(path.format("g"))
        self.assertEqual(before.status, 200)
        origin.objects["/g.tcell"] = self.bytes("h.tcell")
        self.assertEqual(server.get(path.format("g")).body, before.body)  # from memory
        after = local.get("/api/v1/grids/h/slice/z/300.png")
        self.assertEqual(server.get("/api/v1/grids/g/slice/z/300.png").body, after.body)  # has to be read
        self.assertEqual(server.get(path.format("g")).body, local.get(path.format("h")).body)
        quick = self.serve(origin.url + "/g.tcell", "--recheck", "1")
        self.assertEqual(quick.get(path.format("g")).body, local.get(path.format("h")).body)
        origin.objects["/g.tcell"] = self.file
        self.wait_until(lambda: quick.get(path.format("g")).body == before.body, "the former cells")

    def test_an_address_that_leads_to_a_newer_object_is_noticed(self):
        self.run_ok("mesh", "ball.stl", "--cells", 800, "-o", "h.tcell", "--progress", "none")
        there, here = self.origin(), self.origin("elsewhere")
        there.objects["/new/g.tcell"] = self.bytes("h.tcell")
        here.target = there.url
        server, local = self.serve(here.url + "/g.tcell", "--recheck", "1"), self.serve("h.tcell")
        here.target = there.url + "/new"
        path, expected = "/api/v1/grids/{}/column/z/10_10", local.get("/api/v1/grids/h/column/z/10_10").body
        self.wait_until(lambda: server.get(path.format("g")).body == expected, "the cells of the newer object")

    def test_a_host_that_goes_away_and_comes_back(self):
        origin = self.origin()
        server = self.serve(origin.url + "/g.tcell", "--recheck", "1")
        path = "/api/v1/grids/g/column/z/10_10"
        before = server.get(path)
        origin.mode = "forbidden"
        seen = len(origin.requests)

        def asked_anew():
            self.assertEqual(server.get(path).body, before.body)
            return len(origin.requests) > seen
        self.wait_until(asked_anew, "a question whether the file is still the same")
        self.assertEqual(server.get(path).body, before.body)
        failed = server.get("/api/v1/grids/g/slice/z/300.png")
        self.assertEqual(failed.status, 500)
        self.assertIn("g.tcell: the host answers with status 403", failed.json()["error"]["message"])
        self.assertNotIn("127.0.0.1", failed.json()["error"]["message"])
        origin.mode = "good"
        self.assertEqual(server.get("/api/v1/grids/g/slice/z/300.png").status, 200)
        self.stop(server, problems=1)  # the refusal is in the log

    def test_two_servers_behind_nginx_one_of_which_is_killed(self):
        origin = self.origin()
        servers = [self.serve(origin.url + "/g.tcell") for _ in range(2)]
        front = servers[0].__class__.__new__(servers[0].__class__)
        front.port, = free_ports(1)
        upstream = " ".join(f"server 127.0.0.1:{s.port};" for s in servers)
        self.start_nginx(self.configuration(f"""upstream teracell {{ {upstream} }}
            server {{ listen 127.0.0.1:{front.port}; location / {{ proxy_pass http://teracell; proxy_set_header Host localhost;
              proxy_next_upstream error timeout; }} }}"""), front.port)
        expected = {}
        for path in PATHS:
            answers = [s.get("/api/v1/grids/g/" + path) for s in servers]
            self.assertEqual((answers[0].body, answers[0].headers["ETag"]), (answers[1].body, answers[1].headers["ETag"]), path)
            expected[path] = answers[0].body, answers[0].headers["ETag"]
        wrong, asked = [], threading.Semaphore(0)

        def ask(first):
            for i in range(first, first + 40):
                path = PATHS[i % len(PATHS)]
                answer = front.get("/api/v1/grids/g/" + path)
                asked.release()
                if (answer.status, answer.body, answer.headers["ETag"]) != (200, *expected[path]):
                    wrong.append((i, path, answer.status))
        clients = [threading.Thread(target=ask, args=(i,)) for i in range(4)]
        for client in clients:
            client.start()
        for _ in range(40):
            asked.acquire()
        servers[0].kill()
        for client in clients:
            client.join()
        self.assertEqual(wrong, [])
