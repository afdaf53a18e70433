"""Runs the code of a document on the policy in the working folder: observations from standard input, actions and contract to standard output.

Usage: actions.py CODE; the code defines `act(observation)` and `contract`. An ONNX file there is checked by the `onnx` package first.
"""

import json
import os
import sys

import numpy as np
import onnx

if os.path.exists("policy.onnx"):
    onnx.checker.check_model("policy.onnx", full_check=True)

scope = {}
with open(sys.argv[1], encoding="utf-8") as code:
    exec(compile(code.read(), sys.argv[1], "exec"), scope)

observations = np.array(json.load(sys.stdin), np.float32)
actions = scope["act"](observations)
assert actions.dtype == np.float32, actions.dtype
# One alone is a batch, too.
assert np.allclose(scope["act"](observations[:1]), actions[:1], rtol=1e-5)
json.dump({"actions": actions.astype(np.float64).tolist(), "contract": scope["contract"]}, sys.stdout)
