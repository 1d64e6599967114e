#!/usr/bin/env python3
"""Looking after a study from outside: note, exclude, unblind, backup, merge, recover, verify --deep."""
import contextlib
import os
import shutil
import sqlite3
import stat
import sys
import tempfile

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program


class Care(program.Case):
    @classmethod
    def setUpClass(cls):
        cls.simulated = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.simulated.cleanup)

    def setUp(self):
        self.simulate("s.sqlite", 5)

    def json(self, *arguments, code=0):
        return self.jnd(*arguments, "--json", code=code).json

    def simulate(self, study, seed, *arguments):
        """The study is simulated once; the tests have copies of its file."""
        kept = os.path.join(self.simulated.name, "-".join([str(seed), *arguments]))
        if not os.path.exists(kept):
            self.jnd("simulate", "tutorial", "--participants", "2", "--study", kept, "--seed", str(seed), *arguments)
        shutil.copy(kept, self.folder / study)

    def test_every_command_has_help_with_an_example(self):
        for command in ("note", "exclude", "unblind", "backup", "merge", "recover"):
            text = self.jnd(command, "--help").stdout
            self.assertIn(f"jnd {command} ", text)
            self.assertIn("--json", text)

    def test_a_participant_is_named_by_code_or_by_number_and_printed_by_code(self):
        run = ("run", "tutorial", "--study", "r.sqlite", "--responder", "chinello2017", "--fast", "--seed", "1")
        self.assertIn("The session of P01 is complete", self.jnd(*run, "--participant", "1").stdout)
        self.assertIn("P01 has finished", self.jnd(*run, "--participant", "P01", code=2).stderr)
        self.jnd(*run, "--participant", "Q1")
        self.jnd(*run, "--participant", "4711")  # a laboratory's own code
        self.assertEqual([one["participant"] for one in self.json("status", "r.sqlite")["sessions"]], ["P01", "Q1", "4711"])
        plans = [self.jnd("plan", "--study", "r.sqlite", "--participant", name).stdout for name in ("2", "Q1")]
        self.assertEqual(plans[0], plans[1])
        self.assertIn("participant Q1, number 2 of the plan", plans[0])
        self.assertIn("give 3", self.jnd("plan", "--study", "r.sqlite", "--participant", "4711", code=2).stderr)
        self.assertIn("participant P07, seed 1", self.jnd("plan", "tutorial", "--participant", "7").stdout)
        self.assertEqual(*(self.jnd("plan", "tutorial", "--participant", name).stdout for name in ("7", "P07")))
        self.assertIn("has no session", self.jnd("plan", "--study", "r.sqlite", "--participant", "P05", code=2).stderr)
        self.jnd("note", "r.sqlite", "came late", "--participant", "1")
        self.assertIn("participant P01", self.jnd("exclude", "r.sqlite", "--participant", "1", "--reason", "felt ill").stdout)

    def test_note_and_exclude_are_events_and_the_study_verifies(self):
        self.assertEqual(self.json("note", "s.sqlite", "lab \x1b[31mrepainted", "--participant", "P01")["event"], 4)
        self.jnd("note", "s.sqlite", "about nobody", "--participant", "P77", code=5)
        done = self.jnd("exclude", "s.sqlite", "--participant", "P02", "--reason", "felt ill", "--replace").stdout
        self.assertIn("nothing is deleted", done)
        self.assertIn("gets number 2", done)
        self.jnd("exclude", "s.sqlite", "--participant", "P02", "--reason", "again", code=5)
        self.jnd("exclude", "s.sqlite", "--participant", "P02", code=2)
        self.assertTrue(self.json("verify", "s.sqlite", "--deep")["ok"])
        analysis = self.json("analyze", "s.sqlite")
        self.assertEqual({row["participant"] for row in analysis["estimates"]}, {"P01"})

    def test_nothing_is_written_into_a_study_that_verify_refuses(self):
        with contextlib.closing(sqlite3.connect(self.folder / "s.sqlite")) as study:
            for trigger, in study.execute("SELECT name FROM sqlite_schema WHERE type = 'trigger'").fetchall():
                study.execute(f'DROP TRIGGER "{trigger}"')
            study.execute("UPDATE event SET body = replace(body, 'P02', 'P03') WHERE kind = 'session.opened'")
            study.commit()
        before = (self.folder / "s.sqlite").read_bytes()
        self.jnd("verify", "s.sqlite", code=1)
        for command in (("note", "s.sqlite", "a note"), ("exclude", "s.sqlite", "--participant", "P01", "--reason", "ill"), ("unblind", "s.sqlite", "--reason", "safety"),
                        ("simulate", "tutorial", "--participants", "3", "--study", "s.sqlite")):
            self.assertIn("nothing is written into it", self.jnd(*command, code=1).stderr)
            self.assertEqual((self.folder / "s.sqlite").read_bytes(), before)
            self.assertEqual(os.listdir(self.folder), ["s.sqlite"])

    def test_unblind_happens_once(self):
        self.jnd("unblind", "s.sqlite", code=2)
        self.assertTrue(self.json("unblind", "s.sqlite", "--reason", "safety")["unblinded"])
        self.jnd("unblind", "s.sqlite", "--reason", "safety", code=5)

    def test_backup_is_the_same_study(self):
        report = self.json("backup", "s.sqlite", "--to", "b.sqlite")
        self.assertEqual((report["written"], report["sessions"], report["problems"]), (True, 2, 0))
        heads = {row["participant"]: row["head"] for row in self.json("status", "s.sqlite")["sessions"]}
        self.assertEqual({row["participant"]: row["head"] for row in report["heads"]}, heads)
        self.assertEqual(stat.S_IMODE(os.stat(self.folder / "b.sqlite").st_mode), 0o600)
        self.jnd("backup", "s.sqlite", "--to", "b.sqlite", code=5)
        self.assertIn("verified", self.jnd("backup", "s.sqlite", "--to", "b.sqlite", "--replace").stdout)
        self.jnd("verify", "b.sqlite")
        self.assertEqual(sorted(os.listdir(self.folder)), ["b.sqlite", "s.sqlite"])

    def test_merge_refuses_duplicates_and_takes_the_rest(self):
        refused = self.jnd("merge", "s.sqlite", "s.sqlite", "--to", "m.sqlite", code=3).stderr
        self.assertIn("are the same file", refused)
        self.jnd("backup", "s.sqlite", "--to", "twin.sqlite")
        refused = self.jnd("merge", "s.sqlite", "twin.sqlite", "--to", "m.sqlite", code=3).stderr
        self.assertIn("the same session twice", refused)
        self.jnd("merge", "s.sqlite", "--to", "m.sqlite", code=2)
        self.simulate("t.sqlite", 6)
        refused = self.jnd("merge", "s.sqlite", "t.sqlite", "--to", "m.sqlite", code=3).stderr
        self.assertIn("a code stands for one person", refused)
        self.assertFalse(os.path.exists(self.folder / "m.sqlite"))

    def test_recover_saves_what_a_damaged_file_holds(self):
        content = bytearray((self.folder / "s.sqlite").read_bytes())
        content[0:4096] = bytes(4096)  # the first page: SQLite knows nothing of it any more
        self.write("damaged.sqlite", content)
        self.jnd("verify", "damaged.sqlite", code=5)
        # All of it comes back, but what said so is gone with the first page.
        report = self.json("recover", "damaged.sqlite", "--to", "saved.sqlite", code=1)
        self.assertFalse(report["whole"])
        self.assertEqual([doubt.split(":")[0] for doubt in report["doubts"]], ["the file's header is damaged"])
        self.assertTrue(all(row["closed"] for row in report["sessions"]))
        self.assertTrue(self.json("verify", "saved.sqlite", "--deep")["ok"])
        trials = "SELECT session, seq, body, hash FROM event WHERE session <> 'study' ORDER BY session, seq"
        rows = [sqlite3.connect(self.folder / name).execute(trials).fetchall() for name in ("s.sqlite", "saved.sqlite")]
        self.assertEqual(rows[0], rows[1])
        self.assertEqual((self.folder / "damaged.sqlite").read_bytes(), bytes(content))
        self.jnd("recover", "damaged.sqlite", "--to", "saved.sqlite", code=5)

    def test_a_file_that_was_cut_is_never_called_whole(self):
        content = (self.folder / "s.sqlite").read_bytes()
        self.assertTrue(self.json("recover", "s.sqlite", "--to", "whole.sqlite")["whole"])
        for part in range(3, 8):
            self.write("cut.sqlite", content[: len(content) * part // 8])
            report = self.json("recover", "cut.sqlite", "--to", f"saved-{part}.sqlite", code=1)
            self.assertFalse(report["whole"])
            self.assertIn("the file ends early", report["doubts"][0])
            self.assertEqual(report["pages"], len(content) // 4096)
            self.assertEqual(report["pages"] - report["pages_missing"], os.path.getsize(self.folder / "cut.sqlite") // 4096)
            self.assertTrue(report["events_added"] is None or report["events_added"] >= report["events_found"])
            for row in report["sessions"]:
                self.assertEqual(row["last_event"] is None, row["events"] == 0)
                self.assertEqual(row["fate"] == "whole", row["closed"] and not row["cut"], row)
                self.assertNotEqual(row["fate"], "open", row)
            os.remove(self.folder / f"saved-{part}.sqlite")
            said = self.jnd("recover", "cut.sqlite", "--to", f"saved-{part}.sqlite", code=1).stdout
            self.assertIn(f"{report['pages'] - report['pages_missing']} of {report['pages']} pages of the file were there", " ".join(said.split()))
            self.says(said, "Lost, or in doubt", "What to do next", "jnd status BACKUP", "jnd verify")

    def test_no_results_come_from_a_study_that_was_changed(self):
        """One stimulus in the file: everything that would compute with it says so and writes nothing."""
        content = (self.folder / "s.sqlite").read_bytes()
        self.assertIn(b'"stimulus_1_n_per_m":900', content)
        self.write("rot.sqlite", content.replace(b'"stimulus_1_n_per_m":900', b'"stimulus_1_n_per_m":400', 1))
        before = sorted(os.listdir(self.folder))
        for arguments in (("analyze", "rot.sqlite"), ("analyze", "rot.sqlite", "--json"), ("report", "rot.sqlite", "--to", "r.html"),
                          ("export", "rot.sqlite", "--to", "e")):
            done = self.jnd(*arguments, code=1)
            self.assertEqual(done.stdout, "")
            self.assertIn("is not what was recorded, and no results are computed from it", done.stderr)
            self.assertIn("its hash does not match", done.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), before)
        self.jnd("verify", "rot.sqlite", code=1)

    def test_the_head_of_the_studys_own_chain_is_wherever_heads_are(self):
        self.jnd("exclude", "s.sqlite", "--participant", "P02", "--reason", "felt ill")
        with sqlite3.connect(self.folder / "s.sqlite") as study:
            head = study.execute("SELECT hash FROM event WHERE session = 'study' ORDER BY seq DESC").fetchone()[0]
        self.jnd("report", "s.sqlite", "--to", "r.html")
        self.jnd("export", "s.sqlite", "--to", "e")
        for arguments in (("status",), ("verify",), ("analyze",)):
            self.assertIn(head, self.jnd(arguments[0], "s.sqlite", *arguments[1:]).stdout, arguments)
            self.assertEqual(self.json(arguments[0], "s.sqlite", *arguments[1:])["study_head"], head)
        for name in ("r.html", "e/sessions.csv", "e/methods.md"):
            self.assertIn(head, self.read(name), name)

    def test_studies_of_two_protocols_with_one_seed_are_told_apart(self):
        self.jnd("simulate", "adaptive-quest", "--participants", "1", "--study", "q.sqlite", "--seed", "5")
        refused = self.jnd("merge", "s.sqlite", "q.sqlite", "--to", "m.sqlite", code=3).stderr
        self.assertIn("is of another protocol", refused)
        self.assertNotIn("twice", refused)
        ids = [{row["id"] for row in self.json("status", name)["sessions"]} for name in ("s.sqlite", "q.sqlite")]
        self.assertFalse(ids[0] & ids[1])

    def test_codes_that_look_alike_are_refused(self):
        run = ("run", "tutorial", "--study", "r.sqlite", "--responder", "chinello2017", "--fast", "--seed", "1")
        self.jnd(*run, "--participant", "P07")
        for code in ("p07", "P7", "P007"):
            refused = self.jnd(*run, "--participant", code, code=2).stderr
            self.says(refused, "the study has a participant P07", "For the same person: --participant P07")
        self.jnd(*run, "--participant", "p08")

    def test_a_file_with_a_foreign_trigger_is_refused_in_words(self):
        with sqlite3.connect(self.folder / "s.sqlite") as study:
            study.execute("CREATE TRIGGER z BEFORE INSERT ON event WHEN NEW.kind = 'note' BEGIN SELECT RAISE(IGNORE); END")
        for arguments in (("verify",), ("status",), ("analyze",), ("note", "hello")):
            refused = self.jnd(arguments[0], "s.sqlite", *arguments[1:], code=5).stderr
            self.assertIn("is not a study of this program: it has a trigger z that no study has; it was not changed", refused)

    def test_a_study_from_before_the_release_is_refused_by_every_command(self):
        self.simulate("other.sqlite", 6)
        with sqlite3.connect(self.folder / "s.sqlite") as study:
            study.execute(f"PRAGMA application_id = {0x6A6E6473}")
            study.execute("PRAGMA user_version = 4")
        before = (self.folder / "s.sqlite").read_bytes()
        for arguments in (("status", "s.sqlite"), ("verify", "s.sqlite"), ("verify", "s.sqlite", "--deep"), ("analyze", "s.sqlite"),
                          ("export", "s.sqlite", "--to", "out"), ("report", "s.sqlite", "--to", "r.html"), ("note", "s.sqlite", "hello"),
                          ("exclude", "s.sqlite", "--participant", "P01", "--reason", "ill"), ("unblind", "s.sqlite", "--reason", "safety"),
                          ("plan", "--study", "s.sqlite", "--participant", "1"), ("backup", "s.sqlite", "--to", "b.sqlite"),
                          ("recover", "s.sqlite", "--to", "b.sqlite"), ("merge", "s.sqlite", "other.sqlite", "--to", "b.sqlite"),
                          ("simulate", "tutorial", "--participants", "2", "--study", "s.sqlite"),
                          ("run", "tutorial", "--study", "s.sqlite", "--participant", "P09", "--responder", "chinello2017", "--fast")):
            refused = self.jnd(*arguments, code=3 if arguments[0] == "merge" else 5).stderr
            self.assertIn("s.sqlite: was written by a jnd from before its first release, whose files this program does not read; "
                          "it was not changed. Simulate or run the study again", refused)
            self.assertEqual((self.folder / "s.sqlite").read_bytes(), before, arguments)
        self.assertEqual(sorted(os.listdir(self.folder)), ["other.sqlite", "s.sqlite"])

    def test_a_session_that_is_closed_and_cut_is_not_whole(self):
        study = sqlite3.connect(self.folder / "s.sqlite")
        session, last = study.execute("SELECT session, max(seq) FROM event WHERE session <> 'study' GROUP BY session").fetchone()
        study.execute("INSERT INTO event (session, seq, kind, utc, monotonic_ns, version, body, hash) SELECT session, seq + 1, 'note', "
                      "utc, monotonic_ns, version, '{}', hash FROM event WHERE session = ? AND seq = ?", (session, last))
        study.commit()
        study.close()
        done = self.jnd("recover", "s.sqlite", "--to", "saved.sqlite", code=1).stdout
        self.assertIn("its end is lost; 1 event behind the gap left out", done)

    def test_a_backup_takes_the_place_of_an_earlier_one_only(self):
        self.simulate("other.sqlite", 6)
        refused = self.jnd("backup", "s.sqlite", "--to", "other.sqlite", "--replace", code=5).stderr
        self.assertIn("is no backup of this study", refused)
        self.assertTrue(self.json("verify", "other.sqlite")["ok"])

    def test_the_damaged_original_is_never_overwritten(self):
        os.rename(self.folder / "s.sqlite", self.folder / "s.sqlite.lock")
        for command in ("recover", "backup"):
            refused = self.jnd(command, "s.sqlite.lock", "--to", "s.sqlite", code=5).stderr
            self.assertIn("would overwrite s.sqlite.lock", refused)
        self.assertEqual(os.listdir(self.folder), ["s.sqlite.lock"])

    def test_a_report_replaces_neither_a_study_nor_a_foreign_file(self):
        self.write("thesis.docx", "years of work")
        os.mkdir(self.folder / "drawings")
        self.write("drawings/mine.svg", "<svg/>")
        before = (self.folder / "s.sqlite").read_bytes()
        for place in ("s.sqlite", "thesis.docx"):
            refused = self.jnd("report", "s.sqlite", "--to", place, "--replace", code=5).stderr
            self.assertIn("was not written by jnd report", refused)
        self.jnd("report", "s.sqlite", "--to", "r.html", "--figures", "drawings", "--replace", code=5)
        # What is at fault is named.
        long_name = "f" * 300
        self.assertIn(f"{long_name}: cannot be written: File name too long", self.jnd("report", "s.sqlite", "--to", "r.html", "--figures", long_name, code=5).stderr)
        self.assertEqual((self.folder / "s.sqlite").read_bytes(), before)
        self.assertEqual(os.listdir(self.folder / "drawings"), ["mine.svg"])
        self.assertFalse(os.path.exists(self.folder / "r.html"))

    def test_deep_verification_computes_what_was_delivered(self):
        self.simulate("full.sqlite", 7, "--record", "full")
        report = self.json("verify", "--deep", "full.sqlite")
        self.assertTrue(report["ok"])
        self.assertEqual(report["deep"]["sessions"], 2)
        self.assertGreater(report["deep"]["numbers"], 100)
        self.assertEqual(report["deep"]["findings"], [])


if __name__ == "__main__":
    program.main()
