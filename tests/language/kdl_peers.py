#!/usr/bin/env python3
"""Compares what Abbe, ckdl and @bgotink/kdl read in 12,000 documents that kdl_documents.cpp makes by chance.

    kdl_peers.py TEST_LANGUAGE            every difference is explained by a rule below, or is a fault
    kdl_peers.py TEST_LANGUAGE --show 5   five documents of each rule, too

A difference is explained by the first rule whose reader and pattern fit. Rules say who is right, by which clause of the
specification: where Abbe is stricter by intent (docs/language/syntax.md) its own code shows it. Compares with what
packaging/setup.sh could install; skipped with code 77 if that is nothing.
"""
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict

HERE = os.path.dirname(os.path.abspath(__file__))
MODULES = os.path.join(HERE, "..", "..", "build", "peers")
SKIPPED = 77

# Codes of documents that KDL accepts and Abbe refuses by intent.
STRICTER = {"E0112", "E0114", "E0118", "E0119"}


class Rule:
    """A known disagreement: the reader, whether it "accepts" or "refuses" what Abbe does not, or "reads" something else; a
    pattern of the text, Abbe's code if it refuses, and the clause by which it does what it does."""

    def __init__(self, reader, does, pattern, why, code=""):
        self.reader, self.does, self.pattern, self.why, self.code = reader, does, re.compile(pattern, re.S), why, code

    def explains(self, reader, does, text, codes):
        return self.reader == reader and self.does == does and self.code in codes and self.pattern.search(text) is not None


# A `{` or `/-` with no space before it. KDL 2.0.0 as it was released demanded one, which was an oversight
# (kdl-org/kdl 495) and is corrected in its grammar: `(node-space* node-children)?`. Abbe follows the correction.
TIGHT = r"(?<![ \t\r\n\x85\x0b\x0c\u2028\u2029\u00a0\u1680\u2003\u200a\u202f\u205f\u3000])(\{|/-)"
CORRECTED = "`{` and `/-` need no space before them: base-node, as corrected after the release"

GAP = r"(?:[ \t\u00a0\u1680\u2000-\u200a\u202f\u205f\u3000]|/\*(?:[^/]|[^*]/)*\*/)*"  # ws*, but for what nests
NEWLINE = r"(?://[^\n\r\x85\x0b\x0c\u2028\u2029]*)?[\n\r\x85\x0b\x0c\u2028\u2029]"
SPACES = "(?:" + GAP + "(?:" + NEWLINE + "|\\\\))*" + GAP  # line-space*
ODD = r"[\x00-\x08\x0e-\x1f\x7f\u200e\u200f\u202a-\u202e\u2066-\u2069]"
TYPE = r"\([^()]*\)"

RULES = [
    Rule("ckdl", "refuses", TIGHT, CORRECTED),
    Rule("ckdl", "refuses", r"\x0b", "U+000B is a newline: table of newlines"),
    Rule("ckdl", "reads", r"\x0b", "the same"),
    Rule("ckdl", "accepts", r"\x0b", "the same", "E01"),
    Rule("ckdl", "refuses", r"\([^()]*\\[^()]*\)", "in a type annotation lines may be continued: type, node-space"),
    Rule("ckdl", "refuses", TYPE + GAP + r"\\", "behind a type annotation lines may be continued: value, base-node"),
    Rule("ckdl", "refuses", "/-" + SPACES + "//", "lines may end behind `/-`: slashdash, line-space"),
    Rule("ckdl", "accepts", SPACES + ";", "a node has a name, and a `;` alone is none: nodes, base-node", "E0128"),
    Rule("ckdl", "accepts", r"\\" + GAP + r"[^\s]", "a `\\` continues a line at its end alone: escline", "E0101"),
    Rule("ckdl", "accepts", r"\\u\{(?![0-9a-fA-F]{1,6}\})", "one to six hexadecimal digits: hex-unicode", "E0115"),
    Rule("ckdl", "accepts", "/-" + SPACES + "/-", "one `/-` before a node, entry or block: base-node", "E0122"),
    Rule("ckdl", "accepts", "/-" + SPACES + "(?:\\}|;|$)", "something must follow `/-`: base-node", "E0122"),
    Rule("ckdl", "accepts", TYPE + GAP + r"\(", "one type annotation: value, base-node", "E0123"),
    Rule("ckdl", "accepts", "=" + GAP + r"[{};]", "a property has a value: prop", "E0113"),
    Rule("bgotink", "reads", r"[-+]0[xob]", "a sign belongs to hex, octal and binary numbers, too: hex"),
    Rule("bgotink", "refuses", r"0x[0-9a-fA-F_]+;", "a `;` ends a node behind a number in base 16, too: node-terminator"),
    Rule("bgotink", "reads", r"0x[0-9a-fA-F_]+;", "the same"),
    Rule("bgotink", "accepts", r"0x[0-9a-fA-F_]+;", "the same", "E01"),
    Rule("bgotink", "accepts", r"0x(?![0-9a-fA-F])", "a number in base 16 has digits: hex", "E0117"),
    Rule("bgotink", "refuses", r"\"\"\".*\\\\[\s\x85]", "a backslash that is escaped escapes no white space: string-character"),
    Rule("bgotink", "accepts", r"\\\\[\s\x85]", "the same", "E01"),
    Rule("bgotink", "accepts", ODD + "|.\ufeff", "these stand nowhere: disallowed-literal-code-points", "E0102"),
    Rule("bgotink", "accepts", r"(?<![0-9])\.[0-9]", "no identifier begins with a point and a digit: dotted-ident", "E0106"),
]


def plain(value):
    """Values that compare: numbers as doubles, NaN as a word."""
    if isinstance(value, dict):
        number = float(value["number"])
        return ("number", "nan") if math.isnan(number) else ("number", number, math.copysign(1, number))
    return (type(value).__name__, value)


def tree(nodes):
    return [(n[0], [plain(v) for v in n[1]], {k: plain(v) for k, v in dict(n[2]).items()}, tree(n[3])) for n in nodes]


def ckdl_reader():
    import ckdl

    def value(v):
        if isinstance(v, ckdl.Value):
            v = v.value
        if isinstance(v, (int, float)) and not isinstance(v, bool):
            return {"number": float(v)}
        return v

    def node(n):
        return [n.name, [value(v) for v in n.args], {k: value(v) for k, v in n.properties.items()}, [node(c) for c in n.children]]

    def read(text):
        try:
            return [node(n) for n in ckdl.parse(text, version=2).nodes]
        except (ckdl.ParseError, OverflowError):
            return None

    return read


def documents(program):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "documents.jsonl")
        subprocess.run([program, "-tc=KDL: documents for other implementations"], check=True, stdout=subprocess.DEVNULL,
                       env=os.environ | {"ABBE_KDL_DOCUMENTS": path})
        with open(path, encoding="utf-8", newline="\n") as lines:
            return [json.loads(line) for line in lines]


def bgotink_answers(documents):
    lines = "".join(json.dumps({"text": d["text"]}) + "\n" for d in documents)
    node = subprocess.run(["node", os.path.join(HERE, "kdl_peers.mjs"), os.path.realpath(MODULES)], input=lines, text=True,
                          capture_output=True, check=True)
    return [json.loads(line) for line in node.stdout.split("\n")[:-1]]


def readers():
    """What is installed: functions from a list of documents to the list of what was read; None: refused."""
    found = {}
    try:
        read = ckdl_reader()
        found["ckdl"] = lambda documents: [read(d["text"]) for d in documents]
    except ImportError:
        print("ckdl is not installed")
    if os.path.isdir(os.path.join(MODULES, "node_modules", "@bgotink", "kdl")) and shutil.which("node"):
        found["bgotink"] = bgotink_answers
    else:
        print("@bgotink/kdl is not installed")
    return found


def disagreement(document, theirs):
    """ "accepts", "refuses" or "reads" something else; None where reader and Abbe agree."""
    ours = document["nodes"]
    if theirs is None:
        return None if ours is None else "refuses"
    if ours is None:
        return "accepts"
    return None if tree(ours) == tree(theirs) else "reads"


def main():
    program, show = sys.argv[1], int(sys.argv[3]) if sys.argv[2:3] == ["--show"] else 0
    installed = readers()
    if not installed:
        return SKIPPED
    known, unknown, stricter, agreed, examples = Counter(), [], Counter(), Counter(), defaultdict(list)
    made = documents(program)
    total = len(made)
    for reader, read in installed.items():
        for document, theirs in zip(made, read(made), strict=True):
            text, codes, does = document["text"], document["codes"], disagreement(document, theirs)
            if does is None:
                agreed[reader] += 1
                continue
            comma = ("E0112" in codes or "E0123" in codes) and "," in text  # whatever else a word with a comma leads to
            if does == "accepts" and (set(codes.split()) <= STRICTER or comma):
                stricter[reader] += 1
                continue
            rule = next((r for r in RULES if r.explains(reader, does, text, codes)), None)
            if rule is None:
                unknown.append((reader, does, text, codes))
            else:
                known[rule] += 1
                examples[rule].append(text)
    print(f"{total} documents; agreed: {dict(agreed)}; Abbe is stricter by intent: {dict(stricter)}")
    for rule in RULES:
        print(f"{known[rule]:6d}  {rule.reader} {rule.does}: {rule.why}")
        for text in examples[rule][:show]:
            print(f"          {text!r}")
    for reader, does, text, codes in unknown[:60]:
        print(f"FAULT   {reader} {does} {text!r} {codes}")
    print(f"{len(unknown)} differences without a reason")
    return 1 if unknown or total < 10000 else 0


if __name__ == "__main__":
    sys.exit(main())
