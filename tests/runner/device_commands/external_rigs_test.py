#!/usr/bin/env python3
"""jnd device test external: every shipped example passes, and a rig with a mistake is told it. Rigs have minutes for what they do
(patient_rig is the same command with other limits), but a mistake that only a limit finds has this limit, and no other.

Usage: external_rigs_test.py JND RIG_LOOP PATIENT_RIG"""
import concurrent.futures
import json
import os
import pathlib
import sys
import tempfile

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

import fake_services

RIG_LOOP, PATIENT = program.argument(), program.argument()
EXAMPLES = program.ROOT / "devices/external/examples"
PROTOCOLS = program.ROOT / "protocols"
FAILURES = []
AT_ONCE = 8  # they mostly wait
LONG_S = 600
os.environ.pop("PYTHONUNBUFFERED", None)  # a rig that never flushes is one of the mistakes


def check(ok, what):
    if not ok:
        FAILURES.append(what)
        print("FAILED:", what)


def run(*arguments):
    return program.run("device", "test", "external", *arguments, code=None)


def rig_file(folder, command, hello_s=LONG_S, prepare_s=LONG_S):
    path = pathlib.Path(folder) / "rig.json"
    path.write_text(json.dumps({"format": 1, "title": "Test", "external": {
        "command": command, "hello_s": hello_s, "prepare_s": prepare_s}}), encoding="utf-8")
    return str(path)


def tested(command, folder, hello_s=LONG_S, **limits):
    """The JSON of a test of this rig, which has minutes for everything but what has a limit."""
    done = program.run(rig_file(folder, command, hello_s), *(f"{key}={value}" for key, value in limits.items()), program=PATIENT, code=None)
    result = done.json
    check((done.returncode == 0) == result["ok"] and done.returncode in (0, 4), f"exit code {done.returncode}")
    check([entry["number"] for entry in result["checks"]] == list(range(1, len(result["checks"]) + 1)), "numbers")
    return result


def failed(result):
    return [entry["what"] for entry in result["checks"] if not entry["ok"]]


def comes_of_load(entry):
    """Limits that are the rig's own: a busy machine has its watchdog bite, and lets it present for longer."""
    return not entry["ok"] and ("has fallen silent" in entry["measured"] or entry["what"] == "explored from the first contact" and
                                float(entry["measured"].split()[0]) > 0.5)


def passes(command, folder):
    while True:
        result = tested(command, folder)
        wrong = [entry for entry in result["checks"] if not entry["ok"]]
        if not any(map(comes_of_load, wrong)):
            break
    check(result["ok"], f"{command} passes: {wrong}")
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
    result = tested(command, folder, hello_s=2)
    check("hello" in failed(result), "without its firmware there is no rig")

    service = fake_services.FakeInverse()
    command = ["python3", str(EXAMPLES / "haply_rig.py"), "--port", str(service.port), "--model"]
    result = passes(command, folder)
    check(result["rig"] == "Haply Inverse3", "the rig is named")
    check(service.first["session"]["configure"]["profile"]["name"] == "jnd", "the session has a name")
    check(0 < max(service.forces) <= 8 and min(service.forces) == 0, f"forces to {max(service.forces)} N")
    service.answers.clear()
    result = tested(command, folder)
    check(not result["ok"], "a silent service is a fault")
    service.listening.close()
    result = tested(["python3", str(EXAMPLES / "haply_rig.py"), "--port", "1"], folder)
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
        result = tested(command, folder)
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


def check_plain(folder):
    result = passes(["python3", str(EXAMPLES / "plain_rig.py")], folder)
    check(result["rig"] == "Plain rig" and result["simulated"], "the rig is named")


def check_hostile_text(folder, before, after):
    """Nothing that a rig says reaches a terminal as it is."""
    text = (EXAMPLES / "plain_rig.py").read_text(encoding="utf-8")
    check(text.count(before) >= 1, f"{before!r} is there")
    path = pathlib.Path(folder) / "hostile_text_rig.py"
    path.write_text(text.replace("import json\n", "import json\nimport sys\n").replace(before, after), encoding="utf-8")
    for options in ([], ["--json"]):
        done = run("--rig", rig_file(folder, ["python3", str(path)], hello_s=3, prepare_s=1), *options)
        bad = [letter for letter in done.stdout + done.stderr
               if (ord(letter) < 32 and letter != "\n") or 0x7f <= ord(letter) < 0xa0 or letter in "\u202e\u200b"]
        check(not bad, f"{after}: {bad[:5]} on the screen")
        check(done.returncode == 4, f"{after}: exit code {done.returncode}")


def check_other_commands(folder):
    """doctor starts an external rig and says what it is; a session does not run on one that no protocol asks for."""
    path = rig_file(folder, ["python3", str(EXAMPLES / "plain_rig.py")])
    doctor = ["doctor", "--seconds", "0.1", "--json", "--rig", path]
    checks = program.run(*doctor, code=None).json["checks"]
    found = {entry["name"]: entry for entry in checks}
    check("stiffness 100 to 1000 N/m" in found["external rig: presents"]["found"], "doctor says what the rig presents")
    done = program.run(*doctor, "--protocol", "tutorial", code=None)
    found = {entry["name"]: entry for entry in done.json["checks"]}
    check(found["external rig: protocol"]["verdict"] == "bad" and done.returncode == 1, "the protocol asks for another rig")
    asked = json.loads((PROTOCOLS / "studies/maereg2017.json").read_text(encoding="utf-8"))
    asked.update(assumed=[], levels={"absolute": [350, 450]}, conditions=[
        {"name": name, "label": name, "parameters": {"finger": name}} for name in ("thumb", "index")])
    asked["analysis"]["contrasts"] = []
    protocol = pathlib.Path(folder) / "asked.json"
    for levels, fits in (([350, 450], True), ([350, 4500], False)):
        asked["levels"] = {"absolute": levels}
        protocol.write_text(json.dumps(asked), encoding="utf-8")
        done = program.run(*doctor, "--protocol", str(protocol), code=None)
        found = {entry["name"]: entry for entry in done.json["checks"]}
        check(found["external rig: protocol"]["verdict"] == ("ok" if fits else "bad"), f"doctor, {levels}: {found}")
        done = program.run("check", protocol, "--rig", path, code=None)
        check(done.returncode == (0 if fits else 3), f"check, {levels}: {done.stdout}{done.stderr}")
        check(("4500 N/m is out of the rig's range" in done.stdout) != fits, f"check, {levels}: {done.stdout}")
    asked["levels"] = {"absolute": [350, 450]}
    protocol.write_text(json.dumps({**asked, "trial": {**asked["trial"], "gap_s": 0.2}}))
    for hello, code, words in (('"ready_s": 0.2', 0, "ok"), ('"ready_s": 0.3', 3, "up to 0.3 s to get ready for a value, and gap_s is 0.2 s"),
                               ('"ready_s": 0.3, "holds": False', 0, "same from different")):
        rig = pathlib.Path(folder) / "slow_rig.py"
        rig.write_text((EXAMPLES / "plain_rig.py").read_text(encoding="utf-8").replace('"ready_s": 0', hello), encoding="utf-8")
        done = program.run("check", protocol, "--rig", rig_file(folder, ["python3", str(rig)]), code=None)
        check(done.returncode == code and words in done.stdout, f"{hello}: {done.returncode} {done.stdout}")
    path = rig_file(folder, ["python3", str(EXAMPLES / "plain_rig.py")])
    done = program.run("run", "tutorial", "--study", str(pathlib.Path(folder) / "s.sqlite"), "--participant", "P01", "--rig", path, code=None)
    check(done.returncode == 3 and "an external rig is for protocols" in done.stderr, f"{done.returncode} {done.stderr}")


LISTENS = """
import os, socket, sys
sys.path.insert(0, sys.argv[1])
import plain_rig
listening = socket.create_server(("127.0.0.1", 0))
print(listening.getsockname()[1], flush=True)
while True:
    connection = listening.accept()[0]
    if os.fork() == 0:
        os.dup2(connection.fileno(), 0)
        os.dup2(connection.fileno(), 1)
        plain_rig.serve({**plain_rig.HELLO, "token": sys.argv[2]}, plain_rig.Device())
        os._exit(0)
    connection.close()
"""


def check_token(folder):
    """Whoever listens on a port is the rig if its hello has the token of a file that nobody else can read; nothing shows it."""
    token, folder = "0123456789abcdef0123", pathlib.Path(folder)
    rig = program.start("-c", LISTENS, EXAMPLES, token, program=sys.executable)
    port = int(rig.stdout.readline())
    path, secret = folder / "rig.json", folder / "token"
    path.write_text(json.dumps({"format": 1, "title": "T", "external": {"port": port, "token": "token"}}), encoding="utf-8")
    for text, mode, code, words in ((token + "\n", 0o600, 0, "stiffness 100 to 1000 N/m"), (token[::-1], 0o600, 1, "has not the token"),
                                    (token, 0o640, 3, "chmod 600"), ("short", 0o600, 3, "holds no token")):
        secret.write_text(text)
        secret.chmod(mode)
        done = program.run("doctor", "--seconds", "0.1", "--rig", path, code=None)
        said = " ".join((done.stdout + done.stderr).split())
        check(words in said and (code != 3) == (done.returncode != 3), f"token {text!r}, {mode:o}: {done.returncode} {said}")
        check(token not in said and token[::-1] not in said, f"the token is shown: {said}")
    rig.kill()
    rig.wait()


def check_mistake(folder, before, after, expected, **limits):
    """The plain rig with one line changed."""
    text = (EXAMPLES / "plain_rig.py").read_text(encoding="utf-8")
    check(text.count(before) == 1, f"{before!r} is there once")
    path = pathlib.Path(folder) / "mistaken_rig.py"
    path.write_text(text.replace(before, after), encoding="utf-8")
    while True:
        result = tested(["python3", str(path)], folder, **limits)
        found = failed(result)
        if expected in found or not any(map(comes_of_load, result["checks"])):
            break
    check(expected in found, f"{after!r}: {expected} fails, and not only {found}")


def check_slow(folder):
    """A rig that is busy for a while before anything is presented is slow, and may be used."""
    text = (EXAMPLES / "plain_rig.py").read_text(encoding="utf-8")
    path = pathlib.Path(folder) / "slow_rig.py"
    answer = 'say("alive", n=message["n"])'
    path.write_text(text.replace(answer, f'message["n"] > 30 and {answer}'), encoding="utf-8")  # 30 in 0.75 s
    found = next(entry for entry in tested(["python3", str(path)], folder, presenting_silent_s=0.1)["checks"]
                 if entry["what"] == "alive while it waits")
    check(found["ok"] and found["slow"] and found["expected"] == "within 100 ms", f"a slow rig: {found}")


def check_screen(folder):
    """What a person reads: a line for each check, and a verdict."""
    while True:  # a busy machine may lose the rig, and what follows is not tried
        done = run("--command", f"python3 {EXAMPLES / 'plain_rig.py'}")
        if "was lost before" not in done.stdout and "no hello within" not in done.stdout:
            break
    for words in ("alive while it waits", "stop ends a presentation", "lets go when the program is silent", "within 200 ms"):
        check(words in done.stdout, f"{words!r} is on the screen: {done.stdout}")
    verdict = "judged checks ok" if done.returncode == 0 else "FAILED: do not use this rig"
    check(done.returncode in (0, 4) and verdict in done.stdout.splitlines()[-1], f"{done.returncode}: {done.stdout}")


HOSTILE = "\\x1b]0;owned\\x07\\x1b[2J\\u202e\\u200b\\r"
HOSTILE_TEXTS = [('cause=problem(hello, message) or "busy"', f'cause="{HOSTILE}"'),
                 ('"name": "Plain rig"', f'"name": "{HOSTILE}"'), ('"unit": "N/m"', f'"unit": "{HOSTILE[:20]}"'),
                 ('["thumb", "index"]', f'["{HOSTILE}"]'), ('"name": "force"', f'"name": "{HOSTILE}"'),
                 ('say("alive", n=message["n"])', f'sys.exit("{HOSTILE}")')]
MISTAKES = [  # what is changed into what, a check that must fail, and the limits of which one finds it
    ('say("alive", n=message["n"])', 'pass', "alive while it waits", {"silent_s": 0.3}),
    ('say("alive", n=message["n"])', 'say("alive", n=message["n"] + 10**6)', "alive while it waits", {"silent_s": 0.3}),
    ('say("alive", n=message["n"])', 'going or say("alive", n=message["n"])', "alive while it presents",
     {"presenting_silent_s": 0.1}),
    ('"done", id=self.id,', '"done", id=self.id + 1,', "presents 100 N/m the lowest", {"stop_s": 0.2}),
    ('(going or problem(hello, message))', 'going', "refuses 10001 N/m"),
    ('say("fault", id=going.id, cause="jnd has fallen silent")', 'going = going', "lets go when the program is silent",
     {"presenting_silent_s": 0.1, "stop_s": 0.2}),
    ('            elif kind == "bye":\n                return device.off()\n', '', "bye ends it", {"bye_s": 1}),
    ('                return device.off()  # jnd is gone\n', '                select.select([], [], [])\n',
     "ends when its input does", {"bye_s": 1}),
    ('elif kind == "stop" and (going or prepared)', 'elif kind == "halt"', "stop ends a presentation", {"stop_s": 0.2}),
    ('(going or prepared).done("complete" if going and message["reason"] == "enough" else "stopped")',
     'say("fault", id=(going or prepared).id, cause="busy")', "stop ends a presentation"),
    ('(going or problem(hello, message))',  # what is to be stopped is void before
     '(going or problem(hello, message) or message["id"] < 1000 and message.get("exploration", {}).get("duration_s") == 10)',
     "stop ends a presentation"),
    ('(going or prepared).done("complete" if going and message["reason"] == "enough" else "stopped")',
     '(going or prepared).done("stopped")', 'stop with "enough" completes it'),
    ('            say("contact", id=self.id, time_s=now)\n', '', "presents 100 N/m the lowest"),
    ('duration_s=time.monotonic() - self.began', 'duration_s=time.monotonic() - self.began + 500',
     "presents 100 N/m the lowest"),
    ('"serial": "none"', '"serial": str(time.time())', "is the same rig"),
    ('"max": 1000', '"max": 10', "hello", {"hello_s": 1}),
    ('duration_s=time.monotonic() - self.began', 'duration_s=(self.first or 0) + 0.1', "presents 100 N/m the lowest"),
    ('return "complete" if over[self.how["ends"]] else None', 'return "complete"', "presents 100 N/m the lowest",
     {"presenting_silent_s": 0.1, "stop_s": 0.2}),
    ('return peaks["force"] / peaks["depth"]', 'return 750', "delivered"),
    ('"name": "force", "unit": "N"', '"name": "force", "unit": str(os.getpid())', "is the same rig"),
    ('if waiting and device.is_ready():', 'if waiting and time.monotonic() - prepared.began > 0.3:', "ready", {"late_s": 0}),
    ('now - start >= self.how.get("duration_s", 0)', 'now - start >= 1', "explored from the first contact"),
    ('# What else comes is of a later version of jnd: let it pass.', 'elif kind.startswith("x"): raise SystemExit(1)',
     "lets an unknown message pass"),
    ('flush=True', 'flush=False', "hello", {"hello_s": 1}),
]


def main():
    with tempfile.TemporaryDirectory() as folder:
        with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
            begun = []

            def begin(what, *arguments, **more):
                own = pathlib.Path(folder) / str(len(begun))
                own.mkdir()
                begun.append(pool.submit(what, *arguments, folder=str(own), **more))

            for what in (check_bridges, check_plain, check_weart, check_other_commands, check_slow, check_screen, check_token):
                begin(what)
            begin(passes, [RIG_LOOP])
            for before, after in HOSTILE_TEXTS:
                begin(check_hostile_text, before=before, after=after)
            for before, after, expected, *limits in MISTAKES:
                begin(check_mistake, before=before, after=after, expected=expected, **(limits[0] if limits else {}))
            for done in begun:
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
                                ({"port": 70000}, "$.external.port"), ({"port": 7000}, "any user of this machine"),
                                ({"port": 7000, "token": "none"}, "none"), ({"command": [""]}, "empty word")]:
            path.write_text(json.dumps({"format": 1, "title": "T", "external": external}), encoding="utf-8")
            done = run("--rig", str(path))
            check(done.returncode == 3 and words in done.stderr, f"{external}: {done.returncode} {done.stderr}")
        done = program.run("device", "test", "rrs3", "--command", "a", code=None)
        check(done.returncode == 2 and "jnd device test external" in done.stderr, done.stderr)
    print("FAILED" if FAILURES else "all examples pass, and every mistake is told")
    sys.exit(1 if FAILURES else 0)


if __name__ == "__main__":
    main()
