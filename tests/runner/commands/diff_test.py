#!/usr/bin/env python3
"""jnd diff: what differs between two protocols, whether they mean the same, and whether their plans do."""
import json
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program


class Diff(program.Case):
    def setUp(self):
        self.jnd("new", "a.json", "--from", "tutorial")
        self.protocol = json.loads(self.read("a.json"))

    def changed(self, **sections):
        """b.json, the protocol with other sections, which may be None: left out."""
        protocol = {key: value for key, value in (self.protocol | sections).items() if value is not None}
        self.write("b.json", json.dumps(protocol, indent=3, sort_keys=True))

    def test_other_blanks_and_another_order_of_members_mean_the_same(self):
        self.changed()
        self.assertIn("mean the same", self.jnd("diff", "a.json", "b.json").stdout)
        report = self.jnd("diff", "a.json", "b.json", "--json").json
        self.assertEqual((report["same_meaning"], report["same_plans"], report["changes"]), (True, True, []))

    def test_a_design_that_changes_the_trials_is_told_by_path_with_both_values(self):
        self.changed(design=self.protocol["design"] | {"trials_per_cell": 12}, title="Another")
        text = self.jnd("diff", "a.json", "b.json", code=1).stdout.splitlines()
        self.assertEqual(text[0], "$.design.trials_per_cell: 8 -> 12")
        self.assertEqual(text[1], "In what explains the protocol to its readers:")
        self.assertIn("$.title", text[2])
        self.assertIn("2 differences; the plans differ", text[3])
        report = self.jnd("diff", "a.json", "b.json", "--json", code=1).json
        self.assertFalse(report["same_meaning"])
        self.assertIs(report["same_plans"], False)
        self.assertIn({"path": "$.design.trials_per_cell", "change": "changed", "before": 8, "after": 12}, report["changes"])

    def test_a_change_that_leaves_every_plan_as_it_is(self):
        self.changed(trial=self.protocol["trial"] | {"explore_s": 2.5}, practice=self.protocol.get("practice"))
        text = self.jnd("diff", "a.json", "b.json", code=1).stdout
        self.assertIn("-> 2.5", text)
        self.assertIn("the plans are the same", text)

    def test_what_is_presented_may_change_where_its_place_in_the_plan_does_not(self):
        first, *others = self.protocol["conditions"]
        for change, differ in ((first | {"label": "another label"}, False), (first | {"cues": ["vibration"]}, True)):
            self.assertNotEqual(change, first)
            self.changed(conditions=[change, *others])
            self.assertIs(self.jnd("diff", "a.json", "b.json", "--json", code=1).json["same_plans"], not differ)

    def test_a_condition_that_is_inserted_in_front_is_one_difference(self):
        first = self.protocol["conditions"][0]
        self.changed(conditions=[first | {"name": "new", "label": "new"}, *self.protocol["conditions"]])
        report = self.jnd("diff", "a.json", "b.json", "--json", code=1).json
        self.assertEqual([(one["path"], one["change"]) for one in report["changes"]], [("$.conditions[0]", "added")])
        self.assertIn("1 difference;", self.jnd("diff", "a.json", "b.json", code=1).stdout)

    def test_another_order_of_conditions_is_another_plan(self):
        self.changed(conditions=self.protocol["conditions"][::-1])
        text = self.jnd("diff", "a.json", "b.json", code=1).stdout
        self.assertIn("$.conditions: the order ", text)
        self.assertIn("1 difference; the plans differ", text)

    def test_another_start_of_a_staircase_is_another_plan(self):
        self.jnd("new", "w.json", "--task", "which", "--procedure", "staircase")
        self.protocol = json.loads(self.read("w.json"))
        design = self.protocol["design"]
        procedure = design["procedure"]
        self.changed(design=design | {"procedure": procedure | {"starts": [value * 1.1 for value in procedure["starts"]]}})
        text = self.jnd("diff", "w.json", "b.json", code=1).stdout
        self.assertIn("$.design.procedure.starts[0]", text)
        self.assertIn("the plans differ", text)

    def test_what_was_added_and_removed_is_whole_in_json(self):
        question = {"id": "effort", "when": "after-session", "kind": "text", "text": "What was hard? \"Everything\", or \\ nothing?"}
        self.changed(questions=[question], instructions=None)
        changes = {one["path"]: one for one in self.jnd("diff", "a.json", "b.json", "--json", code=1).json["changes"]}
        removed = [one for path, one in changes.items() if path.startswith("$.instructions")]
        self.assertEqual([one["change"] for one in removed], ["removed"])
        self.assertIn(question["text"], json.dumps(list(changes.values()), ensure_ascii=False).replace('\\"', '"').replace("\\\\", "\\"))

    def test_a_protocol_with_mistakes_can_be_compared_but_not_its_plans(self):
        self.changed(design=self.protocol["design"] | {"trials_per_cel": 12})
        self.assertIn("cannot be compared", self.jnd("diff", "a.json", "b.json", code=1).stdout)
        self.assertIsNone(self.jnd("diff", "a.json", "b.json", "--json", code=1).json["same_plans"])

    def test_names_of_shipped_ones_and_files_that_are_none(self):
        self.jnd("diff", "tutorial", "a.json")
        self.write("broken.json", "{")
        self.jnd("diff", "a.json", "broken.json", code=3)
        self.jnd("diff", "a.json", "none.json", code=3)
        self.jnd("diff", "a.json", code=2)


if __name__ == "__main__":
    program.main()
