#!/usr/bin/env python3
"""Finds what product headers declare and the product does not use: functions, constants and types.
Reports names that only tests use, too: such a function belongs into the tests, or goes with what tests it.

Works on text, without a compiler: a name that two classes share is used as soon as one of them is. Takes about three seconds.

Usage: dead_names_test.py [SOURCE-FOLDER]"""
import collections
import pathlib
import re
import sys

import layers_test

# What tests alone use, and have no other way to: each with what they do by it.
ALLOWED = {
    "all_references": "hold every reference against the words that cite it",
    "clock_steps": "see that a link's clock never stepped",
    "compression_m": "see the true state of a simulated platform",
    "drop_of_mean": "hold intervals of JNDs against the tests of single values",
    "cycle_ns": "see how long a virtual tracker's motion takes",
    "set_rig_source": "put a rig that declares itself real in the place of the simulated ones",
    "true_angle_rad": "see the true state of a simulated finger",
    "velocity_m_per_s": "see the true state of a simulated platform",
}

NOISE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![\w])\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#[ \t]*(?!define)\w+[^\n]*', re.S | re.M)
NAME = re.compile(r"[A-Za-z_]\w*")
# "template <class T> [[nodiscard]] static const std::vector<int>& Class::name" at the beginning of a statement, before "(".
DECLARED = re.compile(r"(?:template ?<[^()]*?> ?|\[\[\w+\]\] ?|(?:public|private|protected) ?: ?)*((?:[\w:]+(?: ?<[^;()]*>(?:::\w+)*)?[ &*]+)+)((?:\w+(?:<\w+>)?::)*)(\w+) ?")
NO_TYPE = {"return", "else", "co_return", "new", "throw", "case", "delete", "goto", "using", "typedef", "operator", "define"}
TYPE = re.compile(r"(?:^|> )(?:struct|class|enum class|union) (\w+)(?: final)?(?= ?:| ?$)")
CONSTANT = re.compile(r"(?:inline |static |extern )*(?:constexpr|const)\b[^=({]*?\b(k[A-Z]\w*)\b")
READER = re.compile(r"\(\) const( noexcept)?$")  # a member function without parameters: often named as a field or variable elsewhere
CALLED = re.compile(r"(\w+) ?\(|::(\w+)")


def statements(text):
    """The text of a source between ; { }, without comments, literals and directives."""
    for one in re.split(r"[;{}]", NOISE.sub(" ", text)):
        one = " ".join(one.split())
        if one:
            yield one


def declaration(statement):
    """The name that a statement declares as a function, a type or a constant; None for any other statement."""
    found = TYPE.search(statement) or CONSTANT.match(statement)
    if found:
        return found[1]
    head, bracket, _ = statement.partition("(")
    found = DECLARED.fullmatch(head) if bracket else None
    return found[3] if found and not NO_TYPE & set(NAME.findall(found[1])) else None


class Survey:
    """The names that these folders declare, with their files, and how often each is named and called elsewhere."""

    def __init__(self, root, folders):
        self.declared, self.readers, self.named, self.called = {}, set(), collections.Counter(), collections.Counter()
        for folder in folders:
            for path in sorted((root / folder).rglob("*")):
                if path.suffix in layers_test.SOURCE:
                    for statement in statements(path.read_text(encoding="utf-8")):
                        self.take(statement, str(path.relative_to(root)))

    def take(self, statement, path):
        name = declaration(statement)
        if name:
            reader = READER.search(statement)
            if path.endswith(".h") or reader:  # the compiler itself finds other functions that one source alone has
                self.declared.setdefault(name, path)
            if reader:
                self.readers.add(name)
            statement = re.sub(rf"\b{name}\b", "", statement, count=1)
        self.named.update(NAME.findall(statement))
        self.called.update(call or qualified for call, qualified in CALLED.findall(statement))

    def uses(self, name):
        return (self.called if name in self.readers else self.named)[name]


def problems(root):
    product, tests = Survey(root, layers_test.ROOMS), Survey(root, ["tests"])
    for name, path in sorted(product.declared.items(), key=lambda one: one[::-1]):
        if product.uses(name) == 0 and name not in ALLOWED:
            yield f"{path}: {name} is used {'only by tests' if tests.uses(name) else 'nowhere'}"
    for name in sorted(ALLOWED):
        if name not in product.declared or product.uses(name):
            yield f"{name}: needs no exception in tests/dead_names_test.py any more"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    found = list(problems(root))
    print("\n".join(found) or "the product uses every name that its headers declare")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
