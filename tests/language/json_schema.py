#!/usr/bin/env python3
"""Scenes as JSON against the JSON Schema of the language.

    json_schema.py ABBE

Every shipped scene, and every snippet `kdl` of a whole scene in the documentation, becomes a tree that is valid; each of
some mistakes makes it invalid. Skipped with code 77 without the package `jsonschema`.
"""
import glob
import json
import os
import re
import subprocess
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("no package `jsonschema`")
    sys.exit(77)

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
PROGRAM = sys.argv[1]
GOOD = 'scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { luminance 9 nits }\n'

# What must not be accepted, behind GOOD.
BAD = {
    "unknown kind": "lamp quad { power 60 W }",
    "unknown property": "shape sphere { radios 1 }",
    "unknown unit": "shape sphere { radius 1 parsec }",
    "unit of another dimension": "light point { position 0 1 0; intensity 5 mm }",
    "two numbers for three": "shape box { size 1 2 }",
    "a word for a switch": "render { adaptive maybe }",
    "unknown choice": "render { sampler dice }",
    "a number beyond its range": "material a diffuse { opacity 2 }",
    "a fraction for a whole number": "render { samples 1.5 }",
    "unknown type": "shape blob { radius 1 }",
    "unknown step of a transform": "shape sphere { transform { shear 1 0 0 } }",
    "property of another type": "light point { position 0 1 0; intensity 5 cd; radius 1 }",
    "no value": "shape sphere { radius }",
    "unknown key": 'film { output "a.exr" depth=9 }',
    "a property in a group": "group { radius 1 }",
    "mistake in a group": "group { shape sphere { radios 1 } }",
    "mistake in a variant": "variant dusk { light sky { luminanze 9 nits } }",
}


def tree_of(text=None, path="-"):
    done = subprocess.run([PROGRAM, "fmt", "--tree", path], input=text, capture_output=True, text=True, timeout=120)
    if done.returncode != 0:
        return None
    return json.loads(done.stdout)


def snippets():
    for page in glob.glob(os.path.join(ROOT, "docs", "**", "*.md"), recursive=True):
        with open(page, encoding="utf-8") as file:
            for text in re.findall(r"^```kdl\n(scene 1\b.*?)^```", file.read(), re.S | re.M):
                yield os.path.relpath(page, ROOT), text


def main():
    schema = json.loads(subprocess.run([PROGRAM, "reference", "json-schema"], capture_output=True, text=True).stdout)
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    faults = []

    def expect_valid(name, tree):
        if tree is None:
            faults.append(f"{name}: no tree")
            return
        for error in validator.iter_errors(tree):
            faults.append(f"{name}: {list(error.absolute_path)}: {error.message[:300]}")

    scenes = sorted(glob.glob(os.path.join(ROOT, "scenes", "**", "*.scene"), recursive=True))
    for path in scenes:
        expect_valid(os.path.relpath(path, ROOT), tree_of(path=path))
    shown = list(snippets())
    for page, text in shown:
        expect_valid(page, tree_of(text))
    expect_valid("the good scene", tree_of(GOOD))
    for what, line in BAD.items():
        tree = tree_of(GOOD + line + "\n")
        if tree is None or validator.is_valid(tree):
            faults.append(f"accepted: {what}: {line}")
    for wrong in ([{"nme": "scene"}], {"name": "scene"}, [{"name": "scene", "values": 1}], [{"name": "scene", "more": 1}]):
        if validator.is_valid(wrong):
            faults.append(f"accepted: {wrong}")
    if len(scenes) < 50 or len(shown) < 10:
        faults.append(f"only {len(scenes)} scenes and {len(shown)} snippets were found")
    print("\n".join(faults) or f"{len(scenes)} scenes and {len(shown)} snippets are valid, {len(BAD)} mistakes are not")
    return 1 if faults else 0


sys.exit(main())
