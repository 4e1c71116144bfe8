"""A grid that is made in parts: the bytes of one run, and what is said when a part is missing, foreign, double or damaged."""
import os
import resource

import solids
from program import Case, teracell

MESH = ["mesh", "stadium/scene.json", "--progress", "none"]


class Parts(Case):
    def setUp(self):
        super().setUp()
        self.run_ok("sample", "stadium", "-o", "stadium")

    def parts(self, of, *more, numbers=None, output="g.tcell"):
        names = []
        for i in range(of) if numbers is None else numbers:
            self.run_ok(*MESH, *more, "--cells", 300, "-o", output, "--shard", f"{i}/{of}")
            names.append(f"{output}.shard-{i}-of-{of}")
        return names

    def test_parts_merge_to_the_bytes_of_one_run(self):
        self.run_ok(*MESH, "--cells", 300, "-o", "one.tcell")
        parts = self.parts(3)
        self.assertFalse(os.path.exists(self.path("g.tcell")), "a part is not the grid")
        for part in parts:
            self.run_ok("verify", part)
        self.run_ok("merge", *reversed(parts), "-o", "g.tcell")
        self.assertEqual(self.bytes("g.tcell"), self.bytes("one.tcell"))
        self.run_ok("verify", "g.tcell")
        self.no_debris()

    def test_a_part_is_made_again_alone(self):
        parts = self.parts(3)
        was = self.bytes(parts[1])
        os.unlink(self.path(parts[1]))
        self.refused(1, ["expected 3 parts, found 2", "1 is missing"], "merge", parts[0], parts[2], "-o", "g.tcell")
        self.parts(3, "--memory", "1K", "--threads", 3, numbers=[1])
        self.assertEqual(self.bytes(parts[1]), was, "the bytes of a part depend on scene, options and number alone")

    def test_what_does_not_belong_together_is_not_merged(self):
        parts = self.parts(2)
        other = self.parts(2, "--thin", output="h.tcell")
        [third] = self.parts(3, numbers=[1])
        self.write("copy", self.bytes(parts[0]))
        for phrases, names in ((["another run"], [parts[0], other[1]]), (["one of 2 parts", "one of 3"], [parts[0], third]),
                               (["are both part 0", "copy"], [*parts, "copy"]), (["expected a part"], [parts[0], "stadium/roof.stl"]),
                               (["nowhere"], [parts[0], "nowhere"])):
            self.refused(1, phrases, "merge", *names, "-o", "g.tcell")
            self.assertFalse(os.path.exists(self.path("g.tcell")))

    def test_damage_is_found_by_verify_and_by_merge(self):
        parts = self.parts(2)
        whole = self.bytes(parts[1])
        for place in (3, 20, 60, len(whole) // 2, len(whole) - 70, len(whole) - 1):
            damaged = bytearray(whole)
            damaged[place] ^= 16
            self.write("d", damaged)
            self.refused(1, "d", "verify", "d")
            self.refused(1, "d", "merge", parts[0], "d", "-o", "g.tcell")
        for cut in (0, 7, 100, len(whole) - 1):
            self.write("d", whole[:cut])
            self.refused(1, "d", "verify", "d")
            self.refused(1, "d", "merge", parts[0], "d", "-o", "g.tcell")
        self.assertFalse(os.path.exists(self.path("g.tcell")))

    def test_wrong_usage(self):
        for shard, phrase in (("3/3", "the number of the part"), ("-1/3", "the number of the part"), ("1/0", "the number of parts"), ("1", "such as 0/8"),
                              ("a/3", "the number of the part"), ("1/3/4", "--shard")):
            self.refused(2, ["--shard", phrase], *MESH, "--cells", 300, "-o", "g.tcell", f"--shard={shard}")
        self.refused(2, "--report", *MESH, "--cells", 300, "-o", "g.tcell", "--shard", "0/2", "--report", "r.json")
        parts = self.parts(2)
        was = self.bytes(parts[0])
        self.refused(2, "overwritten", "merge", *parts, "-o", parts[0])
        self.refused(2, "--report", "merge", *parts, "-o", "g.tcell", "--report", "g.tcell")
        self.assertEqual(self.bytes(parts[0]), was)
        self.refused(1, parts[0], "info", parts[0])

    def test_an_interrupted_part_leaves_nothing_and_can_be_made_again(self):
        self.interrupt(["mesh", "stadium/scene.json", "--cells", 9000, "-o", "g.tcell", "--shard", "0/2", "--progress", "plain"],
                       lambda process: process.stderr.read(1))
        self.assertEqual(teracell("verify", "g.tcell.shard-0-of-2", cwd=self.folder).status, 1)

    def test_a_part_that_is_not_complete_is_called_so(self):
        parts = self.parts(2)
        for name in (f"{parts[1]}.partial", f"{parts[1]}.resume"):
            self.write(name, self.bytes(parts[1])[:-50])
            self.assert_refused(teracell("merge", *parts, name, "-o", "g.tcell", cwd=self.folder), 1, [name, "not complete", "being made"])

    def test_there_may_be_more_parts_than_files_that_may_be_open(self):
        self.run_ok(*MESH, "--cells", 300, "-o", "one.tcell")
        parts = self.parts(40)
        self.run_ok("merge", *parts, "-o", "g.tcell", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (24, 24)))
        self.assertEqual(self.bytes("g.tcell"), self.bytes("one.tcell"))

    def test_the_first_part_writes_what_closes_the_surfaces(self):
        self.write("open.stl", solids.binary_stl(solids.box_facets((0, 0, 0), (1, 1, 1))[1:]))
        mesh = ["mesh", "open.stl", "--cells", 300, "--progress", "none", "--write-caps"]
        self.run_ok(*mesh, "one.stl", "-o", "one.tcell")
        self.run_ok(*mesh, "caps.stl", "-o", "g.tcell", "--shard", "0/2")
        self.assertEqual(self.bytes("caps.stl"), self.bytes("one.stl"))
        os.unlink(self.path("caps.stl"))
        r = self.run_ok(*mesh, "caps.stl", "-o", "g.tcell", "--shard", "1/2")
        self.assertFalse(os.path.exists(self.path("caps.stl")))
        self.assertNotIn("caps.stl", r.err)
