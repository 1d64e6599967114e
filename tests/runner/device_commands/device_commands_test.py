#!/usr/bin/env python3
"""`jnd device` from outside: shapes, numbers of an independent numpy model, exit codes, messages, CSV, the self-test."""
import csv
import io
import json
import math
import re
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

STRAIGHT, FLEXED = 0.35118101523050443, 0.9268769272168521

# Independent numpy model of the 3RRS platform; another geometry than the shipped one.
OTHER = {"a": 0.008, "b": 0.011, "bh": 0.005, "bd": 0.018, "l1": 0.012, "l2": 0.021, "pz0": -0.02}
SHIPPED_POSE = {"pz": -0.0160974, "roll": -0.467909, "pitch": 0.311164, "wrench": [-0.302, -1.14, -2.72, -0.00152, 0.0056, -0.00168],
                "stiffness": 500.0, "rotational": 0.5}
SHIPPED_ANSWER = {
    "yaw": -0.07472554743288265, "p": [0.0002449474357743492, 0.000710708796642817, -0.0160974],
    "q": [-0.07749344157334215, 0.6999248067748978, 0.012184721233283513],
    "tau": [-0.012106087227200224, -0.006710344008597964, -0.00766139049335361],
    "kq": [[0.379641161187032, -0.19399127790503226, 0.03397430471711391], [-0.1939912779050323, 0.20577450638659153, -0.1997798773558232],
           [0.03397430471711392, -0.19977987735582323, 0.37872195987136115]],
    "j_xi": [[80.75477623511838, -0.06965299908090929, -0.9541136685732828], [164.013108900416, -0.7558338215948566, 0.3805640489374622],
             [83.76955238085755, 0.6677165863558887, 0.6438644323666153]],
    "cond": 2.327397255666003, "det_ux": 0.024027696031843675}
OTHER_POSE = {"geometry": OTHER, "pz": -0.0169708, "roll": -0.358263, "pitch": -0.290926, "wrench": [1.52, 2.21, -9.96, 0.0142, -0.00367, -0.00347],
              "stiffness": 900.0, "rotational": 0.9}
OTHER_ANSWER = {
    "yaw": 0.05337353066203668, "p": [8.037520307998481e-05, -0.0005621707436199305, -0.0169708],
    "q": [0.485129357478596, 0.3121123595598787, -0.2868566976021978],
    "tau": [-0.03059493779566592, -0.042548634940668136, -0.025699274304473833],
    "cond": 1.7359840933708994, "det_ux": 0.025932371365016922}
# The same, of the McKibben finger: alpha1, then what the linkage and the muscle do there.
STATIC = (0.5759586531581288, {
    "theta1": 0.20514330070212144, "theta2": 0.6499783723438832, "beta": 0.2135162249340897, "l5": 0.0703170470627354,
    "stroke": 0.031082952937264607, "p": [0.07772965578704612, 0.0443589858317725], "kx": 0.2974247056182065, "kw": -0.7076917301643157,
    "length": 0.1309170470627354, "volume": 6.558503108927876e-05, "ka": 0.00020215810362800678, "off": -8.672283359025394, "f0": -9.592494318950436})
TRACK_PEAKS = {8: 3.45, 10: 4.43, 20: 9.35, 30: 14.26, 40: 19.18, 50: 24.09}  # N, KP 0.28, 0.5 Hz


def flat(value):
    return [number for part in value for number in flat(part)] if isinstance(value, list) else [value]


class DeviceCommands(program.Shared):
    def jnd(self, *arguments, code=0, **options):
        done = program.run("device", *arguments, code=code, folder=self.folder, **options)
        self.assertNotIn("\033", done.stdout)
        if code in (2, 3):
            self.assertNotEqual(done.stderr, "")
        return done

    def lines(self, *arguments, code=0, **options):
        return self.jnd(*arguments, code=code, **options).lines

    def one(self, *arguments, **options):
        answers = self.lines(*arguments, "--json", **options)
        self.assertEqual(len(answers), 1)
        return answers[0]

    def csv_of(self, *arguments):
        rows = list(csv.DictReader(io.StringIO(self.jnd(*arguments, "--csv", "-").stdout)))
        self.assertGreater(len(rows), 0)
        for row in rows:
            self.assertNotIn(None, row)
            self.assertNotIn(None, row.values())
        return rows

    def assert_near(self, found, expected, relative=1e-9, floor=1e-15):
        found, expected = flat(found), flat(expected)
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assertLessEqual(abs(a - b), relative * abs(b) + floor, f"{found} for {expected}")

    def test_every_command_has_an_example(self):
        for command in (("list",), ("info",), ("test",), ("calibrate",), ("model", "rrs3"), ("model", "mckibben"), ("step", "mckibben"), ("bode", "mckibben"),
                        ("track", "mckibben"), ("onset", "mckibben"), ("stiffness", "rrs3"), ("stiffness", "mckibben")):
            self.assertRegex(self.jnd(*command, "--help").stdout, r"Examples?:\n  jnd device " + command[0])

    def test_list_and_info_tell_what_the_descriptions_say(self):
        rigs = {rig["name"]: rig for rig in self.one("list")["rigs"]}
        self.assertEqual(set(rigs), {"rrs3", "mckibben", "rrs3+mckibben"})
        for name, rig in rigs.items():
            self.assertEqual(self.one("info", name), rig)
            self.assertRegex(rig["sha256"], "^[0-9a-f]{64}$")
            text = self.jnd("info", name).stdout
            self.assertIn(rig["sha256"], text)
            self.assertIn(name, self.jnd("list").stdout)
        self.assertEqual(len(rigs["rrs3+mckibben"]["devices"]), 2)
        platform = rigs["rrs3"]["devices"][0]
        self.assertEqual(platform["limits"]["max_force_n"], 4.7)
        self.assertEqual(platform["geometry"]["l2_m"], 0.02)
        self.assertIn("4.7 N", self.jnd("info", "rrs3").stdout)
        joint = rigs["mckibben"]["devices"][0]
        self.assertEqual((joint["finger"]["g2_m"], joint["tendon"]), (0.013, "unilateral"))
        self.assertIn("rrs3", self.jnd("info", "nothing", code=3).stderr)

    def test_real_devices_that_are_not_there(self):
        # Whatever machine this runs on, none of ours is connected to it.
        answer = self.one("list")
        self.assertEqual([device for device in answer["hid"] if device["ours"]], [])
        for device in answer["hid"]:
            self.assertLessEqual({"path", "vendor", "product", "name", "serial", "usage_page", "usage", "usable"}, set(device))
            self.assertEqual("udev_rule" in device, not device["usable"])
        text = self.jnd("list").stdout
        self.assertIn("Connected", text)
        if not answer["hid"]:
            self.assertIn("No HID device is connected", text)
        for command in ("info", "test"):
            for name in ("FT-0001", "/dev/hidraw999"):
                message = self.jnd(command, name, code=3).stderr
                self.assertIn(f"no rig '{name}'", message)
                self.assertIn("connected: none", message)
                self.assertEqual(len(message.splitlines()), 1)
        self.jnd("test", "FT-0001", "--yes", "--json", code=3)

    def test_doctor_looks_for_the_tracker_of_a_protocol(self):
        doctor = lambda *arguments, code=None: program.run("doctor", *arguments, folder=self.folder, code=code)
        program.run("new", "with_hand.json", "--from", "tutorial", folder=self.folder)
        text = self.read("with_hand.json")
        self.assertEqual(text.count('"tracker": "hand"'), 1)
        self.write("with_hid.json", text.replace('"tracker": "hand"', '"tracker": "hid"'))
        for name, verdict in (("with_hand.json", "ok"), ("with_hid.json", "bad")):
            done = doctor("--seconds", "0.1", "--json", "--protocol", name)
            report = done.json
            tracker = [check for check in report["checks"] if check["name"] == "tracker"]
            self.assertEqual([check["verdict"] for check in tracker], [verdict])
            # Whatever the machine does meanwhile: a rehearsal was presented, and what it lost is said.
            rehearsal = report["rehearsal"]
            self.assertGreaterEqual(rehearsal["presentations"], 1)
            self.assertGreater(rehearsal["ticks"], 0)
            said = next(check for check in report["checks"] if check["name"] == "rehearsal")
            self.assertIn(f"{rehearsal['gaps']} of {rehearsal['presentations']} presentation", said["found"])
            if rehearsal["gaps"]:
                self.assertEqual((said["verdict"], report["ok"]), ("bad", False))
            if verdict == "bad":
                self.assertEqual((done.returncode, report["ok"]), (1, False))
                self.assertIn("none is connected", tracker[0]["found"])
        # And what the laboratory's rig file names: devices that are not there, a program that is.
        self.write("with_program.json", text.replace('"tracker": "hand"', '"tracker": "process"'))
        self.write("booth.json", {"format": 1, "title": "Booth", "devices": [{"finger": "thumb", "serial": "FT-1"}], "tracker": {"command": ["sh", "bridge.sh"]}})
        done = doctor("--seconds", "0.1", "--json", "--protocol", "with_program.json", "--rig", "booth.json")
        found = {check["name"]: check for check in done.json["checks"]}
        self.assertEqual((found["tracker"]["verdict"], found["devices"]["verdict"], done.returncode), ("ok", "bad", 1))
        self.assertEqual(found["devices"]["found"], "not connected: FT-1 (thumb)")
        doctor("--protocol", "nowhere.json", code=3)
        # A protocol that no session takes, doctor does not take either.
        self.write("with_ghost.json", re.sub(r'"sphere_radius_m": [0-9.]+', '"object": "ghost"', text))
        self.assertIn("no object called 'ghost' is shipped", doctor("--seconds", "0.1", "--protocol", "with_ghost.json", code=3).stderr)

    def test_a_name_that_cannot_be_is_said_before_anybody_presses_a_button(self):
        name = "f" * 300
        self.assertIn(f"{name}: cannot be written: File name too long", self.jnd("learn-buttons", "--to", name, code=5).stderr)

    def test_calibrate_refuses_before_it_looks_for_a_device(self):
        who = ("--operator", "A. Smith", "--reference-name", "scale 17")
        self.assertIn("connected: none", self.jnd("calibrate", "FT-0001", *who, "--yes", code=3).stderr)
        self.jnd("calibrate", "FT-0001", code=2)  # without a name of who signs
        self.jnd("calibrate", *who, code=2)
        for push, code in (("1,2", 2), ("1,2,0", 2), ("1,2,x", 2), ("1,2,inf", 2), ("1,2,-3", 2)):
            self.jnd("calibrate", "FT-0001", *who, "--push", push, "--yes", code=code)
        for name, text, code in (("few.csv", "known_n\n1\n2\n", 3), ("odd.csv", "newtons\n1\n2\n3\n", 3), ("bad.csv", "known_n\n1\nx\n3\n", 3),
                                 ("negative.csv", "known_n,pushed_n\n1,1\n2,2\n3,-3\n", 3)):
            self.write(name, text)
            self.assertIn(name, self.jnd("calibrate", "FT-0001", *who, "--reference", name, "--yes", code=code).stderr)
        self.jnd("calibrate", "FT-0001", *who, "--reference", "nowhere.csv", "--yes", code=3)
        self.write("good.csv", "known_n,pushed_n\n1,1\n2,2\n3,3\n")
        self.assertIn("connected: none", self.jnd("calibrate", "FT-0001", *who, "--reference", "good.csv", "--yes", code=3).stderr)
        self.jnd("calibrate", "FT-0001", *who, "--reference", "good.csv", "--push", "1,2,3", "--yes", code=2)
        self.assertIn("exists already", self.jnd("calibrate", "FT-0001", *who, "--out", "good.csv", "--yes", code=2).stderr)

    def test_model_of_the_platform(self):
        wrench = ",".join(map(str, SHIPPED_POSE["wrench"]))
        pose = f"{SHIPPED_POSE['pz']},{SHIPPED_POSE['roll']},{SHIPPED_POSE['pitch']}"
        answer = self.one("model", "rrs3", "--pose", pose, "--wrench", wrench, "--stiffness", 500, "--rotational", 0.5)
        self.assertEqual(set(answer), {"yaw", "p", "b", "d", "q", "j_chi", "j_xi", "h", "tau", "kq", "cond", "det_ux"})
        self.assertEqual([len(answer["h"]), len(answer["h"][0]), len(answer["b"]), len(answer["d"][0])], [6, 3, 3, 3])
        for key, expected in SHIPPED_ANSWER.items():
            self.assert_near(answer[key], expected)
        # kphi is kS in N mm/rad where nothing else is said.
        self.assertEqual(answer, self.one("model", "rrs3", "--pose", pose, "--wrench", wrench, "--stiffness", 500))
        text = self.jnd("model", "rrs3", "--pose", pose, "--stiffness", 500).stdout
        self.assertIn("2.3274", text)
        self.assertIn("deg", text)

    def test_geometry_from_a_file(self):
        self.write("other.json", OTHER)
        answer = self.one("model", "rrs3", "--geometry", "other.json", f"--pose={OTHER_POSE['pz']},{OTHER_POSE['roll']},{OTHER_POSE['pitch']}")
        self.assert_near(answer["q"], OTHER_ANSWER["q"])
        self.write("bad.json", '{"a": -1}')
        self.assertIn("bad.json:1", self.jnd("model", "rrs3", "--geometry", "bad.json", "--pose", "-0.02,0,0", code=3).stderr)

    def test_batch(self):
        unreachable = {"pz": -0.034, "roll": 0, "pitch": 0}
        questions = [SHIPPED_POSE, unreachable, OTHER_POSE]
        text = "\n\n".join(map(json.dumps, questions)) + "\n"
        self.write("poses.jsonl", text)
        answers = self.lines("model", "rrs3", "--batch", "poses.jsonl")
        self.assertEqual([a["status"] for a in answers], ["ok", "unreachable", "ok"])
        self.assertEqual(answers[1], {"status": "unreachable"})
        for answer, expected in ((answers[0], SHIPPED_ANSWER), (answers[2], OTHER_ANSWER)):
            for key, value in expected.items():
                self.assert_near(answer[key], value)
        self.assertEqual(answers, self.lines("model", "rrs3", "--batch", "-", input=text))

    def test_a_bad_line_of_a_batch_loses_no_other(self):
        bad = ['{"pz": -0.02, "roll": 0, "pitch": "flat"}', '{"pz": -0.02, "roll": 0', '{"pz": -0.02, "roll": 0, "pitch": 0, "wrench": [1, 2]}',
               '{"pz": -0.02, "rol": 0, "pitch": 0}', '{"pz": 1e999, "roll": 0, "pitch": 0}', '{"pz": NaN, "roll": 0, "pitch": 0}', "[]",
               '{"pz": -0.02, "roll": 0, "pitch": 0, "geometry": {"a": 0.006}}', '{"pz": -0.02, "roll": 0, "pitch": 0, "stiffness": -5}']
        good = json.dumps({"pz": -0.02, "roll": 0, "pitch": 0})
        text = good + "\n" + "\n".join(line + "\n" + good for line in bad)  # without a line feed at the end
        done = self.jnd("model", "rrs3", "--batch", "-", input=text, code=3)
        answers = done.lines
        self.assertEqual([a["status"] for a in answers], ["ok"] + ["invalid", "ok"] * len(bad))
        for number in range(2, 2 * len(bad) + 1, 2):
            self.assertEqual(answers[number - 1]["line"], number)
            self.assertIn(f"standard input:{number}:", done.stderr)
        self.assertIn("roll", answers[7]["message"])

    def test_what_the_platform_refuses(self):
        for pose, code in (("-0.034,0,0", 3), ("-0.02,9,0", 3), ("-0.02,0", 2), ("-0.02,0,0,0", 2), ("nan,0,0", 2), ("inf,0,0", 2), ("a,b,c", 2),
                           ("-0.02,,0", 2), ("1e999,0,0", 2)):
            message = self.jnd("model", "rrs3", "--pose=" + pose, "--json", code=code)
            self.assertEqual(message.stdout, "")
            self.assertEqual(len([line for line in message.stderr.splitlines() if "more:" not in line]), 1, message.stderr)
        self.assertIn("3: give", self.jnd("model", "rrs3", "--pose=0.1,0.2", code=2).stderr)
        self.jnd("model", "rrs3", "--pose=-0.02,0,0", "--wrench", "1,2,3", code=2)
        self.jnd("model", "rrs3", "--pose=-0.02,0,0", "--stiffness=-1", code=3)
        self.jnd("model", "rrs3", code=2)
        self.jnd("model", "rrs3", "--pose=-0.02,0,0", "--map", code=2)
        self.jnd("model", "rrs3", "--batch", "nowhere.jsonl", code=3)

    def test_map(self):
        rows = self.csv_of("model", "rrs3", "--map")
        conditions = [float(row["condition"]) for row in rows if row["reachable"] == "1"]
        self.assertEqual(len(rows), 25 * 37)
        self.assertAlmostEqual(min(conditions), math.sqrt(2), places=9)  # at rest
        picture = self.jnd("model", "rrs3", "--map").stdout
        self.assertIn("pitch (deg)", picture)
        self.assertIn("96.3 %", picture)
        self.assertTrue(picture.isascii())
        answer = self.one("model", "rrs3", "--map")
        self.assertEqual((len(answer["roll"]), len(answer["cond"]), len(answer["cond"][0])), (25, 25, 37))
        self.assertAlmostEqual(answer["reachable_share"], 0.963, delta=0.005)

    def test_model_of_the_finger(self):
        angle, expected = STATIC
        answer = self.one("model", "mckibben", "--angle", angle)
        self.assertEqual(set(answer), set(expected))
        for key, value in expected.items():
            self.assert_near(answer[key], value)
        self.assertAlmostEqual(self.one("model", "mckibben", "--pressure", 200000, "--length", 0.1028)["force"], -21.955495854400333, places=9)
        self.assertAlmostEqual(self.one("model", "mckibben", "--pressure", 50000, "--length", 0.1207)["force"], 4.755336174241149, places=9)
        for upstream, muscle, flow in ((500000, 150000, 0.0030975), (200000, 190000, 0.0004912690500069792), (101325, 400000, -0.0024779999999999997)):
            self.assert_near(self.one("model", "mckibben", "--upstream", upstream, "--muscle", muscle)["flow"], flow)
        self.assertIn("33.000 deg", self.jnd("model", "mckibben", "--angle", angle).stdout)
        sweep = self.csv_of("model", "mckibben", "--sweep")
        self.assertAlmostEqual(float(sweep[0]["off_n"]), -14.165, places=3)
        self.assertAlmostEqual(float(sweep[0]["ka_n_per_pa"]) * 1e5, 15.962, places=3)
        for arguments, code in ((("--angle", 3.1), 3), (("--angle", "nan"), 2), (("--pressure", 1e5), 2), (("--length", 0.1, "--pressure", "inf"), 2),
                                (("--length", 0.2, "--pressure", 1e5), 3), (("--upstream", 0, "--muscle", 1e5), 3), ((), 2)):
            self.jnd("model", "mckibben", *arguments, "--json", code=code)

    def test_step(self):
        step = self.one("step", "mckibben", "--kp", 0.7, "--from", 0, "--to", 5, "--angle", STRAIGHT)
        self.assertLessEqual({"t", "force", "f_start", "f_final", "e_ss", "overshoot_pct", "oscillation_pp", "oscillation_rad_s", "verdict"}, set(step))
        self.assertAlmostEqual(step["f_start"], -1.1636336492773742, delta=1e-6)
        self.assertAlmostEqual(step["f_final"], 3.4256258390873433, delta=1e-6)
        self.assertAlmostEqual(step["e_ss"], 1.5743741609126567, delta=1e-6)
        self.assertAlmostEqual(step["overshoot_pct"], 60.89, delta=1)
        self.assertEqual(step["verdict"], "stable")
        self.assertAlmostEqual(step["t"][-1], 1.2)
        for time, force in ((0.01, 0.49263), (0.05, 3.73737), (0.2, 3.42378)):
            self.assertAlmostEqual(step["force"][step["t"].index(time)], force, delta=0.01)
        cycle = self.one("step", "mckibben", "--kp", 3, "--angle", STRAIGHT)
        self.assertEqual(cycle["verdict"], "limit cycle")
        self.assertAlmostEqual(cycle["oscillation_pp"] / 2.4683, 1, delta=0.05)
        self.assertAlmostEqual(cycle["oscillation_rad_s"] / 185.4, 1, delta=0.05)
        rows = self.csv_of("step", "mckibben", "--kp", 0.7)
        self.assert_near([float(row["force_n"]) for row in rows], step["force"])
        text = self.jnd("step", "mckibben", "--kp", 0.7).stdout
        self.assertIn("time (s)", text)
        self.assertIn("20.121 deg", text)
        own = self.one("step", "mckibben", "--kp", 0.1, "--ki", 3, "--tendon", "unilateral")
        self.assertLess(abs(own["e_ss"]), 1e-6)  # an integral gain leaves no error
        for arguments, code in ((("--angle", 3), 3), (("--kp", "-1"), 3), (("--kp", "nan"), 2), (("--to", "inf"), 2), (("--tendon", "rubber"), 2),
                                (("--duration", "-1"), 3), (("--angle", "straight"), 2), (("--from", 5, "--to", 5), 3)):
            self.jnd("step", "mckibben", *arguments, "--json", code=code)
        self.assertIn("mckibben", self.jnd("step").stdout)  # alone a group prints its help
        self.jnd("step", "mckibben", "--spec", "rrs3", code=2)

    def test_bode(self):
        command = ("bode", "mckibben", "--kp", 0.7, "--mean", 10, "--amplitude", 8, "--angle", STRAIGHT, "--frequencies", "20,40,80,160")
        answer = self.one(*command)  # the independent model's window: six cycles pass, three are measured
        self.assertEqual(answer["frequency"], [20, 40, 80, 160])
        self.assert_near(answer["magnitude"], [0.9316, 1.0026, 0.6424, 0.2406], 0.01)
        self.assert_near(answer["phase"], [-0.0755, -0.3113, -2.1949, -3.0077], 0, 0.02)
        self.assertAlmostEqual(answer["dc"], 0.9178518976729435, places=9)
        self.assertEqual((answer["amplitude"], answer["mean"]), (8, 10))
        self.assertEqual(answer, self.one(*command, "--settle", 6, "--measure", 3))
        # Above the bandwidth the muscle's mean pressure drifts for longer than that.
        later = self.one(*command, "--settle", 200, "--measure", 20)
        self.assert_near(later["magnitude"][:3], [0.9316, 1.0026, 0.6424], 0.01)
        self.assertAlmostEqual(later["magnitude"][3], 0.230, delta=0.001)
        self.assertAlmostEqual(answer["bandwidth"], 79, delta=1)
        rows = self.csv_of("bode", "mckibben", "--kp", 0.7)
        self.assertEqual((float(rows[0]["frequency_rad_per_s"]), float(rows[-1]["frequency_rad_per_s"])), (1, 1000))
        text = self.jnd("bode", "mckibben", "--kp", 0.7, "--amplitude", 8).stdout
        self.assertIn("phase (deg)", text)
        self.assertIn("bandwidth", text)
        self.jnd("bode", "mckibben", "--frequencies", "0,10", code=3)
        self.jnd("bode", "mckibben", "--frequencies", "1,x", code=2)

    def test_track(self):
        answers = self.lines("track", "mckibben", "--kobj", ",".join(map(str, TRACK_PEAKS)), "--kp", 0.28, "--frequency", 0.5, "--json")
        for answer, (kobj, peak) in zip(answers, TRACK_PEAKS.items()):
            self.assertLessEqual({"force_peak", "force_min", "rms_error", "reference_peak"}, set(answer))
            self.assertAlmostEqual(answer["force_peak"], peak, delta=0.01)
            self.assertAlmostEqual(answer["reference_peak"], kobj * (FLEXED - STRAIGHT), places=6)
        self.assertAlmostEqual(answers[0]["force_min"], -2.5937074853749262, delta=0.01)
        self.assertAlmostEqual(answers[0]["rms_error"], 1.7127401772671897, delta=0.01)
        self.assertEqual(len(self.csv_of("track", "mckibben", "--kobj", "8,50")), 2)
        self.assertIn("24.091", self.jnd("track", "mckibben", "--kobj", 50).stdout)
        self.jnd("track", "mckibben", code=2)
        self.jnd("track", "mckibben", "--kobj", "8,nan", code=2)

    def test_onset(self):
        for answer, expected in zip(self.lines("onset", "mckibben", "--angle", f"{STRAIGHT},0.6108652381980153,{FLEXED}", "--json"),
                                    (1.263029496347464, 0.978593781204628, 0.9672362704776716)):
            self.assertAlmostEqual(answer["kp_onset"], expected, delta=0.06)
            self.assertAlmostEqual(answer["kp_theory"], expected, places=6)
            self.assertTrue(20 < answer["loop_gain"] < 21)
        self.assertEqual(len(self.csv_of("onset", "mckibben")), 6)
        self.assertIn("20.16", self.jnd("onset", "mckibben", "--angle", STRAIGHT).stdout)
        self.jnd("onset", "mckibben", "--angle", 3.1, code=3)

    def test_stiffness_of_the_platform(self):
        for mode, expected in (("wrench", (500, 900)), ("pd", (500 / 1.5, 900 / 1.9))):
            answers = self.lines("stiffness", "rrs3", "--stiffness", "500,900", "--mode", mode, "--finger", 1000, "--json")
            for answer, asked, value in zip(answers, (500, 900), expected):
                self.assertEqual((answer["mode"], answer["asked"]), (mode, asked))
                self.assertAlmostEqual(answer["expected"], value, places=6)
                self.assertAlmostEqual(answer["rendered"] / value, 1, delta=0.005)
        literal = self.one("stiffness", "rrs3", "--stiffness", 500, "--mode", "pd-literal")
        self.assertAlmostEqual(literal["rendered"] / literal["expected"], 1.038, delta=0.005)  # the error of (36) as printed
        self.assertEqual(len(self.csv_of("stiffness", "rrs3", "--stiffness", "500,900")), 20)
        self.assertIn("depth in the virtual surface", self.jnd("stiffness", "rrs3", "--stiffness", 500).stdout)
        for arguments, code in ((("--stiffness", 0), 3), (("--stiffness", 1e6), 3), (("--stiffness", "nan"), 2), (("--stiffness", 500, "--mode", "x"), 2),
                                (("--stiffness", 500, "--finger", 1), 3), ((), 2)):
            self.jnd("stiffness", "rrs3", *arguments, code=code)

    def test_stiffness_of_the_finger(self):
        paper, own = self.lines("stiffness", "mckibben", "--stiffness", 8, "--json")
        self.assertEqual((paper["kp"], paper["ki"]), (0.28, 0))
        self.assertAlmostEqual(paper["rendered"] / 8, 0.64, delta=0.01)
        self.assertAlmostEqual(own["rendered"] / 8, 1, delta=0.01)
        given = self.one("stiffness", "mckibben", "--stiffness", 8, "--kp", 0.28, "--tendon", "bilateral")
        self.assertEqual((given["tendon"], given["control"]), ("bilateral", "as given"))
        self.assertNotEqual(given["rendered"], paper["rendered"])
        self.assertEqual(len(self.csv_of("stiffness", "mckibben", "--stiffness", "8,50")), 4)
        self.jnd("stiffness", "mckibben", "--stiffness", 0, code=3)

    def test_self_tests_measure_and_pass(self):
        for rig in ("rrs3", "mckibben", "rrs3+mckibben"):
            report = self.one("test", rig)
            self.assertEqual((report["rig"], report["ok"]), (rig, True))
            for check in report["checks"]:
                self.assertEqual(set(check), {"device", "what", "measured", "expected", "ok"})
                self.assertTrue(check["ok"], check)
            text = self.jnd("test", rig).stdout
            self.assertEqual(text.count(" ok\n"), len(report["checks"]) + 1)
            whats = " ".join(check["what"] for check in report["checks"])
            self.says(whats, "force cap", "soft start", "watchdog", "not a number", "emergency stop", "tracker lost", "neutral")

    def changed_spec(self, name, change):
        spec = json.loads(self.read(self.one("info", name)["file"]))
        change(spec)
        return self.write(f"changed-{name}.json", spec)

    def test_self_tests_can_fail(self):
        # An oscillating controller, and a range that is not the linkage's.
        def spoil_control(spec):
            spec["control"] = {"kp": 2.0, "ki": 0, "kd": 0}
        done = self.jnd("test", self.changed_spec("mckibben", spoil_control), code=4)
        self.assertRegex(done.stdout, "step to 5 N.*FAILED")
        self.assertIn("do not use this rig", done.stdout)

        def spoil_geometry(spec):
            spec["geometry"]["l2_m"] = 0.017
        done = self.jnd("test", self.changed_spec("rrs3", spoil_geometry), "--json", code=4)
        report = done.json
        self.assertFalse(report["ok"])
        self.assertIn("stroke, roll and pitch, one at a time", [check["what"] for check in report["checks"] if not check["ok"]])

    def test_csv_files_are_written_once(self):
        command = ("track", "mckibben", "--kobj", 8, "--csv", "track.csv")
        self.assertIn("tracking", self.jnd(*command).stdout)
        self.assertEqual(len(self.rows("track.csv")), 1)
        self.assertIn("exists already", self.jnd(*command, code=2).stderr)
        self.jnd("track", "mckibben", "--kobj", 8, "--csv", "no/folder/here.csv", code=5)
        self.jnd("track", "mckibben", "--kobj", 8, "--csv", "-", "--json", code=2)


if __name__ == "__main__":
    program.main()
