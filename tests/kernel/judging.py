"""What a guest brought back, and lines of checks about it."""
import json


class Results:
    def __init__(self, folder):
        self.folder = folder
        self.failed = 0
        length = folder / "length"
        self.whole = length.exists() and length.read_text().strip() == "long"

    def by_length(self, short, long):
        return long if self.whole else short

    def check(self, name, good, detail=""):
        if not good:
            self.failed += 1
        print(f"{'ok' if good else 'not ok'} - {name}" + ("" if good or not detail else f": {detail}"))
        return good

    def note(self, name, text):
        print(f"# {name}: {text}")

    def text(self, name):
        return (self.folder / name).read_text(encoding="utf-8")

    def lines(self, name):
        """A JSON object a line."""
        return [json.loads(line) for line in (self.folder / name).read_text().splitlines() if line.startswith("{")]

    def line(self, name):
        (only,) = self.lines(name)
        return only
