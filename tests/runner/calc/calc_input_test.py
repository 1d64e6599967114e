#!/usr/bin/env python3
"""What `jnd calc` reads: the tables that spreadsheets write, and words for what it does not read."""
import os
import socket
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

TABLE = "participant,condition,value\nP1,S,3.5\nP1,V,4.25\nP2,S,3.125\nP2,V,5.5\nP3,S,2.5\nP3,V,1.5\n"


def calc(command, data, *more, code=0):
    return program.run("calc", command, "-", *more, input=data, code=code)


class CalcInput(program.Case):
    def compared(self, data):
        return calc("compare", data, "--json").json

    def refused(self, command, data, *parts):
        done = calc(command, data, code=3)
        message = done.stderr.decode()
        self.assertEqual(done.stdout, b"")
        self.assertEqual(len(message.splitlines()), 1, message)
        self.says(message, *parts)

    def test_what_spreadsheets_write_is_one_table(self):
        plain = self.compared(TABLE.encode())
        semicolons = TABLE.replace(",", ";").replace(".", ",")
        for name, data in {
            "semicolons, decimal commas": semicolons.encode(),
            "semicolons, decimal points": TABLE.replace(",", ";").encode(),
            "a first line sep=": ("sep=;\n" + semicolons).encode(),
            "tabs": TABLE.replace(",", "\t").encode(),
            "a byte order mark": TABLE.encode("utf-8-sig"),
            "UTF-16": TABLE.replace(",", "\t").encode("utf-16"),
            "UTF-16, high byte first": b"\xfe\xff" + TABLE.encode("utf-16-be"),
            "CRLF": TABLE.replace("\n", "\r\n").encode(),
            "lone CR": TABLE.replace("\n", "\r").encode(),
            "blanks around names": TABLE.replace("P1,S,", "P1 ,S\u00a0,").replace("P2,V", '"P2 ", V\u200b').encode(),
            "blanks around quotes": TABLE.replace("P1,S,3.5", '"P1" ,"S"\u00a0, "3.5" ').replace("P2,V", '\t"P2",  "V"').encode(),
            "blanks around quotes between tabs": TABLE.replace(",", "\t").replace("P1\tS\t3.5", '"P1" \t "S"\t "3.5"').encode(),
            "cleared rows": (TABLE + ",,\n\n").encode(),
            "lines of blanks": ("  \n" + TABLE.replace("P2,S", " \u00a0\r\nP2,S") + "\t\n  ").encode(),
            "a quoted line sep=": ('"sep=;"\r\n' + semicolons).encode(),
        }.items():
            with self.subTest(name):
                self.assertEqual(self.compared(data), plain)

    def test_codes_that_look_alike_are_told(self):
        said = calc("compare", TABLE.replace("P2", "P01").replace("P3", "p1").encode()).stderr.decode()
        self.assertIn('"P01" and "P1", "P01" and "p1" look alike', said)
        two = TABLE.replace("P1", "Jos\u00e9").replace("P2", "Jose\u0301")
        said = calc("compare", two.encode()).stderr.decode()
        self.assertIn("(5 and 4 characters) look alike, and count as different people", said)
        self.assertEqual(calc("compare", TABLE.encode()).stderr, b"")

    def test_what_could_mean_two_things_is_refused(self):
        self.refused("compare", TABLE.replace("P2", "Jos\u00e9").encode("latin-1"), ":4:1:", "0xe9", "Latin-1", "UTF-8")
        self.refused("compare", TABLE.replace(",", ";").replace("3.5\n", "3,5\n").encode(), ":3:3:", "line 2", "alike")
        self.refused("wilcoxon", b"x\ty\n1,250\t3\n", ":2:1:", "1.250 or 1250", "thousands")
        self.refused("shapiro", b"x\n3,25\n", ":2:", "has 2 cells", "decimal point")
        self.refused("shapiro", b"x\r3.25\rz\r", ":3:1:", "not a finite number")
        self.refused("shapiro", b"PK\x03\x04rest", "spreadsheet", "save it as CSV")
        self.refused("shapiro", b"\xff\xfex\x00\n\x00\x00", "UTF-16", "half a character")
        self.refused("shapiro", b"x\x00\n\x00", "zero bytes")

    def test_a_level_without_trials_is_left_out(self):
        rows = "x,n,k\n1,20,2\n2,20,9\n3,20,17\n"
        options = ("--function", "logistic", "--guess", "0", "--lapse", "0", "--json")
        self.assertEqual(calc("fit", (rows + "4,0,0\n").encode(), *options).stdout, calc("fit", rows.encode(), *options).stdout)

    def test_levels_that_differ_by_rounding_are_one_level(self):
        noise, clean = "0.30000000000000004", "0.3"
        trials = "".join(f"P1,{standard},{level},{answer}\n" for level, answers in (("X", "sdss"), ("0.4", "sdsd"), ("0.5", "dsdd"))
                         for standard in ("0.3", "X") for answer in answers)
        columns = ("--trials", "--level", "level", "--standard", "standard", "--participant", "who", "--answer", "answer",
                   "--positive", "d", "--json")
        fit = ("--function", "gaussian", "--guess", "0", "--lapse", "0")
        for command, more in (("sdt", ()), ("jnd", ()), ("which", ()), ("fit", fit)):
            with self.subTest(command):
                found = [calc(command, ("who,standard,level,answer\n" + trials.replace("X", written)).encode(), *columns, *more).stdout
                         for written in (noise, clean)]
                self.assertEqual(*found)
        levels = "x,n,k\n0.1,9,1\n0.3,9,3\nX,9,5\n0.5,9,8\n"
        self.assertEqual(*(calc("fit", levels.replace("X", written).encode(), *fit, "--json").stdout for written in (noise, clean)))

    def test_levels_of_quest_that_are_no_logarithms_are_told(self):
        guess = ("--t-guess", "2.7", "--t-guess-sd", "0.3")
        self.assertIn("900 lies far beyond the grid of thresholds, 0.2 to 5.2", calc("quest", b"response,x\n1,900\n", *guess).stderr.decode())
        self.assertEqual(calc("quest", b"response,x\n1,2.95\n", *guess).stderr, b"")

    def test_kinds_of_files(self):
        pipe, sock = self.folder / "pipe", self.folder / "socket"
        os.mkfifo(pipe)
        with socket.socket(socket.AF_UNIX) as server:
            server.bind(str(sock))
            for path, part in ((self.folder, "is a folder"), (pipe, "is a named pipe"), ("/dev/zero", "is a device"),
                               (sock, "is a socket"), (self.folder / "none", "no such file")):
                done = self.jnd("calc", "sdt", path, code=3)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertIn(part, done.stderr)
        program.run("-c", '"$0" calc shapiro <(printf "x\\n1\\n2\\n4\\n")', program.JND, program="bash")

    def test_an_endless_input_has_an_end(self):
        with open("/dev/zero", "rb") as zeros:
            done = program.run("calc", "sdt", "-", stdin=zeros, code=3)
        self.assertIn("is larger than 256 MiB", done.stderr)


if __name__ == "__main__":
    program.main()
