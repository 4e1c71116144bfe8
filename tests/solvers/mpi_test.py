"""teracell_mpi, built with Open MPI and with MPICH: the bytes of one process, whatever ranks, threads, memory and kills; and how it fails."""
import contextlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

from support import PROGRAM, ascii_stl, folder, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
MPIS = ("openmpi", "mpich")
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}


def program_of(mpi):
    return PROGRAM.with_name(f"teracell_mpi.{mpi}")


def launcher(mpi, ranks):
    return [f"mpirun.{mpi}", "-n", str(ranks)]


def ranks_that_write(output):
    """The processes, without their launcher."""
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if b"/teracell_mpi." in words[0] and str(output).encode() in words:
            found.append(int(folder.name))
    return sorted(found)


class Mpi(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = folder
        run(PROGRAM, "sample", "stadium", "-o", cls.folder / "s")
        cls.scene = cls.folder / "s/scene.json"
        cls.output = cls.folder / "g.tcell"
        cls.expected = {}

    def setUp(self):
        for left in self.folder.glob("g.tcell*"):  # by a test that failed
            left.unlink()

    def options(self, cells):
        return ["mesh", self.scene, "--cells", str(cells), "--axis", "z", "-o", self.output]

    def bytes_of_one(self, cells, *more):
        if (cells, *more) not in self.expected:
            run(PROGRAM, *self.options(cells), *more)
            self.expected[cells, *more] = self.output.read_bytes()
            self.output.unlink()
        return self.expected[cells, *more]

    def run_mpi(self, mpi, ranks, *options, **more):
        return subprocess.run([*launcher(mpi, ranks), program_of(mpi), *map(str, options)], env=ENVIRONMENT, capture_output=True, text=True, timeout=600, **more)

    def started(self, mpi, pieces, ranks=2, *more, out=subprocess.DEVNULL):
        """A job for 5000 cells that has made some pieces."""
        job = subprocess.Popen([*launcher(mpi, ranks), program_of(mpi), *map(str, self.options(5000)), *more], env=ENVIRONMENT, stdout=out, stderr=out, text=True)
        while len(list(self.folder.glob("g.tcell.piece-*"))) < pieces:
            time.sleep(0.001)
        return job

    @contextlib.contextmanager
    def small_disk(self, size):
        """A folder on a disk of its own."""
        place = self.folder / "small"
        place.mkdir(exist_ok=True)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", place], capture_output=True).returncode != 0:
            self.skipTest("needs to be root")
        try:
            yield place
        finally:
            subprocess.run(["umount", place], check=True)

    def expect_no_ranks(self):
        """They do not outlive a job for long."""
        deadline = time.monotonic() + 60
        while ranks_that_write(self.output) and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertEqual(ranks_that_write(self.output), [])

    def expect_grid(self, done, expected):
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(self.output.read_bytes() == expected, "the bytes of one process")
        self.assertEqual([p.name for p in self.folder.iterdir() if p.name.startswith("g.tcell") and p != self.output], [], "nothing is left")
        self.output.unlink()

    def test_same_bytes_for_any_ranks_threads_and_memory(self):
        # Every number of ranks and every option meets both MPIs, but not each pair of them.
        for r, ranks in enumerate((1, 2, 3, 5)):
            for o, more in enumerate(((), ("--threads", "3"), ("--memory", "1"), ("--engine", "tree"), ("--thin",))):
                mpi = MPIS[(r + o) % 2]
                with self.subTest(mpi=mpi, ranks=ranks, options=more):
                    expected = self.bytes_of_one(1000, *[word for word in more if word == "--thin"])
                    self.expect_grid(self.run_mpi(mpi, ranks, *self.options(1000), *more), expected)

    def test_report_and_caps(self):
        for mpi in MPIS:
            with self.subTest(mpi=mpi):
                (self.folder / "open.stl").write_text(ascii_stl([((0, 0, 0), (0, 1, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), (0, 0, 1)),
                                                                 ((0, 0, 0), (0, 0, 1), (0, 1, 0))]))
                results = []
                for command in ([PROGRAM], [*launcher(mpi, 3), program_of(mpi)]):
                    words = ["mesh", "open.stl", "--cells", "700", "-o", "o.tcell", "--write-caps", "caps.stl", "--report", "report.json"]
                    done = subprocess.run([*command, *words], cwd=self.folder, env=ENVIRONMENT, capture_output=True, text=True)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    report = json.loads((self.folder / "report.json").read_text())
                    warnings = [line for line in done.stderr.splitlines() if line.startswith("warning")]
                    results.append(((self.folder / "o.tcell").read_bytes(), (self.folder / "caps.stl").read_bytes(), report["bodies"], report["warnings"], warnings))
                for a, b in zip(*results):
                    self.assertTrue(a == b)

    def test_resumed_after_kills(self):
        expected = self.bytes_of_one(5000)
        seen = self.folder / "g.tcell.ranks.partial"
        partial = self.folder / "g.tcell.partial"

        def pieces():
            return [p for p in self.folder.glob("g.tcell.piece-*-of-*") if p.suffix != ".partial"]

        moments = [seen.exists, partial.exists] + [lambda n=n: len(pieces()) >= n for n in (1, 7, 25, 60, 90, 120)] + [
            lambda: partial.exists() and len(pieces()) > 100 and partial.stat().st_size > 3_000_000]
        for number, reached in enumerate(moments):
            mpi = MPIS[number % 2]
            with self.subTest(mpi=mpi, moment=number):
                self.setUp()
                ranks = 2 + number // 2 % 2
                job = self.started(mpi, 0, ranks, "--threads", "1")
                while not reached():
                    self.assertIsNone(job.poll(), "the job ended before it was to be killed")
                    time.sleep(0.001)
                writers = ranks_that_write(self.output)
                self.assertEqual(len(writers), ranks)
                os.kill(job.pid if number % 3 == 0 else writers[number % ranks], signal.SIGKILL)
                self.assertNotEqual(job.wait(60), 0)
                self.expect_no_ranks()
                if number % 3 == 0 and self.output.exists():  # ranks whose launcher is gone may be done before they notice
                    self.assertTrue(self.output.read_bytes() == expected)
                    continue
                self.assertFalse(self.output.exists())
                kept = pieces()
                resumed = self.run_mpi(mpi, 1 + number % 5, *self.options(5000), "--resume", "--progress", "plain")
                shares = [float(line.split()[1]) for line in resumed.stderr.splitlines() if line.startswith("mesh ")]
                if shares and kept:
                    of = int(kept[0].name.rpartition("-of-")[2])
                    self.assertGreaterEqual(shares[0], 100 * len(kept) / of - 0.1, "finished pieces are kept")
                self.expect_grid(resumed, expected)

    def test_a_full_disk_ends_the_job_and_pieces_are_kept(self):
        expected = self.bytes_of_one(3000)
        for mpi in MPIS:
            with self.subTest(mpi=mpi), self.small_disk("1m") as full:
                output = full / "g.tcell"
                options = [*self.options(3000)[:-1], output]
                done = self.run_mpi(mpi, 3, *options)
                self.fails_once(done, 1, "rank ", "can't write", "No space left", "pieces of the grid are kept")
                left = list(full.iterdir())
                self.assertGreater(len(left), 0)
                self.assertEqual([p.name for p in left if ".piece-" not in p.name or p.suffix == ".partial"], [])
                subprocess.run(["mount", "-o", "remount,size=100m", full], check=True)
                done = self.run_mpi(mpi, 2, *options, "--resume")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(output.read_bytes() == expected)
                self.assertEqual(list(full.iterdir()), [output])

    def fails_once(self, done, status, *words):
        self.assertEqual(done.returncode, status, done.stderr)
        said = [line for line in done.stderr.splitlines() if line.startswith("teracell_mpi: ")]
        self.assertEqual(len(said), 1, done.stderr)
        for word in words:
            self.assertIn(word, said[0])
        self.assertFalse(self.output.exists())
        self.assertFalse((self.folder / "g.tcell.partial").exists())
        self.assertFalse((self.folder / "g.tcell.ranks.partial").exists())

    def on_one(self, mpi, before, options, of_last=None, ranks=3):
        """All ranks, the last one of which is started by `before`, with the options `of_last` if it has others."""
        first, last = ([program_of(mpi), *words] for words in (options, of_last or options))
        command = [*launcher(mpi, ranks - 1), *first, ":", "-n", "1", *before, *last]
        return subprocess.run(list(map(str, command)), env=ENVIRONMENT, capture_output=True, text=True, timeout=600)

    def test_a_failing_rank_ends_the_job_with_its_message(self):
        fault = self.folder / "fault.so"
        subprocess.run(["cc", "-shared", "-fPIC", ROOT / "tests/e2e/read_fault.c", "-o", fault, "-ldl"], check=True)
        mesh = self.folder / "s" / json.loads(self.scene.read_text())["bodies"][0]["mesh"]
        for mpi in MPIS:
            with self.subTest(mpi=mpi):
                unreadable = ["env", f"LD_PRELOAD={fault}", f"READ_FAULT_PATH={mesh}", "READ_FAULT_BYTES=100"]
                self.fails_once(self.on_one(mpi, unreadable, self.options(1000)), 1, "rank 2 (", mesh.name, "Input/output error")
                self.fails_once(self.on_one(mpi, [], self.options(1000), self.options(1001), ranks=2), 1, "other inputs")
                self.fails_once(self.run_mpi(mpi, 3, "mesh", self.folder / "none.stl", "--cells", 10, "-o", self.output), 1, "none.stl")
                self.fails_once(self.run_mpi(mpi, 3, *self.options(1000), "--shard", "0/2"), 2, "--shard")
                self.fails_once(self.on_one(mpi, [], self.options(1000), [*self.options(1001), "--bogus"], ranks=2), 2, "rank 1 (", "--bogus")

    def test_pieces_of_another_run_are_not_lost_by_a_resume(self):
        for mpi in MPIS:
            with self.subTest(mpi=mpi):
                expected = self.bytes_of_one(5000)
                job = self.started(mpi, 5)
                os.kill(ranks_that_write(self.output)[1], signal.SIGTERM)
                job.wait(60)
                pieces = sorted(self.folder.glob("g.tcell.piece-*"))
                self.assertGreater(len(pieces), 0)
                self.fails_once(self.run_mpi(mpi, 2, *self.options(4999), "--resume"), 1, "can't resume", "of this run", "start again without --resume")
                self.assertEqual(sorted(self.folder.glob("g.tcell.piece-*")), pieces)
                self.expect_grid(self.run_mpi(mpi, 3, *self.options(5000), "--resume"), expected)

    def test_a_report_that_can_not_be_written_leaves_the_grid_and_no_pieces(self):
        expected = self.bytes_of_one(1000)
        for mpi in MPIS:
            with self.subTest(mpi=mpi), self.small_disk("4k") as full:
                done = self.run_mpi(mpi, 2, *self.options(1000), "--report", full / "report.json")
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn("is complete all the same", done.stderr)
                self.assertNotIn("kept", done.stderr)
                done.returncode = 0
                self.expect_grid(done, expected)

    def test_what_can_be_read_only_once_is_refused(self):
        pipe = self.folder / "pipe.stl"
        os.mkfifo(pipe)
        for mpi in MPIS:
            with self.subTest(mpi=mpi):
                self.fails_once(self.run_mpi(mpi, 2, "mesh", pipe, "--cells", 10, "-o", self.output), 1, "pipe.stl: expected a file, which every rank can read")

    def test_what_belongs_to_others_stays(self):
        for mpi in MPIS:
            with self.subTest(mpi=mpi):
                seen, precious = self.folder / "g.tcell.ranks.partial", self.folder / "precious"
                precious.write_text("precious")

                def fails(words):
                    done = self.run_mpi(mpi, 2, *self.options(100))
                    self.assertEqual(done.returncode, 1)
                    self.assertIn(words, done.stderr)

                seen.symlink_to(precious)
                fails("g.tcell.ranks.partial")
                self.assertEqual(precious.read_text(), "precious")
                seen.unlink()
                os.mkfifo(seen)
                fails("found something else: remove it")
                seen.unlink()
                taken = self.folder / "g.tcell.piece-0-of-9" / "full"
                taken.mkdir(parents=True)
                fails("g.tcell.piece-0-of-9: can't remove what another run has left")
                shutil.rmtree(taken.parent)

    def test_a_rank_whose_launcher_is_gone_ends(self):
        for mpi in MPIS:
            with self.subTest(mpi=mpi):
                expected = self.bytes_of_one(5000)
                job = self.started(mpi, 3)
                first, second = ranks_that_write(self.output)
                os.kill(second, signal.SIGSTOP)  # it sleeps while all others die
                parent = int(pathlib.Path(f"/proc/{second}/stat").read_text().rpartition(")")[2].split()[1])
                for pid in {job.pid, parent, first}:
                    os.kill(pid, signal.SIGKILL)
                job.wait(60)
                os.kill(second, signal.SIGCONT)
                self.expect_no_ranks()
                self.expect_grid(self.run_mpi(mpi, 2, *self.options(5000)), expected)

    def test_a_signal_ends_the_job(self):
        for mpi in MPIS:
            with self.subTest(mpi=mpi):
                expected = self.bytes_of_one(5000)
                job = self.started(mpi, 5, out=subprocess.PIPE)
                os.kill(ranks_that_write(self.output)[1], signal.SIGTERM)
                _, said = job.communicate(timeout=60)
                self.assertEqual(job.returncode, 130, said)
                self.assertEqual(said.count("interrupted"), 1, said)
                self.assertFalse((self.folder / "g.tcell.partial").exists())
                self.expect_grid(self.run_mpi(mpi, 3, *self.options(5000), "--resume"), expected)

    def test_folders_that_ranks_do_not_share_are_refused(self):
        if subprocess.run(["unshare", "-m", "true"], capture_output=True).returncode != 0:
            self.skipTest("needs to be root")
        own = self.folder / "own"
        own.mkdir(exist_ok=True)
        elsewhere = ["unshare", "-m", "bash", "-c", f'mount -t tmpfs tmpfs {own} && exec "$0" "$@"']
        options = ["mesh", self.scene, "--cells", "300", "-o", own / "g.tcell"]
        self.fails_once(self.on_one("openmpi", elsewhere, options), 1, "rank 2 (", "a folder that all ranks share")  # after half a minute, with any MPI

    def test_two_jobs_do_not_write_the_same_file(self):
        for mpi in MPIS:
            with self.subTest(mpi=mpi):
                expected = self.bytes_of_one(5000)
                job = self.started(mpi, 3)
                second = self.run_mpi(mpi, 2, *self.options(5000))
                self.assertEqual(job.wait(300), 0)
                self.assertEqual(second.returncode, 1, second.stderr)
                self.assertIn("another process is writing this file", second.stderr)
                self.assertTrue(self.output.read_bytes() == expected)
                self.output.unlink()

    def test_the_launcher_of_another_mpi_is_refused(self):
        for mpi, other in (MPIS, MPIS[::-1]):
            with self.subTest(mpi=mpi):
                done = subprocess.run([*launcher(other, 2), program_of(mpi), *map(str, self.options(100))], env=ENVIRONMENT, capture_output=True, text=True)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn("expected 2 ranks, found 1", done.stderr)
                self.assertFalse(self.output.exists())


if __name__ == "__main__":
    unittest.main()
