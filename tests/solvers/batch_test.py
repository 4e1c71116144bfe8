"""tools/cli/BATCH.md: its scripts and lines as they stand there, run by Slurm on two nodes that are both this machine, and by GNU parallel."""
import contextlib
import os
import pathlib
import pwd
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

from support import PROGRAM, folder, run
from nginx import free_ports  # of tests/e2e, where support looks

TEXT = (pathlib.Path(__file__).resolve().parents[2] / "tools/cli/BATCH.md").read_text()
PARTS = 16
MESH = ["mesh", "scene.json", "--step", "0.05", "-o"]
DEADLINE = 60  # for what would otherwise never end

CONFIGURATION = """
ClusterName=teracell
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={ports[0]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,bf_interval=1
# This machine may have fewer cores and less memory than its nodes say.
SlurmdParameters=config_overrides
NodeName=node1 NodeHostName=localhost NodeAddr=127.0.0.1 Port={ports[1]} CPUs=16 RealMemory=32768
NodeName=node2 NodeHostName=localhost NodeAddr=127.0.0.1 Port={ports[2]} CPUs=16 RealMemory=32768
PartitionName=all Nodes=ALL Default=YES State=UP
"""


def block_after(words):
    """The first block of code after these words of the page."""
    return re.search(r"```(?:bash)?\n(.*?)```", TEXT[TEXT.index(words):], re.DOTALL)[1]


def wait_for(found, what, pause=0.1):
    """Asks `found` until it answers with something true, which is returned."""
    end = time.monotonic() + DEADLINE
    while not (answer := found()):
        if time.monotonic() > end:
            raise AssertionError(f"there was no {what} within {DEADLINE} s")
        time.sleep(pause)
    return answer


def processes(belongs, kind):
    """Those for whose /proc/PID/`kind`, as a list of words, `belongs` is true."""
    found = {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            words = (folder / kind).read_bytes().decode(errors="replace").split("\0")
            if belongs(words):
                found[int(folder.name)] = words
    return found


class Slurm:
    """Munge's daemon, Slurm's controller and two nodes, with all their files in a folder."""

    def __init__(self, folder):
        folder.mkdir()
        self.folder = folder
        self.daemons = []
        (folder / "state").mkdir()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        configuration = folder / "slurm.conf"
        configuration.write_text(CONFIGURATION.format(ports=free_ports(3), folder=folder, user=pwd.getpwuid(os.geteuid()).pw_name))
        (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")  # which looks for none; they are not used
        self.environment = {**os.environ, "SLURM_CONF": str(configuration)}

    def __enter__(self):
        try:
            self.start("munged", "--foreground", "--force", *(f"--{name}={self.folder}/munge.{suffix}" for name, suffix in (
                ("key-file", "key"), ("socket", "socket"), ("log-file", "log"), ("pid-file", "pid"), ("seed-file", "seed"))))
            wait_for((self.folder / "munge.socket").exists, "socket of munged")
            self.start("slurmctld", "-D")
            for node in ("node1", "node2"):
                self.start("slurmd", "-D", "-N", node)
            wait_for(lambda: self.ask("sinfo", "-h", "-N", "-o", "%N %T") == ["node1 idle", "node2 idle"], "two idle nodes")
            return self
        except BaseException:
            self.stop()
            self.show_logs()
            raise

    def __exit__(self, kind, *_):
        self.stop()
        if kind:
            self.show_logs()

    def show_logs(self):
        for log in sorted(self.folder.glob("*.out")):
            print(f"-- {log.name}\n{log.read_text()}", file=sys.stderr)

    def start(self, name, *args):
        with open(self.folder / f"{name}{args[-1] if name == 'slurmd' else ''}.out", "wb") as out:
            self.daemons.append(subprocess.Popen(["/usr/sbin/" + name, *args], env=self.environment, stdout=out, stderr=out))

    def stop(self):
        if len(self.daemons) > 2:
            subprocess.run(["scancel", "--signal=KILL", "--full", "--user", str(os.geteuid())], env=self.environment, capture_output=True)
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in self.daemons:
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()
        # What outlives the daemons, such as the steps of jobs.
        mine = f"SLURM_CONF={self.environment['SLURM_CONF']}"
        for process in processes(lambda words: mine in words, "environ"):
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)

    def ask(self, *words):
        return subprocess.run(words, env=self.environment, capture_output=True, text=True).stdout.splitlines()

    def jobs(self):
        """{name or number of the part: (state, node)}, of the last job of that name."""
        jobs = [dict(re.findall(r"(\w+)=(\S*)", line)) for line in self.ask("scontrol", "-o", "show", "job")]
        jobs = [job for job in jobs if job.get("ArrayTaskId", "0").isdigit()]  # the others stand for parts that wait
        jobs.sort(key=lambda job: int(job.get("ArrayJobId", job["JobId"])))
        return {int(job["ArrayTaskId"]) if "ArrayTaskId" in job else job["JobName"]: (job["JobState"], job["NodeList"]) for job in jobs}


class Batch(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = folder
        (cls.folder / "bin").mkdir()
        (cls.folder / "bin/teracell").symlink_to(PROGRAM)
        os.environ["PATH"] = f"{cls.folder}/bin:{os.environ['PATH']}"
        run(PROGRAM, "sample", "stadium", "-o", cls.folder / "scene")
        run(PROGRAM, *MESH, "../one.tcell", cwd=cls.folder / "scene")
        cls.expected = (cls.folder / "one.tcell").read_bytes()

    def setUp(self):
        self.work = self.folder / self.id().split(".")[-1]
        shutil.copytree(self.folder / "scene", self.work)
        self.output = self.work / "scene.tcell"

    def part(self, number):
        return self.work / f"scene.tcell.shard-{number}-of-{PARTS}"

    def bash(self, lines, **more):
        return subprocess.run(["bash", "-c", lines], cwd=self.work, capture_output=True, text=True, **more)

    def kill_part(self, number):
        """Returns the words of its command."""
        def writer():
            if pathlib.Path(f"{self.part(number)}.partial").exists():
                return processes(lambda words: words[0].endswith("teracell") and f"{number}/{PARTS}" in words, "cmdline")
        [(process, words)] = wait_for(writer, f"run of part {number}", 0.002).items()
        os.kill(process, signal.SIGKILL)
        return words

    def state_of_parts(self):
        return {i: (s.st_ino, s.st_mtime_ns) for i in range(PARTS) if self.part(i).exists() for s in [self.part(i).stat()]}

    def expect_part_missing(self, number):
        self.assertFalse(self.output.exists())
        self.assertEqual(sorted(self.state_of_parts()), [i for i in range(PARTS) if i != number])
        merge = self.bash(block_after("`merge.sh` puts").splitlines()[-1])
        self.assertEqual(merge.returncode, 1)
        self.assertIn(f"expected {PARTS} parts, found {PARTS - 1}: {number} is missing", merge.stderr)

    def expect_grid(self):
        self.assertTrue(self.output.read_bytes() == self.expected, "the bytes of one run")

    def test_slurm(self):
        (self.work / "part.sh").write_text(block_after("`part.sh` makes"))
        (self.work / "merge.sh").write_text(block_after("`merge.sh` puts"))
        with Slurm(self.folder / "slurm") as slurm:
            def ended():
                jobs = slurm.jobs()
                return jobs if len(jobs) == PARTS + 1 and not {state for state, _ in jobs.values()} & {"PENDING", "RUNNING", "COMPLETING"} else None

            submitted = self.bash(block_after("Submit them"), env=slurm.environment)
            self.assertEqual(submitted.returncode, 0, submitted.stderr)
            words = self.kill_part(3)
            self.assertEqual(words[words.index("--threads") + 1], "8")
            self.assertEqual(words[words.index("--memory") + 1], "12288M")
            jobs = wait_for(ended, "end of all jobs")
            self.assertEqual({job: state for job, (state, _) in jobs.items()},
                             {**dict.fromkeys(range(PARTS), "COMPLETED"), 3: "FAILED", "merge": "CANCELLED"})
            self.assertEqual({node for job, (_, node) in jobs.items() if job != "merge"}, {"node1", "node2"})
            self.expect_part_missing(3)

            before = self.state_of_parts()
            submitted = self.bash(block_after("Make part 3 again"), env=slurm.environment)
            self.assertEqual(submitted.returncode, 0, submitted.stderr)
            wait_for(lambda: slurm.jobs()["merge"][0] in ("COMPLETED", "FAILED"), "end of the second merge")
            self.assertEqual({state for state, _ in slurm.jobs().values()}, {"COMPLETED"}, (self.work / "merge.log").read_text())
            self.assertEqual({i: s for i, s in self.state_of_parts().items() if i != 3}, before, "the other parts are not made again")
            self.expect_grid()

    def test_parallel(self):
        job = subprocess.Popen(["bash", "-c", block_after("Four parts at a time")], cwd=self.work, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.kill_part(3)
        said, _ = job.communicate(timeout=DEADLINE)
        self.assertEqual(job.returncode, 1, said)
        self.expect_part_missing(3)
        before = self.state_of_parts()
        again = self.bash(block_after("When parts fail, make"))
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual({i: s for i, s in self.state_of_parts().items() if i != 3}, before, "the other parts are not made again")
        self.expect_grid()


if __name__ == "__main__":
    unittest.main()
