#!/usr/bin/env python3
"""jnd device test external: every shipped example passes, and a rig with a mistake is told it.

Usage: external_rigs_test.py JND RIG_LOOP"""
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import fake_services

JND, RIG_LOOP = map(os.path.abspath, sys.argv[1:3])
EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "devices/external/examples"
PROTOCOLS = pathlib.Path(__file__).resolve().parents[3] / "protocols"
FAILURES = []
AT_ONCE = 4  # they mostly wait
# 100 ms of silence are a fault, and on a machine that is busy with other things they happen: then once more.
ATTEMPTS = 6
LONG_S = 60
# A rig that never flushes is one of the mistakes.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}


def check(ok, what):
    if not ok:
        FAILURES.append(what)
        print("FAILED:", what)


def run(*arguments):
    return subprocess.run([JND, "device", "test", "external", *arguments], capture_output=True, text=True, timeout=300,
                          env=ENVIRONMENT)


def tested(rig, folder, **more):
    """The JSON of a test of the rig file with this `external`."""
    path = pathlib.Path(folder) / "rig.json"
    path.write_text(json.dumps({"format": 1, "title": "Test", "external": {**rig, **more}}), encoding="utf-8")
    done = run("--rig", str(path), "--json")
    result = json.loads(done.stdout)
    check((done.returncode == 0) == result["ok"] and done.returncode in (0, 4), f"exit code {done.returncode}")
    check([entry["number"] for entry in result["checks"]] == list(range(1, len(result["checks"]) + 1)), "numbers")
    return result


def failed(result):
    return [entry["what"] for entry in result["checks"] if not entry["ok"]]


def passes(command, folder):
    for _ in range(ATTEMPTS):
        result = tested({"command": command, "hello_s": LONG_S}, folder)
        if result["ok"]:
            break
    check(result["ok"], f"{command} passes: {[entry for entry in result['checks'] if not entry['ok']]}")
    check(len([entry for entry in result["checks"] if entry["judged"]]) >= 15, f"{command}: everything is judged")
    return result


def check_bridges(folder):
    """Against what stands in for the makers' services. Each must take the force away, and say why its service is lost."""
    firmware = fake_services.FakeFirmware()
    command = ["python3", str(EXAMPLES / "serial_rig.py"), firmware.path, "--model"]
    passes(command, folder)
    check(b"r 100.000" in firmware.commands and b"r 1000.000" in firmware.commands and firmware.commands[-1] == b"0",
          f"the firmware was told: {firmware.commands[-4:]}")
    firmware.mute = True
    result = tested({"command": command, "hello_s": 2}, folder)
    check("hello" in failed(result), "without its firmware there is no rig")

    service = fake_services.FakeInverse()
    command = ["python3", str(EXAMPLES / "haply_rig.py"), "--port", str(service.port), "--model"]
    result = passes(command, folder)
    check(result["rig"] == "Haply Inverse3", "the rig is named")
    check(service.first["session"]["configure"]["profile"]["name"] == "jnd", "the session has a name")
    check(0 < max(service.forces) <= 8 and min(service.forces) == 0, f"forces to {max(service.forces)} N")
    service.mute = True
    result = tested({"command": command}, folder)
    check(not result["ok"], "a silent service is a fault")
    service.listening.close()
    result = tested({"command": ["python3", str(EXAMPLES / "haply_rig.py"), "--port", "1"],
                     "hello_s": LONG_S}, folder)
    hello = next(entry for entry in result["checks"] if entry["what"] == "hello")
    check("refused" in hello["measured"], f"why there is no service: {hello['measured']}")


def check_weart(folder):
    middleware = fake_services.FakeWeart()
    certificate = pathlib.Path(folder) / "certificate.json"
    command = ["python3", str(EXAMPLES / "weart_rig.py"), "--port", str(middleware.port), "--model", "--certificate",
               str(certificate)]
    good = {"format": 1, "serial": "TD-1", "hand": "right", "finger": "index", "calibrated": "2026-03-01",
            "points": [[0, 0], [0.25, 0.9], [0.5, 2.1], [1, 4.3]]}
    for wrong in (None, {**good, "calibrated": ""}, {**good, "points": [[0, 0], [1, 4]]},
                  {**good, "points": [[0, 0], [0.5, 2], [1, 1]]}, {**good, "points": [[0, 0], [0.5, 2], [1.5, 4]]}):
        certificate.unlink(missing_ok=True)
        if wrong is not None:
            certificate.write_text(json.dumps(wrong), encoding="utf-8")
        result = tested({"command": command, "hello_s": LONG_S}, folder)
        hello = next(entry for entry in result["checks"] if entry["what"] == "hello")
        check(not hello["ok"] and "no certificate of calibration" in hello["measured"], f"{wrong}: {hello['measured']}")
    check(not middleware.messages, "without a certificate nothing is said to the middleware")
    certificate.write_text(json.dumps(good), encoding="utf-8")
    passes(command, folder)
    forces = [message for message in middleware.messages if message.startswith("force:")]
    check(forces[:2] == [f"force:{command}:0.000000:0.000000:RIGHT:INDEX" for command in ("0.000000", "1.000000")],
          f"the lowest and the highest force: {forces[:2]}")
    check(middleware.messages[0] == "StartFromClient" and middleware.messages[-1] == "stopForce:RIGHT:INDEX",
          "it starts, and ends without force")


def check_hostile_text(folder):
    """Nothing that a rig says reaches a terminal as it is."""
    text = (EXAMPLES / "plain_rig.py").read_text(encoding="utf-8")
    hostile = "\\x1b]0;owned\\x07\\x1b[2J\\u202e\\u200b\\r"
    path = pathlib.Path(folder) / "hostile_text_rig.py"
    for before, after in [('"name": "Plain rig"', f'"name": "{hostile}"'), ('"unit": "N/m"', f'"unit": "{hostile[:20]}"'),
                          ('["thumb", "index"]', f'["{hostile}"]'), ('"name": "force"', f'"name": "{hostile}"'),
                          ('say("alive", n=message["n"])', f'sys.exit("{hostile}")'),
                          ('cause=problem(hello, message) or "busy"', f'cause="{hostile}"')]:
        check(text.count(before) >= 1, f"{before!r} is there")
        path.write_text(text.replace("import json\n", "import json\nimport sys\n").replace(before, after), encoding="utf-8")
        for options in ([], ["--json"]):
            done = run("--command", f"python3 {path}", *options)
            bad = [letter for letter in done.stdout + done.stderr
                   if (ord(letter) < 32 and letter != "\n") or 0x7f <= ord(letter) < 0xa0 or letter in "\u202e\u200b"]
            check(not bad, f"{after}: {bad[:5]} on the screen")
            check(done.returncode == 4, f"{after}: exit code {done.returncode}")


def check_other_commands(folder):
    """doctor starts an external rig and says what it is; a session does not run on one that no protocol asks for."""
    path = pathlib.Path(folder) / "rig.json"
    path.write_text(json.dumps({"format": 1, "title": "T", "external": {
        "command": ["python3", str(EXAMPLES / "plain_rig.py")], "hello_s": LONG_S}}), encoding="utf-8")
    doctor = [JND, "doctor", "--seconds", "0.1", "--json", "--rig", str(path)]
    checks = json.loads(subprocess.run(doctor, capture_output=True, text=True, timeout=300, env=ENVIRONMENT).stdout)["checks"]
    found = {entry["name"]: entry for entry in checks}
    check("stiffness 100 to 1000 N/m" in found["external rig: presents"]["found"], "doctor says what the rig presents")
    done = subprocess.run([*doctor, "--protocol", "tutorial"], capture_output=True, text=True, timeout=300, env=ENVIRONMENT)
    found = {entry["name"]: entry for entry in json.loads(done.stdout)["checks"]}
    check(found["external rig: protocol"]["verdict"] == "bad" and done.returncode == 1, "the protocol asks for another rig")
    asked = json.loads((PROTOCOLS / "studies/maereg2017.json").read_text(encoding="utf-8"))
    asked.update(assumed=[], levels={"absolute": [350, 450]}, conditions=[
        {"name": name, "label": name, "parameters": {"finger": name}} for name in ("thumb", "index")])
    asked["analysis"]["contrasts"] = []
    protocol = pathlib.Path(folder) / "asked.json"
    for levels, fits in (([350, 450], True), ([350, 4500], False)):
        asked["levels"] = {"absolute": levels}
        protocol.write_text(json.dumps(asked), encoding="utf-8")
        done = subprocess.run([*doctor, "--protocol", str(protocol)], capture_output=True, text=True, timeout=300, env=ENVIRONMENT)
        found = {entry["name"]: entry for entry in json.loads(done.stdout)["checks"]}
        check(found["external rig: protocol"]["verdict"] == ("ok" if fits else "bad"), f"doctor, {levels}: {found}")
        done = subprocess.run([JND, "check", str(protocol), "--rig", str(path)], capture_output=True, text=True, timeout=300,
                              env=ENVIRONMENT)
        check(done.returncode == (0 if fits else 3), f"check, {levels}: {done.stdout}{done.stderr}")
        check(("4500 N/m is out of the rig's range" in done.stdout) != fits, f"check, {levels}: {done.stdout}")
    done = subprocess.run([JND, "run", "tutorial", "--study", str(pathlib.Path(folder) / "s.sqlite"), "--participant", "P01",
                           "--rig", str(path)], capture_output=True, text=True, timeout=300, stdin=subprocess.DEVNULL)
    check(done.returncode == 3 and "an external rig is for protocols" in done.stderr, f"{done.returncode} {done.stderr}")


def check_mistake(folder, before, after, expected):
    """The plain rig with one line changed."""
    pathlib.Path(folder).mkdir()
    text = (EXAMPLES / "plain_rig.py").read_text(encoding="utf-8")
    check(text.count(before) == 1, f"{before!r} is there once")
    path = pathlib.Path(folder) / "mistaken_rig.py"
    path.write_text(text.replace(before, after), encoding="utf-8")
    hello_s = 3 if expected == "hello" else LONG_S
    for _ in range(ATTEMPTS):
        found = failed(tested({"command": ["python3", str(path)], "hello_s": hello_s, "prepare_s": 1}, folder))
        if expected in found:
            break
    check(expected in found, f"{after!r}: {expected} fails, and not only {found}")


MISTAKES = [  # what is changed into what, and a check that must fail
    ('say("alive", n=message["n"])', 'time.sleep(0.3)', "alive while it waits"),
    ('say("alive", n=message["n"])', 'say("alive", n=message["n"] + 1)', "alive while it waits"),
    ('"done", id=self.id,', '"done", id=self.id + 1,', "presents 100 N/m the lowest"),
    ('(going or problem(hello, message))', 'going', "refuses 10001 N/m"),
    ('say("fault", id=going.id, cause="jnd has fallen silent")', 'going = going', "lets go when the program is silent"),
    ('            elif kind == "bye":\n                return device.off()\n', '', "bye ends it"),
    ('                return device.off()  # jnd is gone\n', '                time.sleep(60)\n', "ends when its input does"),
    ('elif kind == "stop" and (going or prepared)', 'elif kind == "halt"', "stop ends a presentation"),
    ('(going or prepared).done("complete" if going and message["reason"] == "enough" else "stopped")',
     '(going or prepared).done("stopped")', 'stop with "enough" completes it'),
    ('            say("contact", id=self.id, time_s=now)\n', '', "tells its contacts"),
    ('duration_s=time.monotonic() - self.began', 'duration_s=time.monotonic() - self.began + 5',
     "presents 100 N/m the lowest"),
    ('"serial": "none"', '"serial": str(time.time())', "is the same rig"),
    ('"max": 1000', '"max": 10', "hello"),
    ('now - start >= self.how.get("duration_s", 0)', 'now - start >= 0.1', "explored from the first contact"),
    ('# What else comes is of a later version of jnd: let it pass.', 'elif kind.startswith("x"): raise SystemExit(1)',
     "lets an unknown message pass"),
    ('flush=True', 'flush=False', "hello"),
]


def main():
    with tempfile.TemporaryDirectory() as folder:
        result = passes(["python3", str(EXAMPLES / "plain_rig.py")], folder)
        check(result["rig"] == "Plain rig" and result["simulated"], "the rig is named")
        passes([RIG_LOOP], folder)
        check_bridges(folder)
        check_weart(folder)
        check_hostile_text(folder)
        check_other_commands(folder)
        with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
            for done in [pool.submit(check_mistake, f"{folder}/{number}", *mistake)
                         for number, mistake in enumerate(MISTAKES)]:
                done.result()
        # What cannot be asked.
        for arguments, words in [((), "needs --rig FILE or --command"), (("--rig", "a", "--command", "b"), "one of the two"),
                                 (("--command", "  "), "names no program")]:
            done = run(*arguments)
            check(done.returncode == 2 and words in done.stderr, f"{arguments}: {done.returncode} {done.stderr}")
        path = pathlib.Path(folder) / "none.json"
        path.write_text('{"format": 1, "title": "No external rig"}', encoding="utf-8")
        done = run("--rig", str(path))
        check(done.returncode == 3 and 'it has no "external"' in done.stderr, f"{done.returncode} {done.stderr}")
        for external, words in [({}, "says nowhere where the rig is"), ({"command": ["a"], "port": 1}, "more than one place"),
                                ({"port": 70000}, "$.external.port"), ({"command": [""]}, "empty word")]:
            path.write_text(json.dumps({"format": 1, "title": "T", "external": external}), encoding="utf-8")
            done = run("--rig", str(path))
            check(done.returncode == 3 and words in done.stderr, f"{external}: {done.returncode} {done.stderr}")
        done = subprocess.run([JND, "device", "test", "rrs3", "--command", "a"], capture_output=True, text=True, timeout=60)
        check(done.returncode == 2 and "jnd device test external" in done.stderr, done.stderr)
    print("FAILED" if FAILURES else "all examples pass, and every mistake is told")
    sys.exit(1 if FAILURES else 0)


if __name__ == "__main__":
    main()
