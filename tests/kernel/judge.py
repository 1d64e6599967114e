#!/usr/bin/env python3
"""judge.py RESULTS PART...: looks at what a guest brought back, a line a check. Exit status 1 where one failed.

Times are of the guest's one clock, on which the devices' logs and the host's programs agree.
"""
import pathlib
import sqlite3
import sys

from judge_session import judge_freeze, judge_session, judge_tracker, judge_unplug
from judging import Results
from readme_virtual import commands
from readme_commands import mismatch


def judge_link(results):
    trips = results.line("link-trips.json")
    asked = results.by_length(2_000, 10_000)
    results.check(f"every one of {asked} requests is answered, in order, and no telemetry is missing meanwhile",
                  trips["round_trips"] == asked and trips["wrong"] == 0 and trips["strange"] == 0
                  and trips["telemetry_missing"] == 0 and trips["telemetry_old"] == 0
                  and trips["telemetry"] >= 900 * trips["seconds"], trips)
    results.note("round trips", f"{trips['round_trips'] / trips['seconds']:.0f} a second, median {trips['median_us']} us, "
                 f"longest {trips['longest_us']} us (guest)")
    judge_stream(results, "link-stream.json", "link-stream-status.json", results.by_length(2, 5))

    # What the device was told to leave out and to spoil, exactly.
    spoilt = results.line("link-spoilt.json")
    results.check("7 reports left out and 5 with a wrong CRC are counted as 12 missing, 5 damaged",
                  spoilt["missing"] == 12 and spoilt["damaged"] == 5 and spoilt["not_ok"] == 0, spoilt)


def judge_stream(results, stream_file, status_file, seconds):
    stream = results.line(stream_file)
    before, after = results.lines(status_file)
    sent = after["sent"] - before["sent"]
    commands = after["commands"] - before["commands"]
    counted = stream["received"] + stream["missing"]
    results.check(f"{seconds} s at 1 kHz: nothing missing, damaged or refused, the device always there",
                  stream["missing"] == 0 and stream["damaged"] == 0 and stream["rejected"] == 0
                  and stream["not_ok"] == 0, stream)
    # The handshake's telemetry is heard before counting begins.
    results.check("the device sent what the host received and counted as missing, but for the handshake",
                  0 <= sent - counted <= 200 and counted >= 1000 * seconds, f"{sent} sent, {counted} counted")
    # A link ends with a command of mode rest, after its counts were read.
    results.check("the device took every command that the host sent, and the host sent one a tick",
                  commands - stream["sent"] in (0, 1) and after["rejected"] == 0
                  and stream["sent"] + stream["overwritten"] >= stream["ticks"]
                  and stream["ticks"] + stream["skipped"] >= 1000 * seconds - 1, f"{commands} commands, {stream}")
    results.check("the loop was never kept for a second, nor silence so long",
                  stream["longest_call_us"] < 1e6 and stream["longest_silence_ms"] < 1000, stream)
    results.note("stream", f"{stream['ticks']} ticks, {stream['skipped']} skipped, {stream['overwritten']} overwritten, "
                 f"latency median {stream['latency_p50_us']:.0f} us, longest {stream['latency_max_us']:.0f} us (guest)")


def judge_gadget(results):
    device = results.line("usb_device.json")
    stream = results.line("usb_stream.json")
    # Blocked writes end after 5 s each, and the writer had 12 s of them.
    results.check("the writes did block: far fewer commands than ticks, and the link says why",
                  stream["overwritten"] > 5000 and "takes no commands" in stream["trouble"], stream)
    results.check("the loop goes on: no call of the device took a second, no tick was late for long",
                  stream["longest_call_us"] < 1e6 and stream["skipped"] < 1000, stream)
    results.check("the reader goes on: telemetry all the time, nothing missing",
                  stream["longest_silence_ms"] < 1000 and stream["missing"] == 0
                  and device["sent_during_stall"] > 3000, f"{stream}, {device}")
    results.check("the device's watchdog ended the force, once, and the loop heard of it",
                  device["watchdogs"] == 1 and stream["stops"] == 1, f"{device}, {stream}")
    results.check("what the host counts as sent is what the device got", device["commands"] - stream["sent"] in (0, 1),
                  f"{device['commands']}, {stream['sent']}")


def judge_campaign(results):
    trips = results.line("campaign-trips.json")
    results.check("100,000 requests, every one answered in order", trips["round_trips"] == 100_000 and trips["wrong"] == 0
                  and trips["telemetry_missing"] == 0 and trips["strange"] == 0, trips)
    judge_stream(results, "campaign-stream.json", "campaign-stream-status.json", 60)
    judge_unplug(results, 200, "campaign")


def judge_readme(results):
    for number, (command, shown) in enumerate(commands(), 1):
        actual = [line.rstrip() for line in results.text(f"readme-{number}.txt").splitlines()]
        wrong = mismatch(shown, actual)
        results.check(f"the page shows what {command} prints", wrong is None, f"{wrong!r} is not in {actual}")


JUDGES = {"readme": judge_readme, "link": judge_link, "gadget": judge_gadget, "campaign": judge_campaign, "session": judge_session,
          "unplug": judge_unplug, "freeze": judge_freeze, "tracker": judge_tracker}


def main():
    results = Results(pathlib.Path(sys.argv[1]))
    for part in sys.argv[2:]:
        if part not in JUDGES:
            continue
        try:
            JUDGES[part](results)
        except (OSError, LookupError, ValueError, sqlite3.Error) as error:
            results.check(f"{part}: what came back can be judged", False, repr(error))
    return 1 if results.failed else 0


if __name__ == "__main__":
    sys.exit(main())
