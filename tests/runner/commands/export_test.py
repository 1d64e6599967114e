#!/usr/bin/env python3
"""The folder of `jnd export` from outside: datapackage.json is a Data Package that describes every CSV file and every cell of it, for
every kind of study; recompute.py and recompute.R compute the results again, and tell what was changed."""
import contextlib
import csv
import datetime
import fnmatch
import hashlib
import io
import json
import pathlib
import re
import runpy
import shutil
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REAL_STUDY, SCHEMA_CHECK = program.argument(), program.argument()
HERE = pathlib.Path(__file__).resolve().parent
R = shutil.which("Rscript")
# A study of every kind, with as few participants as its analysis can do with.
STUDIES = {"tutorial": 3, "staircase": 3, "jones1997-viscosity": 3, "leib2015": 3, "pang1991": 2,
           "identify-stiffness2025": 2, "carpenter2018-oddity": 3, "dhong2019-magnitude": 3,
           "van-beek2015": 3, "chinello2017-experiment2": 2, "sandpaper-hands2013": 12}


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return rows[0], rows[1:]


def parses(cell, field):
    """Whether a cell that is not empty is of its declared type."""
    kind = field["type"]
    if kind == "integer":
        return re.fullmatch(r"-?\d+", cell) is not None
    if kind == "number":
        return re.fullmatch(r"-?(\d+(\.\d+)?(e[+-]?\d+)?|inf)", cell.lower()) is not None
    if kind == "boolean":
        return cell in field["trueValues"] + field["falseValues"]
    if kind == "datetime":
        return datetime.datetime.fromisoformat(re.sub(r"(\.\d{6})\d*Z$", r"\1", cell).rstrip("Z")) is not None
    return kind == "string" and cell in field.get("constraints", {}).get("enum", [cell])


class Export(program.Shared):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.exports = {}
        cls.jnd("new", "staircase.json", "--task", "same-different", "--rig", "external", "--procedure", "staircase")
        for name, participants in STUDIES.items():
            protocol = f"{name}.json" if (cls.folder / f"{name}.json").exists() else name
            cls.jnd("simulate", protocol, "--participants", participants, "--study", f"{name}.sqlite", "--seed", 3)
            cls.exports[name] = cls.export(name)

    @classmethod
    def export(cls, name, *more):
        cls.jnd("export", f"{name}.sqlite", "--to", name, *more)
        return cls.folder / name

    def python(self, folder):
        """What the script of a folder prints, and the status that it ends with. In this process, which saves starting another."""
        printed, arguments = io.StringIO(), sys.argv
        sys.argv = [str(folder / "recompute.py")]
        try:
            with contextlib.redirect_stdout(printed), self.assertRaises(SystemExit) as ended:
                runpy.run_path(sys.argv[0], run_name="__main__")
        finally:
            sys.argv = arguments
        code = ended.exception.code  # a text is what Python would print, and ends it with 1
        return (1, printed.getvalue() + code) if isinstance(code, str) else (code, printed.getvalue())

    # The data package.

    def read_package(self, folder):
        """Resources by path, each with its schema."""
        schemas = [str(path) for path in sorted(folder.glob("schema/*.json"))]
        for profile, files in ("datapackage", [str(folder / "datapackage.json")]), ("tableschema", schemas):
            if files:
                program.run(HERE / f"datapackage/{profile}.json", *files, program=SCHEMA_CHECK)
        package = json.loads((folder / "datapackage.json").read_text())
        self.assertEqual(package["$schema"], "https://datapackage.org/profiles/2.0/datapackage.json")
        resources = {}
        for resource in package["resources"]:
            if isinstance(resource["schema"], str):
                resource["schema"] = json.loads((folder / resource["schema"]).read_text())
            resources[resource["path"]] = resource
        self.assertEqual(len({resource["name"] for resource in resources.values()}), len(package["resources"]))
        return resources

    def check_package(self, folder):
        resources = self.read_package(folder)
        files = {str(path.relative_to(folder)) for path in folder.rglob("*.csv")}
        self.assertEqual(files, set(resources))
        tables = {}
        for path, resource in resources.items():
            header, rows = rows_of(folder / path)
            fields = resource["schema"]["fields"]
            self.assertEqual(header, [field["name"] for field in fields], path)
            for field in fields:
                self.assertTrue(field["title"] and field["description"], field)
            for row in rows:
                for cell, field in zip(row, fields):
                    self.assertTrue(cell == "" or parses(cell, field), f"{path}: {cell} is not {field}")
            tables[resource["name"]] = (header, rows)
        self.check_keys(resources, tables)
        self.check_dictionary(folder, resources)

    def check_keys(self, resources, tables):
        def cells(name, columns):
            header, rows = tables[name]
            places = [header.index(column) for column in columns]
            return [tuple(row[place] for place in places) for row in rows]

        for resource in resources.values():
            schema, name = resource["schema"], resource["name"]
            if "primaryKey" in schema:
                found = cells(name, schema["primaryKey"])
                self.assertEqual(len(found), len(set(found)), f"{name}: {schema['primaryKey']}")
                self.assertNotIn("", [cell for row in found for cell in row], f"{name}: {schema['primaryKey']}")
            for key in schema.get("foreignKeys", []):
                known = set(cells(key["reference"]["resource"], key["reference"]["fields"]))
                used = {row for row in cells(name, key["fields"]) if "" not in row}
                self.assertEqual(used - known, set(), f"{name}: {key}")

    def check_dictionary(self, folder, resources):
        header, rows = rows_of(folder / "dictionary.csv")
        self.assertEqual(header, ["file", "column", "meaning", "unit", "levels", "type"])
        for path, resource in resources.items():
            pattern = re.sub(r"^sub-[^/]+", "sub-*", path)
            said = [row for row in rows if row[0] == path or (row[0].startswith("sub-*") and fnmatch.fnmatchcase(pattern, row[0]))]
            self.assertEqual([(field["name"], field["description"], field.get("unit", ""), field["type"])
                              for field in resource["schema"]["fields"]], [(row[1], row[2], row[3], row[5]) for row in said], path)

    def test_every_csv_file_is_described_and_every_cell_is_what_it_is_said_to_be(self):
        for name, folder in self.exports.items():
            with self.subTest(name):
                self.check_package(folder)
        keys = {path: resource["schema"].get("primaryKey") for path, resource in self.read_package(self.exports["tutorial"]).items()}
        self.assertEqual({path: keys[path] for path in ("trials.csv", "intervals.csv", "cells.csv", "estimates.csv", "items.csv")}, {
            "trials.csv": ["session", "trial"], "intervals.csv": ["session", "seq", "interval", "finger", "channel"],
            "cells.csv": ["participant", "condition", "series"], "estimates.csv": ["participant", "condition", "standard"], "items.csv": None})

    def test_results_alone_and_ticks_are_described_too(self):
        self.jnd("analyze", "tutorial.sqlite", "--csv", "csv")
        self.check_package(self.folder / "csv")
        self.jnd("simulate", "tutorial", "--participants", 1, "--study", "ticks.sqlite", "--seed", 1, "--record", "full")
        folder = self.export("ticks", "--telemetry")
        self.assertEqual(len(list(folder.glob("sub-P01/telemetry/*.csv"))), 2 * len(rows_of(folder / "trials.csv")[1]))
        resources = json.loads((folder / "datapackage.json").read_text())["resources"]
        ticks = [resource for resource in resources if "telemetry" in resource["path"]]
        self.assertEqual({resource["schema"] for resource in ticks}, {"schema/telemetry.json"})
        for path in list(folder.glob("sub-P01/telemetry/*.csv"))[2:]:  # one trial says it all
            path.unlink()
        kept = {str(path.relative_to(folder)) for path in folder.rglob("*.csv")}
        package = json.loads((folder / "datapackage.json").read_text())
        package["resources"] = [resource for resource in package["resources"] if resource["path"] in kept]
        (folder / "datapackage.json").write_text(json.dumps(package))
        self.check_package(folder)

    def real(self, kind, finished, unfinished, how, name):
        self.jnd(f"{name}.sqlite", program.ROOT / "protocols/tutorial.json", "7", kind, finished, unfinished, how, program=REAL_STUDY)

    def test_what_did_not_count_is_listed_with_its_reason_and_nothing_of_it_counts(self):
        self.real("simulated", 2, 1, "taken-back", "back")
        self.jnd("exclude", "back.sqlite", "--participant", "P02", "--kind", "simulated", "--reason", "fell asleep")
        folder = self.export("back")
        self.check_package(folder)
        header, rows = rows_of(folder / "voided.csv")
        voided = [dict(zip(header, row)) for row in rows]
        self.assertEqual([(row["participant"], row["reason"], row["answered"]) for row in voided], [("P01", "taken_back", "1")])
        trials = [dict(zip(*pair)) for pair in ((rows_of(folder / "trials.csv")[0], row) for row in rows_of(folder / "trials.csv")[1])]
        self.assertNotIn((voided[0]["session"], voided[0]["trial"]), {(row["session"], row["trial"]) for row in trials})
        header, rows = rows_of(folder / "participants.csv")
        people = [dict(zip(header, row)) for row in rows]
        self.assertEqual([(row["participant"], row["excluded"], row["excluded_reason"], row["trials_voided"]) for row in people],
                         [("P01", "0", "", "1"), ("P02", "1", "fell asleep", "1"), ("P03", "0", "", "0")])
        self.assertNotIn("P02", {row["participant"] for row in trials})
        self.assertFalse((folder / "sub-P02").exists())
        status, printed = self.python(folder)
        self.assertEqual(status, 0, printed)

    def test_a_blinded_export_is_a_package_without_what_is_sealed(self):
        self.real("real", 1, 1, "taken-back", "blinded")
        folder = self.export("blinded")
        self.check_package(folder)
        self.assertEqual({path.name for path in folder.iterdir()},
                         {"SHA256SUMS", "coded.csv", "datapackage.json", "dictionary.csv", "monitoring.csv", "participants.csv", "sessions.csv",
                          "trials.csv"})
        self.assertEqual(rows_of(folder / "participants.csv")[0],
                         ["participant", "participant_number", "kind", "sessions", "sessions_closed", "ended_early", "trials_done",
                          "trials_voided", "excluded"])
        self.assertEqual(rows_of(folder / "trials.csv")[0],
                         ["participant", "session", "session_number", "utc", "trial", "practice", "block", "entered_by",
                          "response_time_s", "duration_s", "condition_code"])

    def test_the_command_says_what_to_do_next_in_lines_that_fit(self):
        printed = self.jnd("export", "tutorial.sqlite", "--to", "said").stdout
        self.assertEqual(printed.splitlines(), [
            f"said: {len([path for path in (self.folder / 'said').rglob('*') if path.is_file()]) - 1} files of simulated data",
            "  trials.csv, intervals.csv, estimates.csv, group.csv, contrasts.csv, ...",
            "  dictionary.csv and datapackage.json say what every column is",
            "  to compute the results again, in that folder:",
            '    R:       source("recompute.R")',
            "    Python:  python3 recompute.py"])
        self.assertLessEqual(max(map(len, printed.splitlines())), 80)

    def test_the_sums_are_those_of_the_files(self):
        folder = self.exports["tutorial"]
        lines = [line.split("  ") for line in (folder / "SHA256SUMS").read_text().splitlines() if not line.startswith("#")]
        self.assertEqual({name for _, name in lines} | {"SHA256SUMS"},
                         {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()})
        for digest, name in lines:
            self.assertEqual(digest, hashlib.sha256((folder / name).read_bytes()).hexdigest(), name)

    # The scripts.

    def variants(self):
        """The tutorial with two series, its answers analysed by every method that is registered in closed form; exclusions, tests on
        the JND and on delivered stiffness among them."""
        found = {}
        for name, analysis in {"weighted": {"jnd": "weighted", "tests": {"on": "jnd", "post_hoc": "wilcoxon"}},
                               "slopes": {"jnd": "inverse_mean_slope", "correction": "half", "stiffness": "delivered"},
                               "ratios": {"jnd": "mean_of_ratios", "tests": {"on": "log-jnd"}},
                               "hierarchical": {"group": "hierarchical", "stiffness": "delivered"},
                               "likelihood": {"model": "differencing", "jnd": "ml", "correction": "none"},
                               "independent": {"model": "independent-observation",
                                               "exclude": {"response_time_above_s": 1.3}}}.items():
            protocol = json.loads((program.ROOT / "protocols/tutorial.json").read_text())
            protocol["series"].append({"name": "hard", "pair": [600, 900]})
            protocol["analysis"].update(analysis)
            protocol["trial"]["explore_s"] = 0.5
            (self.folder / f"{name}.json").write_text(json.dumps(protocol))
            self.jnd("simulate", f"{name}.json", "--participants", 3, "--study", f"{name}.sqlite", "--seed", 5)
            found[name] = self.export(name)
        return found

    def test_the_scripts_compute_the_results_again(self):
        folders = {**self.exports, **self.variants()}
        explored = folders.pop("chinello2017-experiment2")  # it has questions, and nothing to compute again
        self.assertFalse((explored / "recompute.py").exists())
        for name, folder in folders.items():
            with self.subTest(name):
                status, printed = self.python(folder)
                self.assertEqual(status, 0, printed)
                self.assertIn("group.csv: from", printed)
                columns = [line for line in printed.splitlines() if line.startswith("  not computed: ")]
                if name == "tutorial":
                    self.assertIn("group.csv: from trials.csv", printed)
                    self.assertIn("contrasts.csv: from trials.csv", printed)
                    self.assertEqual(columns[:2], ["  not computed: missing",
                                                   "  not computed: missing, slope_*, jnd_*, weber_*"])
                if name == "hierarchical":
                    self.assertIn("hierarchical_ratios.csv: from hierarchical.csv", printed)
                if name == "likelihood":
                    self.assertIn("group.csv: from the participants' estimates in estimates.csv", printed)
                if name in ("hierarchical", "likelihood", "independent", "staircase", "leib2015", "pang1991"):
                    self.assertRegex(printed, r"  ln L is -\d+\.\d{5}; \d+ small steps of the estimates add -")
        if R is None:
            print("SKIPPED: recompute.R, there is no Rscript here (Debian's r-base-core)", file=sys.stderr)
            return
        # All in one R, which takes longer to start than to compute.
        sources = "; ".join(f"cat('{name}\\n'); source('{folder}/recompute.R')" for name, folder in folders.items())
        done = program.run("-e", sources, program=R)
        self.assertEqual(done.stdout.count(" 0 differ by more than 1e-09"), len(folders), done.stdout)

    def test_the_maximum_of_the_hierarchical_model_is_computed_again(self):
        protocol = json.loads((program.ROOT / "protocols/tutorial.json").read_text())
        protocol["series"].append({"name": "hard", "pair": [600, 900]})
        protocol["analysis"].update({"group": "hierarchical", "stiffness": "delivered"})
        protocol["trial"]["explore_s"] = 0.5
        (self.folder / "people.json").write_text(json.dumps(protocol))
        self.jnd("simulate", "people.json", "--participants", 6, "--study", "people.sqlite", "--seed", 3,
                 "--profile", "chinello2017-varied")
        folder = self.export("people")
        header, rows = rows_of(folder / "hierarchical.csv")
        self.assertEqual([rows[0][header.index(f"sd_{of}_status")] for of in ("persons", "persons_by_condition", "criterion")],
                         ["zero", "ok", "ok"])
        status, printed = self.python(folder)
        self.assertEqual(status, 0, printed)
        self.says(printed, "hierarchical.csv: from the trials, at its own estimates", "; 13 small steps of the estimates add -")
        for column, wrong in (("jnd", "mu of S: a step of -0.01 adds"), ("model_criterion", "kappa of S: a step of -0.01 adds"),
                              ("sd_persons_by_condition", "tv of S: a step of -0.01 adds"), ("log_likelihood", "log_likelihood: the file says")):
            with self.subTest(column):
                changed = [list(row) for row in rows]
                changed[0][header.index(column)] = repr(float(rows[0][header.index(column)]) * 1.05)
                with open(folder / "hierarchical.csv", "w", newline="") as out:
                    csv.writer(out, lineterminator="\n").writerows([header, *changed])
                status, printed = self.python(folder)
                self.assertEqual(status, 1, printed)
                self.assertIn(f"  DIFFERS: hierarchical.csv, {wrong}", printed)

    def scripts(self, folder):
        """What each script says of a folder: its status, and all that it prints."""
        for interpreter, script in ((sys.executable, "recompute.py"), (R, "recompute.R")):
            if interpreter:
                done = program.run(folder / script, program=interpreter, code=None)
                yield done.returncode, done.said

    def test_of_one_participant_the_scripts_compute_what_there_is(self):
        self.jnd("simulate", "tutorial", "--participants", 1, "--study", "alone.sqlite", "--seed", 2)
        for status, printed in self.scripts(self.export("alone")):
            self.assertEqual(status, 0, printed)
            self.assertRegex(printed, r"\d{2,} values compared, 0 differ")

    def test_a_folder_in_which_something_is_missing_is_not_called_right(self):
        missing, empty, nothing = (self.folder / name for name in ("missing", "empty", "nothing"))
        for folder in (missing, empty):
            shutil.copytree(self.exports["tutorial"], folder)
        (missing / "group.csv").unlink()
        header, _ = rows_of(empty / "cells.csv")
        (empty / "cells.csv").write_text(",".join(header) + "\n")
        nothing.mkdir()
        for script in ("recompute.py", "recompute.R"):
            shutil.copy(self.exports["tutorial"] / script, nothing)
        said = {missing: "group.csv is missing", empty: "cells.csv has no rows", nothing: "SHA256SUMS is missing"}
        for folder, words in said.items():
            status, printed = self.python(folder)
            self.assertEqual(status, 1, printed)
            self.assertIn(words, printed)
        if R is not None:  # all in one, which says of each that it is wrong, and why
            tried = "; ".join(f"tryCatch(source('{folder}/recompute.R'), error = function(e) cat('WRONG:', conditionMessage(e)))" for folder in said)
            printed = program.run("-e", tried, program=R).said
            self.says(printed, *said.values())
            self.assertEqual(printed.count("WRONG:"), 3, printed)

    def test_the_scripts_run_nothing_that_lies_beside_them(self):
        folder = self.folder / "my results"  # R writes a blank in another way
        shutil.copytree(self.exports["tutorial"], folder)
        for module in ("csv", "math", "os", "re", "statistics", "sys"):
            (folder / f"{module}.py").write_text(f"open({str(folder / 'RAN')!r}, 'w')")
        for status, printed in self.scripts(folder):
            self.assertEqual(status, 0, printed)
        self.assertFalse((folder / "RAN").exists())

    def test_rows_that_are_missing_are_counted(self):
        folder = self.folder / "rows"
        shutil.copytree(self.exports["tutorial"], folder)
        lines = (folder / "contrasts.csv").read_text().splitlines(keepends=True)
        (folder / "contrasts.csv").write_text("".join(lines[:-1]))
        for status, printed in self.scripts(folder):
            self.assertEqual(status, 1, printed)
            self.says(printed, f"{len(lines) - 2} of {len(lines) - 1} in contrasts.csv", "DIFFERS: the number of rows in contrasts.csv\n", " 0 differ")

    def test_a_changed_number_is_found(self):
        for file, column in (("group.csv", "mean"), ("contrasts.csv", "p"), ("cells.csv", "dprime")):
            with self.subTest(file):
                folder = self.folder / f"changed-{file}"
                shutil.copytree(self.exports["tutorial"], folder)
                header, rows = rows_of(folder / file)
                place = header.index(column)
                rows[0][place] = repr(float(rows[0][place]) * (1 + 3e-9))
                with open(folder / file, "w", newline="") as out:
                    csv.writer(out, lineterminator="\n").writerows([header, *rows])
                for status, printed in self.scripts(folder) if file == "group.csv" else [self.python(folder)]:
                    self.assertEqual(status, 1, printed)
                    self.assertRegex(printed, f"DIFFERS: .*{column}: the file says ")


if __name__ == "__main__":
    program.main()
