"""Sessions on virtual devices: judged by their studies, and by the devices' own logs."""
import json
import sqlite3

from judge_device import WRITING_S, DeviceLog, judge_unplugs, judge_watchdog

# A device is looked for several times a second, and a presentation begins with a soft start.
LONGEST_HANG_S = 2
# Two intervals of 1 s, what lies between them, and an answer after at most 3 s.
LONGEST_TRIAL_S = 6


class StudyFile:
    def __init__(self, results, name):
        connection = sqlite3.connect(f"file:{results.folder / name}?mode=ro&immutable=1", uri=True)
        rows = connection.execute("SELECT kind, monotonic_ns, body FROM event WHERE session != 'study' ORDER BY session, seq")
        self.events = [(kind, int(at), json.loads(body)) for kind, at, body in rows]

    def of(self, kind):
        return [body for name, _, body in self.events if name == kind]

    def felt(self):
        """(trial, interval, finger) -> what was delivered, of the attempt that was answered."""
        found = {}
        for trial in self.of("trial.completed"):
            for interval, presentation in enumerate(trial["presentations"]):
                for finger in presentation["fingers"]:
                    found[trial["index"], interval, finger["finger"]] = finger
        return found


def asked(trial, interval):
    return trial[f"stimulus_{interval + 1}_n_per_m"]


def judge_answers(results, study, screen, trials, tracker="hand"):
    done = study.of("trial.completed")
    results.check(f"all {trials} trials are answered, each once", sorted(one["index"] for one in done)
                  == list(range(1, trials + 1)), [one["index"] for one in done])
    shown = sum(1 for line in (results.folder / screen).read_text().splitlines() if "saved:" in line)
    results.check("every answer that was said to be saved is in the log", shown == len(done), f"{shown}, {len(done)}")
    opened = study.of("session.opened")[0]
    results.check(f"the session says on what it ran: devices over HID, tracker {tracker}", "HID" in opened["rig"]
                  and opened["tracker"] == tracker and opened["kind"] == "simulated", opened)
    results.check("it is closed", len(study.of("session.closed")) == 1)


def judge_connections(results, study, least_reconnections):
    records = study.of("rig.connections")
    if not results.check("the connections are in the log, at the beginning and the end", len(records) >= 2, len(records)):
        return
    first, last = ({device["serial"]: device for device in record["devices"]} for record in (records[0], records[-1]))
    results.check("both devices are named, with firmware and protocol version", sorted(last) == ["I1", "T1"]
                  and all(one["firmware"] and one["protocol_version"] == 1 for one in last.values()), last)
    # From the opening on: before it the program starts, and may be slow to listen.
    counts = {serial: (one["missing"] - first[serial]["missing"], one["damaged"], one["received"])
              for serial, one in last.items()}
    reconnections = sum(one["reconnections"] for one in last.values())
    results.check(f"no telemetry of the session is missing or damaged, over {reconnections} reconnections",
                  all(missing == 0 and damaged == 0 and received > 5000 for missing, damaged, received in counts.values())
                  and reconnections >= least_reconnections, counts)


def judge_session(results):
    study = StudyFile(results, "session.sqlite")
    models = StudyFile(results, "session-models.sqlite")
    trials = results.by_length(4, 8)
    judge_answers(results, study, "session.txt", trials)
    judge_connections(results, study, 0)
    results.check("no fault, nothing voided", not study.of("device.fault") and not study.of("trial.voided"))

    plan = results.line("session-plan.json")["trials"]
    done = study.of("trial.completed")
    planned = [(one["index"], one["condition"], one["stimuli"]) for one in plan]
    results.check("the trials are those of the plan, in its order", planned == [
        (one["index"], one["condition"], [asked(one, 0), asked(one, 1)]) for one in done], planned)
    results.check("the session on the models has the same trials", planned == [
        (one["index"], one["condition"], [asked(one, 0), asked(one, 1)]) for one in models.of("trial.completed")])

    # Over USB a command is a millisecond or two old when its force is felt, and so is the force that is read.
    stiffness_of = {(one["index"], interval): asked(one, interval) for one in done for interval in (0, 1)}
    felt, modelled = study.felt(), models.felt()
    off = [abs(finger["stiffness_n_per_m"] / stiffness_of[place[:2]] - 1) for place, finger in felt.items()]
    results.check("the delivered stiffness is the asked one, within 3 %, in every interval and finger",
                  len(off) == 4 * trials and max(off) < 0.03, f"{len(off)} fits, worst {max(off):.4f}")
    slopes = [abs(finger["stiffness_n_per_m"] / modelled[place]["stiffness_n_per_m"] - 1) for place, finger in felt.items()]
    results.check("and that of the models, within 3 %", max(slopes) < 0.03, f"worst {max(slopes):.4f}")
    forces = [abs(finger["peak_force_n"] - modelled[place]["peak_force_n"]) for place, finger in felt.items()]
    depths = [abs(finger["deepest_penetration_m"] - modelled[place]["deepest_penetration_m"])
              for place, finger in felt.items()]
    results.check("the same hand: its deepest penetration is that of the models, within 0.05 mm", max(depths) < 5e-5,
                  f"worst {1e3 * max(depths):.4f} mm")
    results.check("the greatest force that the device measured is that of the models, within 5 mN", max(forces) < 5e-3,
                  f"worst {max(forces):.4f} N")
    results.note("delivered", f"stiffness off by at most {100 * max(off):.2f} %, force by {max(forces):.4f} N, "
                 f"penetration by {1e6 * max(depths):.1f} um")
    for serial in ("T1", "I1"):
        judge_watchdog(results, DeviceLog(results, f"session-{serial}.log"))


def longest_pause_s(study, unplugged_s):
    """The longest time without an event, less what a device was away for in it."""
    pauses = []
    for (_, before, _), (_, after, _) in zip(study.events, study.events[1:]):
        away = sum(max(0, min(1e-9 * after, back) - max(1e-9 * before, gone)) for gone, back in unplugged_s)
        pauses.append(1e-9 * (after - before) - away)
    return max(pauses)


def judge_unplug(results, count=None, part="unplug"):
    count = count or results.by_length(4, 8)
    link = DeviceLog(results, f"{part}-U1.log")
    judge_watchdog(results, link, least_stops=1)
    unplugged = judge_unplugs(results, link)
    took = link.reconnections_s()
    results.check(f"after each of {count} unplugs the link is there again, within {LONGEST_HANG_S} s of the plug",
                  unplugged == count and len(took) == count and max(took) < LONGEST_HANG_S,
                  f"{unplugged} unplugs, {sorted(took)[-3:]}")
    stream = results.line(f"{part}-stream-unplugged.json")
    results.check("the loop was never kept for a second meanwhile, and no report is missing or damaged",
                  stream["longest_call_us"] < 1e6 and stream["reconnections"] == count and stream["missing"] == 0
                  and stream["damaged"] == 0, stream)
    results.note("reconnection", f"longest {max(took):.3f} s after the plug")
    judge_unplugged_session(results, part, count)


def judge_unplugged_session(results, part, count):
    study = StudyFile(results, f"{part}.sqlite")
    judge_answers(results, study, f"{part}.txt", results.by_length(2, 4))
    results.check("no trial was given up", not study.of("trial.abandoned"), study.of("trial.abandoned"))
    logs = [DeviceLog(results, f"{part}-{serial}.log") for serial in ("T1", "I1")]
    for log in logs:
        judge_watchdog(results, log)
    unplugged = sum(judge_unplugs(results, log) for log in logs)
    closed = max([1e-9 * at for kind, at, _ in study.events if kind == "session.closed"], default=0)
    last = max(one[0] for log in logs for one in log.unplugs())
    results.check(f"{count} unplugs in all, the last of them before the session's end", unplugged == count and last < closed,
                  f"{unplugged}, {closed - last:.1f} s before")
    away = []
    for log in logs:
        plugs = log.of("unplugged", "plugged")[1:]
        away += [(gone["time_s"], back["time_s"]) for gone, back in zip(plugs[::2], plugs[1::2])]
    # What came back just before the end need not have been found again.
    judge_connections(results, study, sum(back + LONGEST_HANG_S < closed for _, back in away))
    faults = study.of("device.fault")
    results.check("every fault is that of a device that was lost, or that stopped itself",
                  bool(faults) and {one["cause"] for one in faults} <= {"device_lost", "device_fault", "stale_reading"},
                  [one["cause"] for one in faults])
    longest = longest_pause_s(study, away)
    results.check(f"the session never hung: no pause above a trial's {LONGEST_TRIAL_S} s and {LONGEST_HANG_S} s, less the "
                  "time that a device was away", longest < LONGEST_TRIAL_S + LONGEST_HANG_S, f"{longest:.2f} s")
    results.note("session", f"{len(faults)} presentations ended by a fault, longest pause {longest:.2f} s")


def judge_freeze(results):
    study = StudyFile(results, "freeze.sqlite")
    judge_answers(results, study, "freeze.txt", results.by_length(2, 4))
    for serial in ("T1", "I1"):
        log = DeviceLog(results, f"freeze-{serial}.log")
        judge_watchdog(results, log, least_stops=1)
        pushed = [event for event in log.stops() if event["force_n"] > 0]
        results.check(f"{log.name}: it was pressing when the host froze, and its push is gone", bool(pushed)
                      and all(event["push_n"] == 0 for event in pushed), log.stops())
    faults = study.of("device.fault")
    results.check("the host found out by itself, and voided the trial", len(faults) == 1
                  and len(study.of("trial.voided")) == 1, [one["cause"] for one in faults])


# Force may rest on a pose of 20 ms; a pose is 5 ms old before the next one comes, and logs are written a little later.
STALE_POSE_S = 0.020
POSE_PERIOD_S = 0.005


def judge_stale_poses(results, study, orders):
    """Poses that ended, under force, at those times."""
    limit_s = STALE_POSE_S + POSE_PERIOD_S + WRITING_S
    for serial in ("T1", "I1"):
        log = DeviceLog(results, f"tracker-{serial}.log")
        judge_watchdog(results, log)
        pushed = [(at, log.let_go_after(at)) for at in orders if log.pushes_at(at)]
        results.check(f"{log.name}: {len(pushed)} times it pushed when the poses ended, and let go within "
                      f"{1e3 * limit_s:.0f} ms", bool(pushed) and all(gone - at <= limit_s for at, gone in pushed), pushed)
        if pushed:
            results.note("let go", f"{1e3 * max(gone - at for at, gone in pushed):.1f} ms after the poses were ended, at most")
    faults = [one["cause"] for one in study.of("device.fault")]
    results.check("each is a fault of its own, and voids the trial", faults == ["stale_pose"] * len(orders)
                  and len(study.of("trial.voided")) == len(orders), faults)
    tracker = study.of("rig.connections")[-1]["tracker"]
    # A tracker that freezes numbers no poses meanwhile, and one that is back begins anew: waits, and no gaps.
    results.check("rate, latency and waits of the poses are in the log", tracker["poses"] > 1000 and tracker["refused"] == 0
                  and tracker["latency_p99_ms"] < 20 and 50 < tracker["rate_hz"] < 205 and tracker["gaps"] == 0
                  and tracker["longest_wait_ms"] > 100, tracker)
    results.note("poses", f"{tracker['rate_hz']:.0f} a second, latency p99 {tracker['latency_p99_ms']:.2f} ms (guest)")


def judge_tracker(results):
    usb = StudyFile(results, "tracker-hid.sqlite")
    judge_answers(results, usb, "tracker-hid.txt", results.by_length(2, 4), "hid")
    tracker = usb.of("rig.connections")[-1]["tracker"]
    results.check("the tracker says its firmware, and that it is a model", tracker["firmware"] == "1.0.0"
                  and tracker["is_model"], tracker)
    orders = [event["time_s"] for event in DeviceLog(results, "tracker-K1.log").of("order")
              if event["words"] in ("freeze 100", "lose on", "unplug 700")]
    judge_stale_poses(results, usb, orders)
    program = StudyFile(results, "tracker-process.sqlite")
    judge_answers(results, program, "tracker-process.txt", results.by_length(2, 4), "process")
    judge_stale_poses(results, program, [float(results.text("tracker-killed.txt"))])
