#!/usr/bin/env python3
"""Commands that take longer than a second say so on a terminal, and nowhere else. The work that takes long here is reading
a protocol from a pipe whose writer waits, and measuring the machine."""
import os
import re
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program


class WorkLine(program.Case):
    def test_long_work_is_told_on_a_terminal_and_nowhere_else(self):
        reader, writer = os.pipe()
        silent = self.started("check", f"/dev/fd/{reader}", pass_fds=[reader])
        mine, its = os.pipe()
        terminal = program.Terminal("check", f"/dev/fd/{mine}", pass_fds=[mine])
        name = f"checking /dev/fd/{mine}"
        line = rf"\r{re.escape(name)}: (\d+) s \.\.\.\x1b\[K"
        first, second = re.findall(line, terminal.until(re.compile(f"(?s){line}.*{line}")))[:2]
        self.assertLess(int(first), int(second))
        os.write(its, b"{}")
        os.close(its)
        # The line is ended, with how long it took, before the results begin.
        last, _, results = terminal.ends(program.INVALID).partition("\x1b[K\r\n")
        self.assertTrue(last.split("\r")[-1].startswith(f"{name}: ") and not last.endswith("..."), last)
        self.assertTrue(results.startswith("error: ") and name not in results, results)
        # The other one began earlier and worked for as long.
        os.write(writer, b"{}")
        os.close(writer)
        out, err = silent.communicate(timeout=program.GUARD_S)
        self.assertEqual((silent.returncode, err), (program.INVALID, ""))
        self.assertNotIn("checking", out)

    def test_the_measurements_of_doctor_are_told_one_by_one_and_ctrl_c_ends_them(self):
        terminal = program.Terminal("doctor", "--seconds", "4")
        line = r"\rrehearsing for 4 s on a simulated rig: \d+ s \.\.\."
        self.assertIn("measuring for 4 s how late a loop of 1 ms wakes: ", terminal.until(re.compile(f"(?s){line}.*{line}")))
        terminal.type("\x03")
        self.assertNotIn("fit", terminal.ends(program.STOPPED))


if __name__ == "__main__":
    program.main()
