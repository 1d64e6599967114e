#!/usr/bin/env python3
"""The help of the program from outside: the list of commands, jnd help, messages of wrong usage, --version, JND_STUDY, and
manual pages that man reads without a warning."""
import os
import re
import shutil
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program


class Help(program.Case):
    def jnd(self, *arguments, code=0, **variables):
        return super().jnd(*arguments, code=code, env={"JND_STUDY": ""} | variables)

    def test_the_list_of_commands_stands_under_headings(self):
        text = self.jnd("--help").stdout
        headings = re.findall(r"^(\S[^:\n]*):$", text, re.M)
        self.says(headings, "Design a study", "Run it", "Look after it", "Results", "Devices and the machine", "Statistics")
        for code in (0, 1, 2, 3, 4, 5, 130):
            self.assertRegex(text, rf"\n +{code}  \w")
        self.assertLessEqual(max(len(line) for line in text.splitlines()), 100)

    def test_the_program_alone_and_a_group_alone_print_their_help(self):
        done = self.jnd()
        self.assertEqual((done.stdout, done.stderr), (self.jnd("--help").stdout, ""))
        self.assertEqual(self.jnd("calc").stdout, self.jnd("calc", "--help").stdout)
        self.assertEqual(self.jnd("device", "model").stdout, self.jnd("help", "device", "model").stdout)

    def test_help_knows_every_command_and_its_own(self):
        self.assertEqual(self.jnd("help").stdout, self.jnd("--help").stdout)
        self.assertEqual(self.jnd("help", "plan").stdout, self.jnd("plan", "--help").stdout)
        self.assertEqual(self.jnd("help", "device", "test").stdout, self.jnd("device", "test", "--help").stdout)
        wrong = self.jnd("help", "pln", code=2)
        self.assertIn("did you mean 'plan'?", wrong.stderr)
        self.assertEqual(wrong.stdout, "")

    def test_wrong_usage_says_what_is_wrong_how_it_is_used_and_where_to_read(self):
        cases = [
            (["analyse", "s"], "there is no command 'analyse'; did you mean 'analyze'?", "jnd COMMAND ...", "jnd help"),
            (["device", "tset"], "did you mean 'test'?", "jnd device COMMAND ...", "jnd help device"),
            (["run", "tutorial", "--study", "s", "--particpant", "P01"], "did you mean '--participant'?",
             "jnd run [OPTIONS] PROTOCOL", "jnd help run"),
            (["new", "x", "--task", "wich"], "did you mean 'which'?", "jnd new [OPTIONS] [FILE]", "jnd help new"),
            (["export", "s"], "--to is required", "jnd export --to FOLDER [OPTIONS] [STUDY]", "jnd help export"),
            (["status"], "STUDY is missing, and JND_STUDY names none", "jnd status [OPTIONS] [STUDY]", "jnd help status"),
            (["plan", "tutorial", "--participants", "many", "--precision"], "--participants", "jnd plan [OPTIONS] [PROTOCOL]",
             "jnd help plan"),
            (["calc", "sdt"], "FILE is required", "jnd calc sdt [OPTIONS] FILE", "jnd help calc sdt"),
        ]
        for arguments, problem, usage, more in cases:
            with self.subTest(arguments=arguments):
                done = self.jnd(*arguments, code=2)
                self.assertEqual(done.stdout, "")
                lines = done.stderr.splitlines()
                self.assertEqual(len(lines), 3, done.stderr)
                self.assertTrue(lines[0].startswith("jnd: "))
                self.assertIn(problem, lines[0])
                self.assertEqual(lines[1], f"  usage: {usage}")
                self.assertEqual(lines[2], f"  more:  {more}")

    def test_options_that_do_not_go_together_say_where_to_read(self):
        lines = self.jnd("simulate", "tutorial", code=2).stderr.splitlines()
        self.assertEqual(lines, ["jnd: say where the data go: --study FILE, or --no-study to keep nothing; of many studies --studies N --csv FOLDER", "  more:  jnd help simulate"])

    def test_names_of_shipped_things_are_looked_for_too(self):
        self.assertIn("did you mean 'tutorial'?", self.jnd("check", "tutoral", code=3).stderr)
        self.assertIn("did you mean 'chinello2017'?",
                      self.jnd("simulate", "tutorial", "--no-study", "--profile", "chinelo2017", code=3).stderr)
        self.assertIn("did you mean 'rrs3'?", self.jnd("device", "test", "rss3", code=3).stderr)

    def test_version_says_what_it_was_built_with(self):
        lines = self.jnd("--version").stdout.splitlines()
        self.assertRegex(lines[0], r"^jnd \d+\.\d+\.\d+$")
        text = "\n".join(lines[1:])
        for what in (r"g\+\+ \d+|clang \d+", r"SQLite 3\.\d+", r"Boost 1\.\d+\.\d+", r"nlohmann_json 3\.\d+", r"hidapi 0\.\d+",
                     r"zstd 1\.\d+", r"libsodium 1\.\d+", r"simdjson \d", r"Eigen 3"):
            self.assertRegex(text, what)

    def test_the_variable_stands_in_for_a_study_and_what_it_was_is_said(self):
        study = self.folder / "s.sqlite"
        self.jnd("simulate", "tutorial", "--participants", "1", "--study", study, "--seed", "1")
        named = self.jnd("status", study)
        by_variable = self.jnd("status", JND_STUDY=str(study))
        self.assertEqual(named.stdout, by_variable.stdout)
        self.assertEqual(named.stderr, "")
        self.assertEqual(by_variable.stderr, f"jnd: the study is {study} (JND_STUDY)\n")
        self.assertEqual(self.jnd("status", study, JND_STUDY="other.sqlite").stderr, "")
        # One word is the note's text where the variable names the study; two are the study and the text.
        self.assertIn(f"{study}: the note is event", self.jnd("note", "new paint", JND_STUDY=str(study)).stdout)
        self.assertIn(f"{study}: the note is event", self.jnd("note", study, "again", JND_STUDY="other.sqlite").stdout)
        self.assertIn("TEXT is required", self.jnd("note", study, code=2).stderr)
        self.assertIn("no such study", self.jnd("note", "none.sqlite", code=2, JND_STUDY=str(study)).stderr)
        self.jnd("status", code=2)
        self.assertIn("JND_STUDY", self.jnd("status", "--help").stdout)

    def test_man_reads_every_page_without_a_warning(self):
        if shutil.which("man") is None:
            self.skipTest("man is not installed: the manual pages are not looked at")
        pages = self.folder / "man"
        self.jnd("man", pages)
        self.jnd("man", pages)  # again, over the old ones
        names = sorted(os.listdir(pages))
        self.assertIn("jnd.1", names)
        self.assertIn("jnd-device-step-mckibben.1", names)
        commands = re.findall(r"^  ([a-z0-9][\w-]*)  +\S", self.jnd("--help").stdout, re.M)
        for command in commands:
            if f"jnd-{command}.1" not in names:
                self.assertIn(command, ("jnd", "0", "1", "2", "3", "4", "5", "130"), "a command without a page")
        if shutil.which("groff"):
            done = program.run("-man", "-Tutf8", "-ww", "-z", *(pages / name for name in names), program="groff")
            self.assertEqual(done.stderr, "")
        shown = program.run("--warnings", "-l", pages / "jnd-plan.1", program="man",
                            env={"MANPAGER": "cat", "MANWIDTH": "80", "LC_ALL": "C.UTF-8", "MAN_KEEP_FORMATTING": ""})
        self.assertEqual(shown.stderr, "")
        text = " ".join(re.sub(".\b", "", shown.stdout).split())
        self.assertIn("jnd-plan - Print a participant's trials", text)
        self.assertIn("jnd plan chinello2017 --participant", text)
        self.assertIn("EXIT STATUS", text)


if __name__ == "__main__":
    program.main()
