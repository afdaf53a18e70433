"""Reads an imported dataset with the real minari package, and runs the policy that was learned from it with onnxruntime.

    read.py DATASET_ID POLICY     observations from standard input; prints {episodes, actions}, the arrays as make.py does

The datasets lie under $MINARI_DATASETS_PATH.
"""

import json
import sys
import warnings

import minari
import numpy as np
import onnxruntime


def encoded(array):
    array = np.ascontiguousarray(array)
    return {"dtype": array.dtype.str, "shape": list(array.shape), "hex": array.tobytes().hex()}


# Whatever minari has to complain about the dataset counts as a failure.
warnings.simplefilter("error")
name, policy = sys.argv[1:]
keys = ("observations", "actions", "rewards", "terminations", "truncations")
episodes = [{key: encoded(getattr(episode, key)) for key in keys} for episode in minari.load_dataset(name).iterate_episodes()]
session = onnxruntime.InferenceSession(policy)
observations = np.array(json.load(sys.stdin), np.float32)
actions = session.run(["action"], {"observation": observations})[0]
json.dump({"episodes": episodes, "actions": actions.astype(np.float64).tolist()}, sys.stdout)
