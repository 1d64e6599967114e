#!/usr/bin/env python3
"""Files that cannot be opened, made or written, from outside: the message names the place, the cause and what to do, the
exit code is that of storage, and no cause but a full disk is called one.

Run by root, permissions are tried as the user nobody, with an installation where everybody may start it, and full and
read-only disks on small ones in memory."""
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

NOBODY = {"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}
SIMULATE = ("simulate", "tutorial", "--participants", 1, "--seed", 1, "--study")


class FileTrouble(program.Case):
    @classmethod
    def setUpClass(cls):
        kept = tempfile.TemporaryDirectory()
        cls.addClassCleanup(kept.cleanup)
        cls.study = pathlib.Path(kept.name, "s.sqlite")
        prefix, build = pathlib.Path(kept.name, "prefix"), pathlib.Path(program.JND).parents[1]
        program.run("--install", build, "--prefix", prefix, program="cmake")
        cls.program = prefix / "bin/jnd"
        program.run(*SIMULATE, cls.study, program=cls.program)
        cls.study.chmod(0o644)
        os.chmod(kept.name, 0o755)

    def setUp(self):
        self.folder.chmod(0o777)

    def refused(self, cause, *arguments, lines=1, code=program.STORAGE, **how):
        said = self.jnd(*arguments, program=self.program, code=code, **how).stderr
        self.assertIn(cause, said, arguments)
        if "disk is full" not in cause:
            self.assertNotIn("full", said, arguments)
        self.assertNotIn("does not foresee", said, arguments)
        self.assertEqual(len(said.splitlines()), lines, said)
        return said

    def commands_that_write(self, place):
        """Each with the name of what it writes into that folder."""
        return ((*SIMULATE, place / "new.sqlite"), ("export", self.study, "--to", place / "csv"), ("report", self.study, "--to", place / "page.html"),
                ("backup", self.study, "--to", place / "b.sqlite"), ("recover", self.study, "--to", place / "r.sqlite"),
                ("analyze", self.study, "--methods", place / "m.md"), ("new", place / "p.json", "--from", "tutorial"),
                ("merge", self.study, self.study, "--to", place / "m.sqlite"))

    def refused_everywhere(self, cause, place, **how):
        for arguments in self.commands_that_write(place):
            if arguments[0] == "merge":
                continue  # of two studies
            with self.subTest(command=arguments[0]):
                self.refused(cause, *arguments, **how)
        self.assertEqual([one for one in place.rglob("*") if place.is_dir() and os.access(one, os.R_OK)], [])

    def test_a_folder_that_may_not_be_written_to_is_named(self):
        place = self.folder / "fixed"
        place.mkdir(mode=0o555)
        self.refused_everywhere(f"no permission to write to the folder {place}", place, **NOBODY)

    def test_a_folder_that_may_not_be_entered_is_named(self):
        place = self.folder / "closed"
        (place / "in").mkdir(parents=True)
        shutil.copy(self.study, place / "in" / "s.sqlite")
        place.chmod(0)
        self.addCleanup(place.chmod, 0o700)
        for arguments in self.commands_that_write(place / "in")[:-1]:
            self.refused(f"no permission to enter the folder {place}", *arguments, **NOBODY)
        for command in ("status", "analyze", "verify"):
            self.refused(f"no permission to enter the folder {place}", command, place / "in" / "s.sqlite", **NOBODY)

    def test_a_study_that_may_not_be_read_or_written_is_named(self):
        mine = self.folder / "mine.sqlite"
        shutil.copy(self.study, mine)
        note = ("note", mine, "dark room")
        mine.chmod(0o444)
        self.refused(f"no permission to write to the file {mine}", *note, **NOBODY)
        mine.chmod(0)
        self.refused(f"no permission to read the file {mine}", "status", mine, **NOBODY)
        (self.folder / "p.json").write_text("{}")
        (self.folder / "p.json").chmod(0)
        self.refused(f"no permission to read the file {self.folder / 'p.json'}", "check", self.folder / "p.json", code=program.INVALID, **NOBODY)

    def test_a_folder_that_is_not_there_and_a_file_in_its_place_are_named(self):
        nowhere = self.folder / "nowhere"
        for arguments in self.commands_that_write(nowhere / "in")[:-1]:
            if arguments[0] not in ("export", "report"):  # these make folders
                self.refused(f"there is no such folder: {nowhere}", *arguments)
        (self.folder / "file").write_text("x")
        for arguments in self.commands_that_write(self.folder / "file")[:-1]:
            self.refused(f"{self.folder / 'file'} is a file, not a folder", *arguments)

    def test_a_folder_in_the_place_of_a_file_is_said(self):
        (self.folder / "there").mkdir()
        for arguments in (("status", "there"), (*SIMULATE, "there"), ("report", self.study, "--to", "there", "--replace")):
            self.assertIn("there: is", self.refused("", *arguments))
        self.assertIn("is a folder", self.refused("", "check", "./there", code=program.INVALID))

    def test_a_limit_of_size_is_no_full_disk(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (16384, 16384))
        for arguments in (SIMULATE + (self.folder / "new.sqlite",), ("backup", self.study, "--to", "b.sqlite"), ("report", self.study, "--to", "r.html"),
                          ("export", self.study, "--to", "csv"), ("recover", self.study, "--to", "r.sqlite"), ("new", "p.json")):
            with self.subTest(command=arguments[0]):
                self.refused("larger than is allowed", *arguments, preexec_fn=limit)
        self.assertFalse((self.folder / "p.json").exists())  # its schema is what is too large

    def small_disk(self, *options):
        place = self.folder / "disk"
        place.mkdir(exist_ok=True)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", ",".join(options), "tmpfs", place], capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("no disk in memory can be mounted here")
        self.addCleanup(subprocess.run, ["umount", place], check=True)
        return place

    def test_a_read_only_disk_is_said(self):
        self.refused_everywhere("the disk is mounted read-only", self.small_disk("ro", "size=1m"))

    def test_a_full_disk_is_said(self):
        place = self.small_disk("size=16k")
        filler = place / "filler"
        try:
            filler.write_bytes(bytes(1 << 20))
        except OSError:
            pass
        for arguments in self.commands_that_write(place)[:-1]:
            with self.subTest(command=arguments[0]):
                self.refused("the disk is full", *arguments)
                self.assertEqual(list(place.iterdir()), [filler])

    def test_a_study_on_a_disk_that_fills_up_says_what_is_saved(self):
        place = self.small_disk("size=300k")
        study = place / "s.sqlite"
        # One line, of the event that is not saved: that the study cannot be closed either is the same trouble.
        said = self.refused("the disk is full", "simulate", "tutorial", "--participants", 40, "--seed", 1, "--study", study)
        self.assertIn("all earlier ones are", said)
        self.assertIn(str(study), said)


if __name__ == "__main__":
    program.main()
