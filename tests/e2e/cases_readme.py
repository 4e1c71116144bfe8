"""The worked example of the README is what the program says: its commands are run in order, and the output is held against what is shown."""
import pathlib
import re
import shlex

from program import Case, teracell

README = pathlib.Path(__file__).resolve().parents[2] / "README.md"
NOT_RUN = {"serve", "page"}  # one doesn't end, the other needs a build with the page's module
OF_THE_MACHINE = re.compile(r"in [\d.]+ m?s, |[\d.]+ MB of memory")


def worked_example():
    """Yields (arguments, lines of output) of each command. A line of "..." stands for lines that are left out."""
    section = README.read_text(encoding="utf-8").split("\n## A worked example\n")[1].split("\n## ")[0]
    for shown in section.split("```")[1].split("\n$ ")[1:]:
        command, *output = shown.rstrip("\n").split("\n")
        yield shlex.split(command, comments=True), output


def pattern_of(lines):
    parts = ["(?:.*\n)*?" if line.strip() == "..." else re.escape(OF_THE_MACHINE.sub("", line)) + "\n" for line in lines]
    return "^" + "".join(parts) + r"\Z"


class WorkedExampleOfTheReadme(Case):
    def test_what_it_shows_is_what_the_program_says(self):
        commands = list(worked_example())
        self.assertGreater(len(commands), 8)
        for (program, command, *args), shown in commands:
            self.assertEqual(program, "teracell")
            if command in NOT_RUN:
                continue
            run = teracell(command, *args, cwd=self.folder)
            said = run.out + run.err
            self.assertEqual(run.status, 0, said)
            told = OF_THE_MACHINE.sub("", said)
            self.assertRegex(told, pattern_of(shown), f"teracell {command}: the README shows something else")
