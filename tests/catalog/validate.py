"""Prints "valid" or "invalid" for each JSON file, by the schema of its format.

usage: validate.py SCHEMA_FOLDER FILE...
"""
import json
import pathlib
import sys

import jsonschema

folder = pathlib.Path(sys.argv[1])
for name in sys.argv[2:]:
    document = json.loads(pathlib.Path(name).read_text())
    _, kind, version = document["format"].split("/")
    schema = json.loads((folder / f"{kind}-{version}.schema.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    print("valid" if jsonschema.Draft7Validator(schema).is_valid(document) else "invalid")
