"""A virtual device's own log: when it pushed, let go, stopped itself, and was unplugged."""

WATCHDOG_MS = 20
STEP_MS = 1
# A device's log is written after the step that it tells of.
WRITING_S = 0.01


class DeviceLog:
    def __init__(self, results, name):
        self.name = name
        self.events = results.lines(name)

    def of(self, *kinds):
        return [event for event in self.events if event["event"] in kinds]

    def stops(self):
        return [event for event in self.of("state") if event["to"] == "stopped"]

    def unplugs(self):
        """(when, pushing just then, when force was gone) of each unplugging but the last, which ends the program."""
        found, pushing = [], False
        for place, event in enumerate(self.events):
            if event["event"] in ("push", "let_go"):
                pushing = event["event"] == "push"
            elif event["event"] == "unplugged":
                gone = next((later["time_s"] for later in self.events[place:] if later["event"] == "let_go"), None)
                found.append((event["time_s"], pushing, gone if pushing else event["time_s"]))
        return found[:-1]

    def pushes_at(self, time_s):
        before = [event["event"] for event in self.of("push", "let_go") if event["time_s"] <= time_s]
        return bool(before) and before[-1] == "push"

    def let_go_after(self, time_s):
        return min((event["time_s"] for event in self.of("let_go") if event["time_s"] > time_s), default=float("inf"))

    def reconnections_s(self):
        """From each plugging, but the first, to the device's next activity."""
        took = []
        for plugged in self.of("plugged")[1:]:
            active = [event["time_s"] for event in self.of("state")
                      if event["to"] == "active" and event["time_s"] > plugged["time_s"]]
            took.append(active[0] - plugged["time_s"] if active else float("inf"))
        return took

    def force_without_activity(self):
        """What must never be: a push that begins or goes on while the device is not active."""
        wrong, active = [], False
        for place, event in enumerate(self.events):
            if event["event"] == "state":
                active = event["to"] == "active"
                if not active and event["push_n"] != 0:
                    wrong.append(event)
            elif event["event"] == "push" and not active:
                wrong.append(event)
        return wrong


def judge_watchdog(results, log, least_stops=0):
    stops = [event for event in log.stops() if "watchdog" in event["faults"]]
    late = [event for event in stops if event["since_command_ms"] > WATCHDOG_MS + STEP_MS]
    results.check(f"{log.name}: it stopped itself {len(stops)} times, each within {WATCHDOG_MS} ms and a step of the last "
                  "command", len(stops) >= least_stops and not late, f"at least {least_stops} expected; late: {late}")
    others = [event for event in log.stops() if event not in stops]
    results.check(f"{log.name}: nothing else stopped it", not others, others)
    wrong = log.force_without_activity()
    results.check(f"{log.name}: no force unless it is active", not wrong, wrong[:3])


def judge_unplugs(results, log):
    unplugs = log.unplugs()
    limit_s = 1e-3 * (WATCHDOG_MS + STEP_MS) + WRITING_S
    late = [one for one in unplugs if one[2] is None or one[2] - one[0] > limit_s]
    pushing = sum(1 for one in unplugs if one[1])
    results.check(f"{log.name}: unplugged {len(unplugs)} times, {pushing} of them under force: zero within the watchdog's "
                  "time", not late, late)
    return len(unplugs)
